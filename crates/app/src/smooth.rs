//! `--smooth`: which casters stand for smooth bodies, and what is said of the others.

use std::collections::BTreeMap;

use umbrae_core::{Caster, NotSmooth, Object, SmoothBody, corner_normals, given_normals};

use crate::talk::{Talk, counted};

/// Makes a smooth body of each of `casters` that can be one, and has it shaded by its normals; `None` for the others.
///
/// `objects` are those of the casters, in order, and are told apart from the `ground`, of which nothing is said. Takes about three microseconds a triangle.
pub fn smooth_bodies(
    objects: &[Object],
    casters: &mut [Caster],
    ground: Option<usize>,
    crease_rad: f64,
    talk: &Talk,
) -> Vec<Option<SmoothBody>> {
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
    talk.note(&format!("{} of {} cast smooth shadows", smooth, counted(all, "object")));
    for (reason, names) in others {
        let and_more = if names.len() > 1 { format!(" and {} more", names.len() - 1) } else { String::new() };
        talk.warning(&format!(
            "`{}`{and_more} can't be smooth, because {reason}: the shadow of the triangles is drawn",
            names[0]
        ));
    }
    bodies
}
