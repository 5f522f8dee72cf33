//! What a GeoJSON file says, as far as it concerns footprints.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::json::Nested;

/// A collection of features, one feature, or one geometry.
#[derive(Debug, Deserialize)]
pub(super) struct Document {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    features: Option<Vec<Feature>>,
    #[serde(default)]
    crs: Option<System>,
    // Of a feature.
    #[serde(default)]
    id: Option<Scalar>,
    #[serde(default)]
    properties: Option<Properties>,
    #[serde(default)]
    geometry: Option<Geometry>,
    // Of a geometry.
    #[serde(default)]
    coordinates: Option<Nested>,
    #[serde(default)]
    geometries: Option<Vec<Geometry>>,
}

/// How files before 2016 name their coordinate reference system.
#[derive(Debug, Deserialize)]
struct System {
    #[serde(default)]
    properties: Option<Properties>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Feature {
    #[serde(default)]
    id: Option<Scalar>,
    #[serde(default)]
    pub(super) properties: Option<Properties>,
    #[serde(default)]
    geometry: Option<Geometry>,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Geometry {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    coordinates: Nested,
    /// Of a collection.
    #[serde(default)]
    geometries: Option<Vec<Geometry>>,
}

/// In the order of the file.
#[derive(Debug, Default)]
pub(super) struct Properties(pub(super) Vec<(String, Scalar)>);

/// A property's value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Scalar {
    Number(f64),
    Text(String),
    /// Null, true, false, lists and objects.
    Other,
}

/// What features are called by, lower case, best first.
const NAMES: [&str; 8] = ["id", "gml_id", "gmlid", "osm_id", "name", "fid", "objectid", "uuid"];

impl Document {
    /// What it says its coordinates are in.
    pub(super) fn crs_name(&self) -> Option<String> {
        let properties = self.crs.as_ref()?.properties.as_ref()?;
        properties.get("name").or_else(|| properties.get("code")).and_then(Scalar::text)
    }

    /// Whatever it is as a list of features.
    pub(super) fn into_features(self) -> Vec<Feature> {
        if let Some(features) = self.features {
            return features;
        }
        let own = || Geometry {
            kind: self.kind,
            coordinates: self.coordinates.unwrap_or_default(),
            geometries: self.geometries,
        };
        let geometry = self.geometry.unwrap_or_else(own);
        vec![Feature { id: self.id, properties: self.properties, geometry: Some(geometry) }]
    }
}

impl Feature {
    /// Its id, or what among its properties is as good.
    pub(super) fn name(&self) -> Option<String> {
        let named = |name: &&str| self.properties.as_ref()?.get(name)?.text();
        self.id.as_ref().and_then(Scalar::text).or_else(|| NAMES.iter().find_map(named))
    }

    /// Calls `each` with the type and the coordinates of every geometry that is no collection.
    pub(super) fn for_each_geometry(&self, each: &mut impl FnMut(&str, &Nested)) {
        // Depth is limited by the parser.
        fn walk(geometry: &Geometry, each: &mut impl FnMut(&str, &Nested)) {
            match &geometry.geometries {
                Some(parts) if geometry.kind == "GeometryCollection" => parts.iter().for_each(|part| walk(part, each)),
                _ => each(&geometry.kind, &geometry.coordinates),
            }
        }
        if let Some(geometry) = &self.geometry {
            walk(geometry, each);
        }
    }
}

impl Properties {
    /// The value of the property of this name; if there is none, of one that differs only in case.
    pub(super) fn get(&self, name: &str) -> Option<&Scalar> {
        let exact = self.0.iter().find(|(key, _)| key == name);
        let value = exact.or_else(|| self.0.iter().find(|(key, _)| key.eq_ignore_ascii_case(name)));
        value.map(|(_, value)| value).filter(|value| **value != Scalar::Other)
    }
}

impl Scalar {
    /// The value as text, if it is some; empty text is none.
    pub(super) fn text(&self) -> Option<String> {
        match self {
            Self::Number(number) => Some(number.to_string()),
            Self::Text(text) if !text.trim().is_empty() => Some(text.trim().to_owned()),
            Self::Text(_) | Self::Other => None,
        }
    }
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScalarVisitor;

        impl<'de> Visitor<'de> for ScalarVisitor {
            type Value = Scalar;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value")
            }

            fn visit_unit<E>(self) -> Result<Scalar, E> {
                Ok(Scalar::Other)
            }

            fn visit_bool<E>(self, _: bool) -> Result<Scalar, E> {
                Ok(Scalar::Other)
            }

            fn visit_i64<E>(self, number: i64) -> Result<Scalar, E> {
                Ok(Scalar::Number(number as f64))
            }

            fn visit_u64<E>(self, number: u64) -> Result<Scalar, E> {
                Ok(Scalar::Number(number as f64))
            }

            fn visit_f64<E>(self, number: f64) -> Result<Scalar, E> {
                Ok(Scalar::Number(number))
            }

            fn visit_str<E>(self, text: &str) -> Result<Scalar, E> {
                Ok(Scalar::Text(text.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Scalar, A::Error> {
                while seq.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Scalar::Other)
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Scalar, A::Error> {
                while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Scalar::Other)
            }
        }

        deserializer.deserialize_any(ScalarVisitor)
    }
}

impl<'de> Deserialize<'de> for Properties {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PropertiesVisitor;

        impl<'de> Visitor<'de> for PropertiesVisitor {
            type Value = Properties;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("properties by their names")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Properties, A::Error> {
                let mut properties = Vec::new();
                while let Some(property) = map.next_entry()? {
                    properties.push(property);
                }
                Ok(Properties(properties))
            }
        }

        deserializer.deserialize_map(PropertiesVisitor)
    }
}
