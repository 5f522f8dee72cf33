//! `--smooth`: which casters stand for smooth bodies, and what is said of the others.

use std::collections::BTreeMap;

use std::sync::Arc;

use anyhow::Context as _;
use glam::DAffine3;
use umbrae_core::{Caster, NotSmooth, Object, SmoothBody, Topology, corner_normals, given_normals};

use crate::talk::{Talk, and_more, counted};

/// Which casters are smooth.
#[derive(Debug)]
pub struct SmoothBodies {
    /// For each caster; `None` where it casts the shadow of its triangles.
    pub bodies: Vec<Option<SmoothBody>>,
    note: String,
    warnings: Vec<String>,
}

impl SmoothBodies {
    /// Says how many there are, and why others are not.
    pub fn tell(&self, talk: &Talk) {
        talk.note(&self.note);
        self.warnings.iter().for_each(|warning| talk.warning(warning));
    }
}

/// Makes a smooth body of each of `casters` that can be one, and has it shaded by its normals.
///
/// `objects` are those of the casters, in order, and are told apart from the `ground`, of which nothing is said. Takes about three microseconds a triangle.
pub fn smooth_bodies(
    objects: &[Object],
    casters: &mut [Caster],
    ground: Option<usize>,
    crease_rad: f64,
) -> SmoothBodies {
    let mut others: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    let mut bodies = Vec::new();
    for (i, (object, caster)) in objects.iter().zip(casters).enumerate() {
        if Some(i) == ground {
            bodies.push(None);
            continue;
        }
        let normals = corner_normals(caster, &given_normals(object), crease_rad);
        match SmoothBody::new(caster, &normals) {
            Ok(body) => {
                caster.shading_normals = normals;
                bodies.push(Some(body));
            }
            Err(reason) => {
                // That flat faces have no curves is as it should be.
                if reason != NotSmooth::Flat {
                    others.entry(reason.to_string()).or_default().push(&object.name);
                }
                bodies.push(None);
            }
        }
    }
    let smooth = bodies.iter().flatten().count();
    let all = objects.len() - usize::from(ground.is_some());
    let warning = |(reason, names): (String, Vec<&str>)| {
        format!("{} can't be smooth, because {reason}: the shadow of the triangles is drawn", and_more(&names))
    };
    SmoothBodies {
        note: format!("{} of {} cast smooth shadows", smooth, counted(all, "object")),
        warnings: others.into_iter().map(warning).collect(),
        bodies,
    }
}

/// Cuts each triangle of those of `objects` that are smooth into `pieces` a side, on the curved surface, as they are posed.
///
/// # Errors
///
/// When an object would have more triangles than a mesh can.
pub fn tessellate(objects: &mut [Object], crease_rad: f64, pieces: u32) -> anyhow::Result<()> {
    for object in objects {
        let caster = Caster::new(object, Arc::new(Topology::new(&object.mesh)));
        let normals = corner_normals(&caster, &given_normals(object), crease_rad);
        let Ok(body) = SmoothBody::new(&caster, &normals) else { continue };
        let mesh = body.tessellated(&caster, pieces);
        let mesh = mesh.with_context(|| format!("`{}` can't be cut into {pieces} pieces a side", object.name))?;
        // It is where it is drawn already.
        *object = Object { mesh: Arc::new(mesh), world_from_object: DAffine3::IDENTITY, pose: None, ..object.clone() };
    }
    Ok(())
}
