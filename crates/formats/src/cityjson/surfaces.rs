//! The surfaces of a geometry, whatever they are nested in.

use super::document::{Geometry, Semantics};
use crate::json::Nested;

/// One surface: an outer ring and holes, as lists of vertices.
#[derive(Debug, Clone, Copy)]
pub(super) struct PolygonOf<'a> {
    pub(super) rings: &'a [Nested],
    /// What it is, as the file says; "" where it does not.
    pub(super) semantic: &'a str,
}

impl Geometry {
    /// How many lists are around the list of surfaces: none, shells, or solids of shells. `None` for what has no surface.
    fn depth(&self) -> Option<u32> {
        match self.kind.as_str() {
            "MultiSurface" | "CompositeSurface" => Some(0),
            "Solid" => Some(1),
            "MultiSolid" | "CompositeSolid" => Some(2),
            _ => None,
        }
    }

    /// Whether it has surfaces of its own.
    pub(super) fn has_surfaces(&self) -> bool {
        self.depth().is_some()
    }

    /// Calls `each` with every surface, in the order of the file.
    ///
    /// # Errors
    ///
    /// The value that is not nested as the kind of geometry wants; surfaces before it were given already.
    pub(super) fn for_each_surface<'a>(&'a self, mut each: impl FnMut(PolygonOf<'a>)) -> Result<(), String> {
        let Some(depth) = self.depth() else { return Ok(()) };
        let semantics = self.semantics.as_ref();
        let values = semantics.map_or(&Nested::Null, |semantics| &semantics.values);
        walk(&self.boundaries, values, depth, &mut |rings, value| {
            let semantic = semantics.map_or("", |semantics| semantics.name(value));
            each(PolygonOf { rings, semantic });
        })
        .map_err(|value| format!("{value} is not a list as a {} needs there", self.kind))
    }
}

impl Semantics {
    fn name(&self, value: &Nested) -> &str {
        let surface = value.index().and_then(|index| self.surfaces.as_ref()?.get(index));
        surface.map_or("", |surface| &surface.kind)
    }
}

/// Walks boundaries and the values of semantics side by side; those may end early, or be null at any level.
fn walk<'a>(
    boundaries: &'a Nested,
    values: &'a Nested,
    depth: u32,
    each: &mut impl FnMut(&'a [Nested], &'a Nested),
) -> Result<(), &'a Nested> {
    let items = boundaries.list().ok_or(boundaries)?;
    for (i, item) in items.iter().enumerate() {
        let value = values.list().and_then(|values| values.get(i)).unwrap_or(&Nested::Null);
        if depth > 0 {
            walk(item, value, depth - 1, each)?;
        } else {
            each(item.list().ok_or(item)?, value);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(geometry: &str) -> Result<Vec<String>, String> {
        let geometry: Geometry = serde_json::from_str(geometry).expect("good JSON");
        let mut names = Vec::new();
        geometry.for_each_surface(|polygon| names.push(format!("{}{}", polygon.rings.len(), polygon.semantic)))?;
        Ok(names)
    }

    #[test]
    fn surfaces_are_found_at_every_depth_with_what_they_are() {
        let surfaces = r#""semantics":{"surfaces":[{"type":"Roof"},{"type":"Wall"}],"values":VALUES}"#;
        let of = |kind: &str, boundaries: &str, values: &str| {
            let semantics = surfaces.replace("VALUES", values);
            names(&format!(r#"{{"type":"{kind}","boundaries":{boundaries},{semantics}}}"#)).expect("good nesting")
        };
        assert_eq!(of("MultiSurface", "[[[0,1,2]],[[0,1,2],[3,4,5]],[[1]]]", "[1,0,null]"), ["1Wall", "2Roof", "1"]);
        assert_eq!(of("Solid", "[[[[0,1,2]]],[[[0,1,2]],[[3]]]]", "[[0],[1,0]]"), ["1Roof", "1Wall", "1Roof"]);
        assert_eq!(of("CompositeSolid", "[[[[[0]]]],[[[[1]],[[1]]]]]", "[null,[[7,0]]]"), ["1", "1", "1Roof"]);
        assert_eq!(of("MultiSolid", "[[[[[0]]]]]", "null"), ["1"]);
        assert_eq!(of("CompositeSurface", "[[[0]]]", "[]"), ["1"]);
        assert!(of("MultiPoint", "[0,1]", "null").is_empty());
    }

    #[test]
    fn wrong_nesting_is_told_with_its_value() {
        assert_eq!(
            names(r#"{"type":"Solid","boundaries":[[[[0,1]]],[7]]}"#),
            Err("7 is not a list as a Solid needs there".to_owned())
        );
        assert_eq!(
            names(r#"{"type":"MultiSurface"}"#),
            Err("null is not a list as a MultiSurface needs there".to_owned())
        );
    }
}
