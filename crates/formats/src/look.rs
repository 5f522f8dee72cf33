//! What a surface of a city is, and its colour: files seldom say more than "roof".

use glam::Vec3;
use umbrae_core::{Material, SurfaceKind};

use crate::place::linear_from_srgb;

/// A name, an sRGB colour and a kind.
type Look = (&'static str, [u8; 3], SurfaceKind);

const ROOF: Look = ("roof", [178, 92, 74], SurfaceKind::Roof);
const WALL: Look = ("wall", [214, 204, 186], SurfaceKind::Wall);
const OPENING: Look = ("window or door", [120, 140, 156], SurfaceKind::Wall);
const BASE: Look = ("base", [122, 116, 108], SurfaceKind::Base);
const BUILDING: Look = ("building", [208, 200, 188], SurfaceKind::Unknown);
const TERRAIN: Look = ("terrain", [168, 170, 140], SurfaceKind::Terrain);
const ROAD: Look = ("road", [132, 132, 136], SurfaceKind::Terrain);
const WATER: Look = ("water", [110, 150, 184], SurfaceKind::Terrain);
const PLANTS: Look = ("plants", [138, 168, 104], SurfaceKind::Terrain);
const TREE: Look = ("tree", [96, 138, 76], SurfaceKind::Unknown);
const BRIDGE: Look = ("bridge", [176, 172, 166], SurfaceKind::Unknown);
const OTHER: Look = ("other", [186, 184, 180], SurfaceKind::Unknown);

/// Materials that are used, each once.
#[derive(Debug, Default)]
pub(crate) struct Looks(Vec<Look>);

impl Looks {
    /// The index of the material of a surface that is a `semantic` of a `kind` of city object.
    pub(crate) fn material_of(&mut self, kind: &str, semantic: &str) -> u32 {
        let look = look_of(kind, semantic);
        let index = self.0.iter().position(|known| known.0 == look.0).unwrap_or_else(|| {
            self.0.push(look);
            self.0.len() - 1
        });
        index as u32
    }

    pub(crate) fn into_materials(self) -> Vec<Material> {
        let material = |(name, srgb, surface): Look| {
            let color = Vec3::from_array(srgb.map(|channel| f32::from(channel) / 255.0));
            Material { surface, ..Material::new(name, linear_from_srgb(color)) }
        };
        self.0.into_iter().map(material).collect()
    }
}

/// The city's ground has no roofs; of what stands on it a surface says what it is, or else the object.
fn look_of(kind: &str, semantic: &str) -> Look {
    match kind {
        "TINRelief" | "LandUse" => return TERRAIN,
        "Road" | "Railway" | "TransportSquare" | "Square" | "Track" => return ROAD,
        "WaterBody" | "Waterway" => return WATER,
        "PlantCover" => return PLANTS,
        "SolitaryVegetationObject" => return TREE,
        _ => {}
    }
    match semantic {
        "RoofSurface" | "OuterFloorSurface" => ROOF,
        "WallSurface" | "ClosureSurface" => WALL,
        "Window" | "Door" => OPENING,
        "GroundSurface" => BASE,
        _ if kind.starts_with("Building") => BUILDING,
        _ if kind.starts_with("Bridge") => BRIDGE,
        _ => OTHER,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_are_what_the_file_says_and_the_ground_is_the_ground() {
        let kind = |object, surface| look_of(object, surface).2;
        assert_eq!(kind("BuildingPart", "RoofSurface"), SurfaceKind::Roof);
        assert_eq!(kind("Building", "Window"), SurfaceKind::Wall);
        assert_eq!(kind("Building", "GroundSurface"), SurfaceKind::Base);
        assert_eq!(kind("Building", ""), SurfaceKind::Unknown);
        assert_eq!(kind("Building", "InteriorWallSurface"), SurfaceKind::Unknown);
        for object in ["TINRelief", "Road", "WaterBody", "PlantCover", "LandUse"] {
            assert_eq!(kind(object, "GroundSurface"), SurfaceKind::Terrain, "{object}");
        }
        assert_eq!(kind("+Noise", ""), SurfaceKind::Unknown);
    }

    #[test]
    fn a_material_is_there_once() {
        let mut looks = Looks::default();
        let used = [("Building", "RoofSurface"), ("Road", ""), ("Bridge", "RoofSurface")];
        assert_eq!(used.map(|(kind, semantic)| looks.material_of(kind, semantic)), [0, 1, 0]);
        let materials = looks.into_materials();
        assert_eq!(materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["roof", "road"]);
    }
}
