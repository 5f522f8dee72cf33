use glam::{DAffine3, DVec2, DVec3, Vec3};
use std::sync::Arc;
use umbrae_core::*;
fn load(p: &str) -> Caster {
    let text = std::fs::read_to_string(p).unwrap();
    let mut s = Surface::default();
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        match w.first() {
            Some(&"v") => {
                let c: Vec<f32> = w[1..4].iter().map(|x| x.parse().unwrap()).collect();
                s.positions.push(Vec3::new(c[0], -c[2], c[1]));
            }
            Some(&"f") => {
                let i: Vec<u32> =
                    w[1..].iter().map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                for k in 1..i.len() - 1 {
                    s.triangles.push([i[0], i[k], i[k + 1]]);
                }
            }
            _ => {}
        }
    }
    let mesh = Arc::new(Mesh::new(s).unwrap());
    let topology = Arc::new(Topology::new(&mesh));
    Caster::new(&Object::new("b", mesh, DAffine3::IDENTITY), topology)
}
#[test]
fn dbg() {
    let c = load("/work/shared/data/mesh/spot_control_mesh.obj");
    println!("{} triangles", c.mesh.triangles().len());
    let light = LightPosition::sun(200f64.to_radians(), 30f64.to_radians());
    let body = SmoothBody::new(&c, &corner_normals(&c, &[], 40f64.to_radians())).unwrap();
    let v = SmoothVolume::new(&body, light, &Smoothness::Smooth(Precision::in_world(0.001)));
    let z0 = c.bounds.min.z;
    let sh = |p: DVec3| {
        let a = -light.offset_from(p);
        (p + a * ((z0 - p.z) / a.z)).truncate()
    };
    let segs: Vec<[DVec2; 2]> = v.sides.iter().map(|s| s.map(|p| sh(v.points[p as usize].as_dvec3()))).collect();
    let wind = |p: DVec2| -> i32 {
        segs.iter()
            .map(|&[a, b]| {
                let l = (b - a).perp_dot(p - a) > 0.0;
                match (a.y <= p.y, b.y <= p.y) {
                    (true, false) if l => 1,
                    (false, true) if !l => -1,
                    _ => 0,
                }
            })
            .sum()
    };
    for (i, &[a, b]) in segs.iter().enumerate() {
        if a.distance(b) < 1e-9 {
            continue;
        }
        let n = (b - a).perp() / a.distance(b);
        let m = a.lerp(b, 0.37);
        for sgn in [1.0, -1.0] {
            for d in [1e-5, 1e-4, 3e-4, 1e-3] {
                if wind(m + n * (sgn * d)) == 0 && wind(m + n * (sgn * 0.02)) != 0 && wind(m - n * (sgn * 0.02)) != 0 {
                    println!(
                        "side {i} {:?} of {:?} -> {:?} sliver at {d} side {sgn}; winding {} .. {}",
                        v.sides[i],
                        v.points[v.sides[i][0] as usize],
                        v.points[v.sides[i][1] as usize],
                        wind(m + n * (sgn * 0.02)),
                        wind(m - n * (sgn * 0.02))
                    );
                }
            }
        }
    }
}
#[test]
fn dbg2() {
    let c = load("/work/shared/data/mesh/spot_control_mesh.obj");
    let light = LightPosition::sun(200f64.to_radians(), 30f64.to_radians());
    let l = light.homogeneous().truncate();
    let normals = corner_normals(&c, &[], 40f64.to_radians());
    let near = |p: Vec3, q: Vec3| p.distance(q) < 1e-4;
    let (p, q) = (Vec3::new(0.320339, 0.0977066, -0.0229878), Vec3::new(0.0998053, 0.247516, -0.204538));
    for (t, n) in normals.iter().enumerate() {
        let k = c.corners(t);
        if k.iter().any(|&x| near(x, p)) && k.iter().any(|&x| near(x, q)) {
            let f = (k[1] - k[0]).cross(k[2] - k[0]).as_dvec3().normalize();
            println!("tri {t} face.l {:.4}", f.dot(l));
            for i in 0..3 {
                println!(
                    "   {:?} n {:?} g {:.4}  n.f {:.4}",
                    k[i],
                    n[i],
                    n[i].as_dvec3().dot(l),
                    n[i].as_dvec3().dot(f)
                );
            }
        }
    }
}
#[test]
fn dbg3() {
    let c = load("/work/shared/data/mesh/spot_control_mesh.obj");
    let light = LightPosition::sun(200f64.to_radians(), 30f64.to_radians());
    let body = SmoothBody::new(&c, &corner_normals(&c, &[], 40f64.to_radians())).unwrap();
    let v = SmoothVolume::new(&body, light, &Smoothness::Smooth(Precision::in_world(0.001)));
    for (i, s) in v.sides.iter().enumerate().skip(146).take(18) {
        println!("S {i} {:?} {:?} {:?}", s, v.points[s[0] as usize], v.points[s[1] as usize]);
    }
    let l = light.homogeneous().truncate();
    let normals = corner_normals(&c, &[], 40f64.to_radians());
    let q = Vec3::new(0.212644, 0.238571, 0.767482);
    for (t, n) in normals.iter().enumerate() {
        let k = c.corners(t);
        if k.iter().any(|x| x.distance(q) < 1e-4) {
            let f = (k[1] - k[0]).cross(k[2] - k[0]).as_dvec3().normalize();
            println!("T {t} face.l {:.4}", f.dot(l));
            for i in 0..3 {
                println!(
                    "T   {:?} n {:?} g {:.4}  n.f {:.4}",
                    k[i],
                    n[i],
                    n[i].as_dvec3().dot(l),
                    n[i].as_dvec3().dot(f)
                );
            }
        }
    }
}
