//! `umbrae inspect`: what a model is made of, and how it will cast. Starts no GPU.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::sync::Arc;

use serde::Serialize;
use umbrae_core::{
    Bounds, Caster, Light, Material, Mesh, MeshCounts, Object, Scene, Surface, Topology, TopologyCounts,
};
use umbrae_formats::{Crs, Format, Model};

use crate::cli::InspectArgs;
use crate::model::{format_name, load_one};
use crate::output::write_to_stdout;
use crate::talk::{Talk, counted, printable};

/// The JSON of `umbrae inspect --json`.
#[derive(Debug, Serialize)]
pub struct Inspection {
    file: String,
    format: &'static str,
    up: &'static str,
    origin: [f64; 3],
    /// Null where nobody says so.
    crs: Option<CrsJson>,
    /// What the file is in, if it was computed anew for `crs`.
    source_crs: Option<CrsJson>,
    #[serde(flatten)]
    total: Counts,
    objects: Vec<ObjectJson>,
    animations: Vec<AnimationJson>,
    cameras: Vec<String>,
    lights: Vec<String>,
    /// For each light, its kind and its reach, in words.
    #[serde(skip)]
    light_texts: Vec<String>,
    warnings: Vec<String>,
}

/// A coordinate reference system.
#[derive(Debug, Serialize)]
struct CrsJson {
    epsg: u32,
    name: &'static str,
}

impl CrsJson {
    fn new(crs: &Crs) -> Self {
        Self { epsg: crs.epsg(), name: crs.name() }
    }
}

/// Counts of one object or of the whole model.
#[derive(Debug, Clone, Serialize)]
pub struct Counts {
    /// As read, degenerate ones included.
    pub triangles: usize,
    /// As read, before welding.
    pub vertices: usize,
    /// After welding at bit-equal positions.
    pub welded_vertices: usize,
    /// Of the triangles that are left.
    pub edges: usize,
    /// With one triangle.
    pub border_edges: usize,
    /// With more than two.
    pub non_manifold_edges: usize,
    /// With two that walk it the same way.
    pub inconsistent_edges: usize,
    /// Whether every edge has exactly two triangles.
    pub closed: bool,
    /// Connected through edges.
    pub components: Components,
    /// Dropped: two corners at one position.
    pub degenerate_triangles: usize,
    /// Of the scene, instances included; model coordinates, z up.
    pub bounds: BoundsJson,
}

/// Components by the way they cast.
#[derive(Debug, Clone, Serialize)]
pub struct Components {
    /// Closed and consistently wound: only faces turned to the light cast.
    pub closed: usize,
    /// All others: every triangle casts.
    pub other: usize,
}

/// A box.
#[derive(Debug, Clone, Serialize)]
pub struct BoundsJson {
    min: [f64; 3],
    max: [f64; 3],
}

#[derive(Debug, Serialize)]
struct AnimationJson {
    name: String,
    /// The time of its last key.
    duration_s: f64,
}

#[derive(Debug, Serialize)]
struct ObjectJson {
    name: String,
    /// Names of those in use, in the order of the file; "" where one has none.
    materials: Vec<String>,
    #[serde(flatten)]
    counts: Counts,
}

/// Prints what is in `args.model`.
///
/// # Errors
///
/// When the file can't be loaded.
pub fn run(args: &InspectArgs, talk: &Talk) -> anyhow::Result<()> {
    // JSON carries the warnings itself.
    let quiet = Talk::new(true, crate::cli::ColorWhen::Never);
    let model = load_one(&args.model, &args.load.options(), if args.json { &quiet } else { talk })?;
    let inspection = Inspection::new(args.model.display().to_string(), &model);
    let text = if args.json { format!("{}\n", serde_json::to_string_pretty(&inspection)?) } else { inspection.text() };
    write_to_stdout(text.as_bytes())
}

impl Inspection {
    /// Counts everything in `model`, which was read from `file`.
    ///
    /// In the whole, a mesh counts once however many instances it has. Groups of an OBJ file and solids of an STL file are parts of one
    /// surface, so there the whole is welded as one and may be closed where its parts are not; meshes of a glTF file, and objects of a city, are bodies of their own.
    pub fn new(file: String, model: &Model) -> Self {
        let scene = &model.scene;
        let origin = scene.origin;
        let casters = Caster::of_scene(scene);
        let objects = casters
            .iter()
            .map(|caster| ObjectJson {
                name: caster.name.clone(),
                materials: materials_of(caster, &scene.materials),
                counts: Counts::new(
                    caster.mesh.counts(),
                    caster.mesh.positions().len(),
                    caster.topology.counts(),
                    caster.bounds,
                    origin,
                ),
            })
            .collect();
        let total = match (model.format, casters.len()) {
            (Format::Gltf | Format::CityJson | Format::GeoJson | Format::GeoTiff, _) | (_, 1) => {
                total_of_meshes(scene, &casters)
            }
            (Format::Obj | Format::Ply | Format::Stl, _) => total_of_surface(scene),
        };
        Self {
            file,
            format: format_name(model.format),
            up: match model.up {
                umbrae_formats::UpAxis::Y => "y",
                umbrae_formats::UpAxis::Z => "z",
            },
            origin: origin.to_array(),
            crs: model.crs.as_ref().map(CrsJson::new),
            source_crs: model.source_crs.as_ref().map(CrsJson::new),
            total,
            objects,
            animations: (model.animations.iter())
                .map(|animation| AnimationJson { name: animation.name.to_owned(), duration_s: animation.duration_s })
                .collect(),
            cameras: scene.cameras.iter().map(|c| c.name.clone()).collect(),
            lights: scene.lights.iter().map(|l| l.name.clone()).collect(),
            light_texts: scene.lights.iter().map(light_text).collect(),
            warnings: model.warnings.iter().map(ToString::to_string).collect(),
        }
    }

    /// Counts of the whole model.
    pub fn total(&self) -> &Counts {
        &self.total
    }

    fn text(&self) -> String {
        let mut text = format!("{}: {}, {} up\n", printable(&self.file), self.format, self.up);
        self.total.write_to(&mut text, "  ");
        if self.origin != [0.0; 3] {
            let _ = writeln!(text, "  origin                 {:?}", self.origin);
        }
        if let Some(crs) = &self.crs {
            let from = |source: &CrsJson| format!(", computed from EPSG:{} ({})", source.epsg, source.name);
            let from = self.source_crs.as_ref().map_or_else(String::new, from);
            let _ = writeln!(text, "  coordinates in         EPSG:{} ({}){from}", crs.epsg, crs.name);
        }
        let animation_text = |a: &AnimationJson| format!("{}: {:.3} s", a.name, a.duration_s);
        let animations = self.animations.iter().map(animation_text).collect();
        for (what, names) in [("animation", &animations), ("camera", &self.cameras), ("light", &self.light_texts)] {
            for name in names {
                let _ = writeln!(text, "  {what:<22} {}", printable(name));
            }
        }
        let _ = writeln!(text, "{}", counted(self.objects.len(), "object"));
        for object in &self.objects {
            let _ = writeln!(text, "  {}", printable(&object.name));
            let materials: Vec<_> = object.materials.iter().map(|name| name_text(name)).collect();
            let _ = writeln!(text, "    {:<22} {}", "materials", materials.join(", "));
            // One object is the whole, which was counted above.
            if self.objects.len() > 1 {
                object.counts.write_to(&mut text, "    ");
            }
        }
        text
    }
}

impl Counts {
    fn new(
        mesh: MeshCounts,
        welded_vertices: usize,
        topology: TopologyCounts,
        bounds: Bounds,
        origin: glam::DVec3,
    ) -> Self {
        Self {
            triangles: mesh.triangles_read,
            vertices: mesh.vertices_read,
            welded_vertices,
            edges: topology.edges,
            border_edges: topology.border_edges,
            non_manifold_edges: topology.non_manifold_edges,
            inconsistent_edges: topology.inconsistent_edges,
            closed: topology.is_closed(),
            components: Components { closed: topology.closed_components, other: topology.other_components },
            degenerate_triangles: mesh.degenerate_triangles,
            bounds: BoundsJson { min: (bounds.min + origin).to_array(), max: (bounds.max + origin).to_array() },
        }
    }

    fn write_to(&self, text: &mut String, indent: &str) {
        let kind = match (self.closed, self.components.other) {
            (true, 0) => "closed, consistently wound",
            (true, _) => "closed, not consistently wound; casts triangle by triangle where that is so",
            (false, 0) => "closed: some edges have more than two triangles, but all are walked equally often both ways",
            (false, _) => "not closed; casts triangle by triangle where that is so",
        };
        let BoundsJson { min, max } = &self.bounds;
        let rows = [
            ("triangles", format!("{} ({} degenerate, dropped)", self.triangles, self.degenerate_triangles)),
            ("vertices", format!("{} ({} after welding)", self.vertices, self.welded_vertices)),
            ("edges", self.edges.to_string()),
            ("  border", self.border_edges.to_string()),
            ("  non-manifold", self.non_manifold_edges.to_string()),
            ("  inconsistently wound", self.inconsistent_edges.to_string()),
            ("components", format!("{} closed, {} other", self.components.closed, self.components.other)),
            ("surface", kind.to_owned()),
            ("from", format!("{min:?}")),
            ("to", format!("{max:?}")),
        ];
        for (name, value) in rows {
            // Writing to a string can't fail.
            let _ = writeln!(text, "{indent}{name:<22} {value}");
        }
    }
}

/// The names of the materials that a caster's triangles have.
fn materials_of(caster: &Caster, materials: &[Material]) -> Vec<String> {
    let used: BTreeSet<u32> = caster.mesh.triangle_materials().iter().copied().collect();
    used.iter().filter_map(|&m| materials.get(m as usize)).map(|material| material.name.clone()).collect()
}

fn light_text(light: &Light) -> String {
    let kind = match light.cone {
        _ if light.position.is_directional() => "directional".to_owned(),
        Some(cone) => format!("spot, {:.0} degrees to its edge", cone.outer_rad.to_degrees()),
        None => "point".to_owned(),
    };
    let reach = light.range_m.map_or_else(String::new, |range_m| format!(", reaches {range_m:.1} m"));
    format!("{}: {kind}{reach}", light.name)
}

fn name_text(name: &str) -> Cow<'_, str> {
    if name.is_empty() { Cow::Borrowed("(without a name)") } else { printable(name) }
}

/// Each mesh once.
fn total_of_meshes(scene: &Scene, casters: &[Caster]) -> Counts {
    let mut seen = BTreeSet::new();
    let (mut counts, mut welded, mut topology) = (MeshCounts::default(), 0, TopologyCounts::default());
    for caster in casters.iter().filter(|caster| seen.insert(Arc::as_ptr(&caster.mesh))) {
        counts = plus(counts, caster.mesh.counts());
        welded += caster.mesh.positions().len();
        topology = topology.plus(caster.topology.counts());
    }
    Counts::new(counts, welded, topology, scene.bounds(), scene.origin)
}

/// All objects welded into one.
fn total_of_surface(scene: &Scene) -> Counts {
    let counts = scene.objects.iter().map(|o| o.mesh.counts()).fold(MeshCounts::default(), plus);
    let mut whole = Surface::default();
    for object in &scene.objects {
        let first = whole.positions.len() as u32;
        whole.positions.extend_from_slice(object.mesh.positions());
        whole.triangles.extend(object.mesh.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    let whole = Mesh::new(whole).expect("the parts were good meshes");
    let object = Object::new("", Arc::new(whole), glam::DAffine3::IDENTITY);
    let topology = Topology::new(&object.mesh).counts();
    Counts::new(counts, object.mesh.positions().len(), topology, object.bounds(), scene.origin)
}

fn plus(a: MeshCounts, b: MeshCounts) -> MeshCounts {
    MeshCounts {
        triangles_read: a.triangles_read + b.triangles_read,
        vertices_read: a.vertices_read + b.vertices_read,
        degenerate_triangles: a.degenerate_triangles + b.degenerate_triangles,
        unusable_normals: a.unusable_normals + b.unusable_normals,
    }
}
