//! Whether a city can be as large as its file says: the sign of wrong units.

use umbrae_core::{Object, Scene, SurfaceKind};

use crate::error::quoted;
use crate::warnings::Warnings;

/// The highest building of 2026 has 828 m.
const MAX_HEIGHT_M: f64 = 1000.0;
/// The largest cities are 100 km across, and further apart [`Scene::add`] holds nothing together.
const MAX_EXTENT_M: f64 = 200_000.0;

/// Warns of buildings and cities that are too large to be so.
pub(crate) fn warn_of_units(scene: &Scene, warnings: &mut Warnings) {
    for object in scene.objects.iter().filter(|object| !is_terrain(object, scene)) {
        let height_m = object.bounds().size().z;
        if height_m > MAX_HEIGHT_M {
            let words = [
                "object is higher than any building; is its height in another unit than metres?",
                "objects are higher than any building; are their heights in another unit than metres?",
            ];
            warnings.add_one(words, || format!("{}: {height_m:.0} m", quoted(&object.name)));
        }
    }
    let size = scene.bounds().size();
    let extent_m = size.x.max(size.y);
    if extent_m > MAX_EXTENT_M {
        let words = [
            "model is larger than any city; are its coordinates in another unit than metres?",
            "models are larger than any city; are their coordinates in another unit than metres?",
        ];
        warnings.add_one(words, || format!("{:.0} km across", extent_m / 1000.0));
    }
}

/// Mountains may be high.
fn is_terrain(object: &Object, scene: &Scene) -> bool {
    let first = object.mesh.triangle_materials().first().and_then(|&material| scene.materials.get(material as usize));
    first.is_some_and(|material| material.surface == SurfaceKind::Terrain)
}
