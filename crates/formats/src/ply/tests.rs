use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use glam::Vec3;

use crate::{Format, LoadError, LoadOptions, Model, UpAxis, load_bytes};

fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    load_bytes(bytes, Format::Ply, "model.ply.gz", None, &LoadOptions { up: Some(UpAxis::Z), ..LoadOptions::default() })
}

fn model(bytes: &[u8]) -> Model {
    read(bytes).expect("a good file")
}

fn error(bytes: &[u8]) -> String {
    read(bytes).expect_err("a bad file").to_string()
}

fn zipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).expect("memory takes it");
    encoder.finish().expect("memory takes it")
}

const ASCII: &str = "ply\nformat ascii 1.0\ncomment caf\u{e9}\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

/// The square of [`ASCII`] in binary, with properties and elements that don't concern us in between.
fn binary(is_little: bool) -> Vec<u8> {
    let encoding = if is_little { "binary_little_endian" } else { "binary_big_endian" };
    let mut bytes = format!(
        "ply\r\nformat {encoding} 1.0\r\nelement camera 1\r\nproperty double fov\r\nproperty list int8 float64 lens\r\n\
         element vertex 4\r\nproperty uint8 flags\r\nproperty double x\r\nproperty int16 y\r\nproperty list uchar short tags\r\n\
         property float z\r\nelement face 1\r\nproperty float quality\r\nproperty list ushort uint vertex_index\r\n\
         element nothing 4000000000\r\nend_header\r\n"
    )
    .into_bytes();
    let mut put = |value: &[u8]| {
        if is_little {
            bytes.extend(value.iter().rev());
        } else {
            bytes.extend(value);
        }
    };
    put(&1.5_f64.to_be_bytes());
    put(&[1]);
    put(&2.5_f64.to_be_bytes());
    for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
        put(&[7]);
        put(&f64::from(x).to_be_bytes());
        put(&(y as i16).to_be_bytes());
        put(&[2]);
        put(&8_i16.to_be_bytes());
        put(&9_i16.to_be_bytes());
        put(&0_f32.to_be_bytes());
    }
    put(&0.5_f32.to_be_bytes());
    put(&4_u16.to_be_bytes());
    (0..4_u32).for_each(|i| put(&i.to_be_bytes()));
    bytes
}

#[test]
fn ascii_both_binaries_and_gzip_say_the_same() {
    let ascii = model(ASCII.as_bytes());
    assert_eq!(ascii.scene.objects[0].name, "model");
    assert_eq!(ascii.scene.triangle_count(), 2);
    let crlf = ASCII.replace('\n', "\r\n\r\n").into_bytes();
    let latin1: Vec<u8> = ASCII.chars().map(|c| c as u8).collect();
    for other in [binary(true), binary(false), zipped(&binary(true)), zipped(ASCII.as_bytes()), crlf, latin1] {
        assert_eq!(model(&other).scene.objects[0].mesh.positions(), ascii.scene.objects[0].mesh.positions());
    }
}

#[test]
fn what_does_not_concern_us_is_passed_over_and_counted() {
    let texts: Vec<String> = model(&binary(true)).warnings.iter().map(ToString::to_string).collect();
    assert_eq!(texts, ["1 row of another element was skipped (first: camera)"]);
    let tail = [ASCII.as_bytes(), b"1 2 3\n"].concat();
    let long = ASCII.replace("1 1 0", "1 1 0 9").replace("4 0 1 2 3", "4 0 1 2 3 255");
    assert_eq!(model(long.as_bytes()).warnings[0].to_string(), "2 rows have more values than properties");
    assert_eq!(model(&tail).warnings[0].to_string(), "6 bytes after the last element were skipped");
}

#[test]
fn colours_are_srgb_as_bytes_or_as_fractions() {
    for (kind, values) in [("uchar", "255 0 128"), ("float", "1 0 0.50196")] {
        let colour = format!("property {kind} red\nproperty {kind} green\nproperty {kind} blue\nelement face");
        let mut text = ASCII.replace("element face", &colour);
        for corner in ["0 0 0\n", "1 0 0\n", "1 1 0\n", "0 1 0\n"] {
            text = text.replacen(corner, &format!("{} {values}\n", corner.trim()), 1);
        }
        let color = model(text.as_bytes()).scene.objects[0].mesh.corner_colors()[0][0];
        assert!((color - Vec3::new(1.0, 0.0, 0.2158)).length() < 1e-4, "{kind}: {color}");
    }
}

#[test]
fn strips_turn_every_other_triangle_and_restart_at_minus_1() {
    let text = ASCII
        .replace("element face 1\nproperty list uchar int", "element tristrips 1\nproperty list int int")
        .replace("4 0 1 2 3", "8 0 1 3 2 -1 2 1 0");
    let mesh = model(text.as_bytes()).scene.objects[0].mesh.clone();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [2, 1, 3], [3, 1, 0]]);
}

#[test]
fn vertices_may_come_after_the_faces() {
    let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n\
        property float x\nproperty float y\nproperty float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0";
    assert_eq!(model(text.as_bytes()).scene.triangle_count(), 1);
}

#[test]
fn bad_headers_are_told_by_their_line() {
    let with = |from: &str, to: &str| error(ASCII.replace(from, to).as_bytes());
    assert_eq!(error(b"pl\n"), "model.ply.gz: line 1: a PLY file begins with a line \"ply\", not \"pl\"");
    assert!(with("ascii", "rot13").contains("line 2: \"format rot13 1.0\" is not a format"));
    assert!(with("vertex 4", "vertex -4").contains("line 4: \"element vertex -4\" is not an element"));
    assert!(with("float y", "quaternion y").contains("line 6: \"property quaternion y\" is not a property"));
    assert!(with("format ascii 1.0\n", "").contains("line 9: the header has no format line"));
    assert!(with("end_header\n", "").contains("line 10: \"0 0 0\" is not a line of a PLY header"));
    assert!(with("property float x\n", "").contains("vertex element lacks one of the properties x, y and z"));
    assert!(with("vertex_indices", "corners").contains("face element has no list vertex_indices"));
    assert!(error(b"ply\nformat ascii 1.0\n").contains("line 3: the file ends in its header"));
}

#[test]
fn counts_are_not_believed_before_the_bytes_are_there() {
    let with = |text: &str, from: &str, to: &str| error(text.replace(from, to).as_bytes());
    assert_eq!(
        with(ASCII, "vertex 4", "vertex 1000000000"),
        "model.ply.gz: line 10: the header announces 1000000000 rows of \"vertex\", but only 34 bytes are left; the file \
         was cut off or its header is wrong"
    );
    let binary = ASCII.replace("ascii", "binary_little_endian");
    assert!(
        with(&binary, "vertex 4", "vertex 18446744073709551615")
            .contains("the header announces 18446744073709551615 rows")
    );
    assert!(with(ASCII, "4 0 1 2 3", "4000000000 0 1 2 3").contains("line 15: a list announces 4000000000 items"));
}

#[test]
fn bad_rows_are_told_by_their_line_or_byte() {
    let with = |from: &str, to: &str| error(ASCII.replace(from, to).as_bytes());
    assert!(with("1 1 0\n", "1 1\n").contains("line 13: the line ends before its last value"));
    assert!(with("1 1 0\n", "1 l 0\n").contains("line 13: \"l\" is not a number"));
    assert!(with("4 0 1 2 3\n", "\n").contains("the file ends after 0 of 1 rows of \"face\""));
    assert!(with("4 0 1 2 3", "4 0 1 2 4").contains("face 0: it names vertex 4, but there are 4 (from 0)"));
    assert!(with("4 0 1 2 3", "3 0 1 -1").contains("face 0: it names vertex -1"));
    assert!(with("4 0 1 2 3", "3 0 1 1.5").contains("face 0: it names vertex"));
    assert!(with("1 1 0\n", "1 nan 0\n").contains("vertex 2: (1, NaN, 0) is not a position"));
    assert!(with("4 0 1 2 3", "2 0 1").contains("no usable face in it; vertices: 4"));
    let cut = binary(true);
    assert!(error(&cut[..cut.len() - 1]).contains("byte "));
}

#[test]
fn an_archive_that_is_damaged_or_blows_up_is_refused() {
    let good = zipped(ASCII.as_bytes());
    assert!(error(&good[..good.len() - 9]).contains("the gzip archive is damaged"));
    let zeros = zipped(&[ASCII.as_bytes(), &vec![b' '; 1_000_000]].concat());
    assert!(error(&zeros).contains("unpacks to more than 64 times its"));
}

#[test]
fn normals_are_those_of_the_vertices_at_each_corner() {
    let properties = "property float nx\nproperty float nz\nproperty double ny\nelement face";
    let text = ASCII
        .replace("element face", properties)
        .replace("0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "0 0 0 1 0 0\n1 0 0 0 2 0\n1 1 0 0 0 3\n0 1 0 nan 0 0\n");
    let options = |up| LoadOptions { up: Some(up), normals: true, ..LoadOptions::default() };
    let with_normals = |text: &str, up| load_bytes(text.as_bytes(), Format::Ply, "model.ply", None, &options(up));
    let square = with_normals(&text, UpAxis::Z).expect("a good file");
    let mesh = &square.scene.objects[0].mesh;
    let expected = [Vec3::X, Vec3::Z, Vec3::Y, Vec3::ZERO];
    let mut corners = 0;
    for (&corner, &normal) in mesh.triangles().as_flattened().iter().zip(mesh.corner_normals().as_flattened()) {
        assert_eq!(normal, expected[mesh.source_vertices()[corner as usize] as usize]);
        corners += 1;
    }
    assert_eq!(corners, 6);
    let without = mesh.corner_normals().as_flattened().iter().filter(|&&normal| normal == Vec3::ZERO).count();
    assert_eq!((square.warnings.len(), square.warnings[0].count), (1, without));
    assert!(square.warnings[0].message.contains("not finite"), "{:?}", square.warnings);
    let y_up = with_normals(&text, UpAxis::Y).expect("a good file");
    assert!(y_up.scene.objects[0].mesh.corner_normals().as_flattened().contains(&Vec3::NEG_Y), "the file's z");
    assert!(model(text.as_bytes()).scene.objects[0].mesh.corner_normals().is_empty(), "nobody asked for them");
    let without_nz = with_normals(&text.replace("float nz", "float n_z"), UpAxis::Z).expect("a good file");
    assert!(without_nz.scene.objects[0].mesh.corner_normals().is_empty() && without_nz.warnings.is_empty());
}
