//! Receivers from a table.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use glam::{DVec3, Vec3};

use super::scene::file_name;

/// A point with its name and normal (zero: open to all sides), scene space.
type Point = (String, DVec3, Vec3);

/// Reads a CSV file with a header of x, y, z, perhaps nx, ny, nz and perhaps id, in any order and case; other columns are left alone. Coordinates are
/// the model's, and `origin` is taken off. Returns what to call the points, and them.
///
/// # Errors
///
/// When the file can't be read, a column is missing, or a value is no finite number; with its line.
pub(super) fn read(path: &Path, origin: DVec3) -> anyhow::Result<(String, Vec<Point>)> {
    let bytes = fs::read(path).with_context(|| format!("can't read `{}`", path.display()))?;
    let text = std::str::from_utf8(&bytes).with_context(|| {
        format!("can't use the points in `{}`: they are not UTF-8 text; save them as CSV in UTF-8", path.display())
    })?;
    let points = parse(text, origin).with_context(|| format!("can't use the points in `{}`", path.display()))?;
    Ok((file_name(path), points))
}

fn parse(text: &str, origin: DVec3) -> anyhow::Result<Vec<Point>> {
    let text = text.trim_start_matches('\u{feff}');
    let first_line = text.lines().next().unwrap_or_default();
    ensure!(!first_line.trim().is_empty(), "its first line is empty; it must name the columns x, y and z");
    let delimiter = if first_line.contains(';') { b';' } else { b',' };
    let mut reader =
        csv::ReaderBuilder::new().delimiter(delimiter).trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers()?.iter().map(str::to_ascii_lowercase).collect();
    for name in ["x", "y", "z", "nx", "ny", "nz", "id"] {
        let count = names.iter().filter(|other| *other == name).count();
        ensure!(count <= 1, "its first line names the column {name} {count} times");
    }
    let column = |name: &str| names.iter().position(|other| other == name);
    let place: Vec<usize> = ["x", "y", "z"].iter().filter_map(|name| column(name)).collect();
    let [x, y, z] = place[..] else {
        bail!("its first line is `{first_line}`; it must name the columns x, y and z");
    };
    let normal: Vec<usize> = ["nx", "ny", "nz"].iter().filter_map(|name| column(name)).collect();
    ensure!(normal.is_empty() || normal.len() == 3, "it has some of the columns nx, ny and nz; give all three or none");
    let id = column("id");
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        ensure!(
            record.len() <= names.len(),
            "line {line} has {} values for {} columns; write decimals with a point, or separate columns by semicolons",
            record.len(),
            names.len()
        );
        let number = |column: usize| -> anyhow::Result<f64> {
            let cell = record.get(column).unwrap_or_default();
            let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
            number.with_context(|| format!("line {line}: `{cell}` in column {} is not a finite number", names[column]))
        };
        let position = DVec3::new(number(x)?, number(y)?, number(z)?) - origin;
        let normal = match normal[..] {
            [nx, ny, nz] => {
                let normal = DVec3::new(number(nx)?, number(ny)?, number(nz)?).try_normalize();
                normal.with_context(|| format!("line {line}: the normal is zero; give a direction"))?.as_vec3()
            }
            _ => Vec3::ZERO,
        };
        let name = id.and_then(|id| record.get(id)).map_or_else(|| points.len().to_string(), str::to_owned);
        points.push((name, position, normal));
    }
    ensure!(!points.is_empty(), "it has a header and no point");
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_any_order_and_points_are_about_the_origin() {
        let points = parse("\u{feff}ID;z;Y;x\nwindow 1;3;2;1001\n\n\"b\";0;0;1000\n", DVec3::new(1000.0, 0.0, 0.0));
        let points = points.expect("good points");
        assert_eq!(points[0], ("window 1".to_owned(), DVec3::new(1.0, 2.0, 3.0), Vec3::ZERO));
        assert_eq!((points[1].0.as_str(), points[1].1), ("b", DVec3::ZERO));
    }

    #[test]
    fn normals_become_unit_vectors() {
        let points = parse("x,y,z,nx,ny,nz\n1,2,3,0,-5,0\n", DVec3::ZERO).expect("good points");
        assert_eq!(points, [("0".to_owned(), DVec3::new(1.0, 2.0, 3.0), Vec3::NEG_Y)]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let cases = [
            ("", "its first line is empty"),
            ("x,y,z,x\n1,2,3,4\n", "names the column x 2 times"),
            ("x,y,z\n1,5,2,5,3\n", "line 2 has 5 values for 3 columns"),
            ("x,y\n1,2\n", "must name the columns x, y and z"),
            ("x,y,z\n", "a header and no point"),
            ("x,y,z\n1,2,3\n1,two,3\n", "line 3: `two` in column y is not a finite number"),
            ("x,y,z\n1,2\n", "line 2: `` in column z is not a finite number"),
            ("x,y,z\n1,2,inf\n", "line 2: `inf` in column z"),
            ("x,y,z,nx,ny,nz\n1,2,3,0,0,0\n", "line 2: the normal is zero"),
            ("x,y,z,nx\n1,2,3,0\n", "all three or none"),
        ];
        for (text, words) in cases {
            let said = parse(text, DVec3::ZERO).expect_err(text).to_string();
            assert!(said.contains(words), "{text:?} says {said}");
        }
    }
}
