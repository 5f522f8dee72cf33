//! What a CityJSON file says, as far as it concerns shapes.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};

use crate::error::quoted;
use crate::json::Nested;

/// The whole of a file, or the first line of a sequence, or one of its features.
#[derive(Debug, Deserialize)]
pub(super) struct Document {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) version: Option<Version>,
    #[serde(default)]
    pub(super) transform: Option<Transform>,
    #[serde(default)]
    pub(super) metadata: Option<Metadata>,
    #[serde(default, rename = "CityObjects")]
    pub(super) objects: CityObjects,
    #[serde(default)]
    pub(super) vertices: Vec<[f64; 3]>,
    #[serde(default, rename = "geometry-templates")]
    pub(super) templates: Option<Templates>,
}

/// What is measured of, as "2.0"; some write a number.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Version {
    Text(String),
    Number(f64),
}

/// A vertex times `scale` plus `translate` is where it is.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(super) struct Transform {
    pub(super) scale: [f64; 3],
    pub(super) translate: [f64; 3],
}

#[derive(Debug, Deserialize)]
pub(super) struct Metadata {
    #[serde(default, rename = "referenceSystem")]
    pub(super) reference_system: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Templates {
    #[serde(default)]
    pub(super) templates: Vec<Geometry>,
    #[serde(default, rename = "vertices-templates")]
    pub(super) vertices: Vec<[f64; 3]>,
}

/// In the order of the file.
#[derive(Debug, Default)]
pub(super) struct CityObjects(pub(super) Vec<(String, CityObject)>);

#[derive(Debug, Deserialize)]
pub(super) struct CityObject {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) geometry: Option<Vec<Geometry>>,
    #[serde(default)]
    pub(super) parents: Option<Vec<String>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Geometry {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) lod: Option<Lod>,
    #[serde(default)]
    pub(super) boundaries: Nested,
    #[serde(default)]
    pub(super) semantics: Option<Semantics>,
    /// Of a `GeometryInstance`.
    #[serde(default)]
    pub(super) template: Option<usize>,
    #[serde(default, rename = "transformationMatrix")]
    pub(super) matrix: Option<Vec<f64>>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Semantics {
    #[serde(default)]
    pub(super) surfaces: Option<Vec<SemanticSurface>>,
    /// For each surface of the boundaries the index of what it is, nested as those are.
    #[serde(default)]
    pub(super) values: Nested,
}

#[derive(Debug, Deserialize)]
pub(super) struct SemanticSurface {
    #[serde(default, rename = "type")]
    pub(super) kind: String,
}

/// A level of detail: text, in version 1.0 a number.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lod {
    pub(super) name: String,
    /// "2" is 2 and "2.2" is 2.2; NaN for text that is no number.
    pub(super) level: f64,
}

impl Lod {
    pub(super) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), level: name.trim().parse().unwrap_or(f64::NAN) }
    }

    /// Whether both are the same level: "2" is "2.0".
    pub(super) fn is(&self, other: &Self) -> bool {
        self.name == other.name || self.level == other.level
    }
}

impl<'de> Deserialize<'de> for Lod {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Either {
            Text(String),
            Number(f64),
        }
        Ok(match Either::deserialize(deserializer)? {
            Either::Text(text) => Self::new(&text),
            Either::Number(number) => Self { name: number.to_string(), level: number },
        })
    }
}

impl<'de> Deserialize<'de> for CityObjects {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ObjectsVisitor;

        impl<'de> Visitor<'de> for ObjectsVisitor {
            type Value = CityObjects;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("city objects by their ids")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<CityObjects, A::Error> {
                let mut objects = Vec::new();
                while let Some(id) = map.next_key::<String>()? {
                    let named = |error| A::Error::custom(format_args!("city object {}: {error}", quoted(&id)));
                    let object = map.next_value().map_err(named)?;
                    objects.push((id, object));
                }
                Ok(CityObjects(objects))
            }
        }

        deserializer.deserialize_map(ObjectsVisitor)
    }
}
