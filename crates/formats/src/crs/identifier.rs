//! The many ways to write an EPSG code.

/// The code that `text` stands for; of a compound name the first, horizontal part.
pub(super) fn epsg_of(text: &str) -> Option<u32> {
    let text = text.trim();
    let upper = text.to_ascii_uppercase();
    // "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783", "…/crs-compound?1=http://…/EPSG/0/25832&2=…", "EPSG:25832+5783".
    let horizontal = match upper.strip_prefix("URN:OGC:DEF:CRS,") {
        Some(parts) => parts.split(',').next()?,
        None => upper.split(['&', '+', ',']).next()?,
    };
    let mut words = horizontal.split([':', '/', '#', '=', '?']).filter(|word| !word.is_empty());
    let last = words.next_back()?;
    if matches!(last, "CRS84" | "CRS84H") {
        return Some(super::WGS84);
    }
    let is_alone = words.clone().next().is_none();
    // "EPSG::28992", "EPSG/0/28992", "EPSG:9.6:28992", "gml/srs/epsg.xml#28992".
    let is_epsg = words.rev().take(2).any(|word| matches!(word, "EPSG" | "EPSG.XML"));
    let is_digits = last.bytes().all(|byte| byte.is_ascii_digit());
    (is_digits && (is_alone || is_epsg)).then(|| last.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_write_a_code_is_read() {
        for text in [
            "28992",
            "EPSG:28992",
            " epsg:28992 ",
            "urn:ogc:def:crs:EPSG::28992",
            "urn:ogc:def:crs:EPSG:9.6:28992",
            "urn:x-ogc:def:crs:EPSG:28992",
            "https://www.opengis.net/def/crs/EPSG/0/28992",
            "http://www.opengis.net/def/crs/EPSG/9.9.1/28992",
            "http://www.opengis.net/gml/srs/epsg.xml#28992",
            "urn:ogc:def:crs,crs:EPSG::28992,crs:EPSG::5709",
            "http://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/28992&2=http://www.opengis.net/def/crs/EPSG/0/5709",
            "EPSG:28992+5709",
        ] {
            assert_eq!(epsg_of(text), Some(28992), "{text}");
        }
        for text in
            ["urn:ogc:def:crs:OGC:1.3:CRS84", "OGC:CRS84", "http://www.opengis.net/def/crs/OGC/0/CRS84h", "crs84"]
        {
            assert_eq!(epsg_of(text), Some(4326), "{text}");
        }
    }

    #[test]
    fn other_text_is_no_code() {
        for text in [
            "",
            " ",
            ":",
            "EPSG:",
            "EPSG:RD",
            "RD New",
            "ESRI:102100",
            "IGNF:LAMB93",
            "EPSG:-1",
            "EPSG:99999999999",
            "é",
        ] {
            assert_eq!(epsg_of(text), None, "{text}");
        }
    }
}
