//! A ray tracer that knows nothing of umbrae: it reads the report, the model file and the mask, and must come to the mask's verdicts.
//!
//! This is what the report promises: everything that one needs to repeat each pixel's ray and verdict.

use serde_json::Value;

use crate::files::{Place, box_at};

type V = [f64; 3];

const SIZE: [usize; 2] = [96, 72];

/// What is seen at one point of the picture.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Seen {
    Nothing = 128,
    Lit = 255,
    Dark = 0,
}

fn sub(a: V, b: V) -> V {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// `a + b * s`
fn along(a: V, b: V, s: f64) -> V {
    [0, 1, 2].map(|i| a[i] + b[i] * s)
}

fn dot(a: V, b: V) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: V, b: V) -> V {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

fn unit(a: V) -> V {
    a.map(|c| c / dot(a, a).sqrt())
}

fn vector(value: &Value) -> V {
    serde_json::from_value(value.clone()).expect("three numbers")
}

/// The nearest triangle that the ray meets between `least` and `most`, and where (Möller and Trumbore 1997).
fn nearest(triangles: &[[V; 3]], from: V, direction: V, least: f64, most: f64) -> Option<(f64, &[V; 3])> {
    let meets = |triangle: &[V; 3]| {
        let [a, b, c] = *triangle;
        let (p, to) = (cross(direction, sub(c, a)), sub(from, a));
        let (determinant, q) = (dot(p, sub(b, a)), cross(to, sub(b, a)));
        let (u, v, t) = (dot(to, p) / determinant, dot(direction, q) / determinant, dot(sub(c, a), q) / determinant);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > least && t < most).then_some(t)
    };
    triangles.iter().filter_map(|t| Some((meets(t)?, t))).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// What the report says is drawn: the boxes of the file, whose faces have four corners each, and the ground; about the origin, in `f32`.
fn triangles(obj: &str, report: &Value) -> Vec<[V; 3]> {
    let (rows, origin) = (&report["models"][0]["world_from_file"], vector(&report["origin"]));
    let numbers = |line: &str| line.split(' ').skip(1).map(|n| n.parse::<f64>().expect("a number")).collect::<Vec<_>>();
    let rounded = |p: V| sub(p, origin).map(|c| f64::from(c as f32));
    let vertex = |line: &str| <V>::try_from(numbers(line)).expect("three numbers");
    let vertices: Vec<V> = obj.lines().filter(|l| l.starts_with("v ")).map(vertex).collect();
    let world: Vec<V> = vertices.iter().map(|&v| rounded([0, 1, 2].map(|i| dot(vector(&rows[i]), v)))).collect();
    let halves = |[a, b, c, d]: [V; 4]| [[a, b, c], [a, c, d]];
    let faces = obj.lines().filter(|l| l.starts_with("f ")).map(numbers);
    let ground = &report["ground"];
    let number = |value: &Value| value.as_f64().expect("a number");
    let corner = |x: f64, y: f64| {
        let at = |axis: usize, side: f64| number(&ground["center"][axis]) + side * number(&ground["half_extent"]);
        rounded([at(0, x), at(1, y), number(&ground["height"])])
    };
    faces
        .map(|f| [0, 1, 2, 3].map(|i| world[f[i] as usize - 1]))
        .chain([[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]])
        .flat_map(halves)
        .collect()
}

/// The verdict at `(x, y)` in pixels from the top left corner of the picture.
fn seen(triangles: &[[V; 3]], report: &Value, x: f64, y: f64) -> Seen {
    let (camera, light, origin) = (&report["camera"], &report["lights"][0], vector(&report["origin"]));
    let eye = sub(vector(&camera["eye"]), origin);
    let forward = unit(sub(sub(vector(&camera["target"]), origin), eye));
    let right = unit(cross(forward, vector(&camera["up"])));
    let half_height = (camera["fov_y_deg"].as_f64().expect("a number").to_radians() / 2.0).tan();
    let [width, height] = SIZE.map(|n| n as f64);
    let across = along(forward, right, half_height * width / height * (2.0 * x / width - 1.0));
    let ray = along(across, cross(right, forward), half_height * (1.0 - 2.0 * y / height));
    let near = camera["near"].as_f64().expect("a number");
    let Some((depth, &[a, b, c])) = nearest(triangles, eye, ray, near, f64::INFINITY) else { return Seen::Nothing };
    let point = along(eye, ray, depth);
    let is_sun = light["kind"] == "directional";
    let to_light =
        if is_sun { vector(&light["direction_to_light"]) } else { sub(sub(vector(&light["position"]), origin), point) };
    let normal = cross(sub(b, a), sub(c, a));
    let is_turned_away = dot(normal, to_light) * dot(normal, ray) >= 0.0;
    let end = if is_sun { f64::INFINITY } else { 1.0 };
    if is_turned_away || nearest(triangles, point, to_light, 1e-6, end).is_some() { Seen::Dark } else { Seen::Lit }
}

fn compare(obj: &str, options: &[&str]) {
    let place = Place::new();
    let model = place.file("boxes.obj", obj);
    let [picture, mask] = [place.out("x.png"), place.out("mask.png")];
    let args = ["render", &model, "-o", &picture, "--mask", &mask, "--json", "-", "--verify", "--size", "96x72"];
    let run = place.umbrae(&[&args[..], options].concat()).success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
    let mask = image::open(mask).expect("a picture").into_luma8().into_raw();
    let triangles = triangles(obj, &report);

    let (mut surface, mut decided, mut counts) = (0, 0, [0; 3]);
    for (pixel, &drawn) in mask.iter().enumerate() {
        let (x, y) = ((pixel % SIZE[0]) as f64 + 0.5, (pixel / SIZE[0]) as f64 + 0.5);
        let center = seen(&triangles, &report, x, y);
        surface += usize::from(center != Seen::Nothing);
        let around = [(-0.3, 0.0), (0.3, 0.0), (0.0, -0.3), (0.0, 0.3)];
        if around.iter().all(|(dx, dy)| seen(&triangles, &report, x + dx, y + dy) == center) {
            decided += 1;
            counts[[Seen::Nothing, Seen::Dark, Seen::Lit].iter().position(|s| *s == center).expect("one of three")] +=
                1;
            assert_eq!(drawn, center as u8, "at {x},{y}: the rays say {center:?} ({options:?})");
        }
    }
    assert_eq!(report["verify"]["surface"].as_u64(), Some(surface as u64), "{options:?}");
    assert!(decided * 100 > mask.len() * 90, "only {decided} of {} decided ({options:?})", mask.len());
    assert!(counts.iter().all(|&count| count > 100), "a dull view: {counts:?} ({options:?})");
}

#[test]
fn a_ray_tracer_that_knows_only_the_report_comes_to_the_same_mask() {
    let view = ["--eye", "7,-8,5", "--target", "0.3,0.2,1.5"];
    let at_zero = box_at([0.0; 3]);
    compare(&at_zero, &[&["--sun", "238,40"], &view[..]].concat());
    compare(&at_zero, &[&["--point", "-2.5,-1,4.5"], &view[..]].concat());
    compare(&at_zero, &["--eye", "2.2,2.1,0.4", "--target", "-3,-2,1.4", "--sun", "238,40", "--fov", "80"]);
    // In the file, y is up and z south.
    let far = ["--eye", "25000007,-4000008,100005", "--target", "25000000.3,-3999999.8,100001.5"];
    compare(&box_at([2.5e7, 1.0e5, 4.0e6]), &[&["--sun", "200,30"], &far[..]].concat());
    compare(&box_at([2.5e7, 1.0e5, 4.0e6]), &[&["--point", "24999997.5,-4000001,100004.5"], &far[..]].concat());
}
