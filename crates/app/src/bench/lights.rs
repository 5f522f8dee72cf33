//! Lights that ask everything of who finds silhouettes: far, near, inside, in the planes of faces; and one that moves a little at a time.

use std::f64::consts::TAU;

use glam::DVec3;
use umbrae_core::{Caster, LightPosition};

use crate::random::Random;

const SEED: u64 = 0x0073_696c_686f_7565;
/// Of the midsummer sun at noon above the equator.
const DECLINATION_RAD: f64 = 23.44 * TAU / 360.0;
const LATITUDE_RAD: f64 = 48.0 * TAU / 360.0;
const MINUTES_OF_DAY: u32 = 24 * 60;

/// The lights of one model, as a GPU is told of them: rounded to `f32`.
#[derive(Debug)]
pub(super) struct Lights {
    /// Each in a place of its own.
    pub(super) apart: Vec<LightPosition>,
    /// The sun from its rising to its setting, minute by minute.
    pub(super) minutes: Vec<LightPosition>,
}

impl Lights {
    /// `count` lights for `casters`, the same ones on every run, and a day's sun. One of five is a sun, one is far away, one near by, one inside
    /// the box of all, and one in the plane of a triangle.
    pub(super) fn new(casters: &[Caster], count: usize) -> Self {
        let mut random = Random::new(SEED);
        let bounds = Caster::bounds_of(casters);
        let (middle, radius, size) = (bounds.center(), bounds.radius(), bounds.max - bounds.min);
        let with_triangles: Vec<&Caster> = casters.iter().filter(|c| !c.mesh.triangles().is_empty()).collect();
        let light = |i: usize| {
            let towards = direction(&mut random);
            let position = match i % 5 {
                0 => return sun(towards.with_z(towards.z.abs())),
                1 => middle + towards * radius * 10.0_f64.powf(random.between(1.0, 3.0).into()),
                2 => middle + towards * radius * f64::from(random.between(1.05, 2.0)),
                3 => bounds.min + size * DVec3::from_array([(); 3].map(|()| random.between(0.0, 1.0).into())),
                _ => {
                    let caster = random.pick(&with_triangles);
                    let [a, b, c] =
                        random.pick(caster.mesh.triangles()).map(|v| caster.positions[v as usize].as_dvec3());
                    let [u, v] = [b - a, c - a].map(|side| side * f64::from(random.between(-3.0, 3.0)));
                    // Every other of them is a sun.
                    if (i / 5).is_multiple_of(2) { a + u + v } else { return sun(u + v) }
                }
            };
            LightPosition::point(position).rounded_to_f32()
        };
        Self { apart: (0..count).map(light).collect(), minutes: minutes() }
    }
}

fn sun(towards: DVec3) -> LightPosition {
    LightPosition::directional(towards).unwrap_or(LightPosition::sun(0.0, 1.0)).rounded_to_f32()
}

/// Of length 1, each as likely.
fn direction(random: &mut Random) -> DVec3 {
    let z = f64::from(random.between(-1.0, 1.0));
    let (sin, cos) = (TAU * f64::from(random.between(0.0, 1.0))).sin_cos();
    let flat = (1.0 - z * z).sqrt();
    DVec3::new(cos * flat, sin * flat, z)
}

fn minutes() -> Vec<LightPosition> {
    let (sin_declination, cos_declination) = DECLINATION_RAD.sin_cos();
    let (sin_latitude, cos_latitude) = LATITUDE_RAD.sin_cos();
    let at = |minute: u32| {
        let (sin, cos) = (TAU * (f64::from(minute) / f64::from(MINUTES_OF_DAY) - 0.5)).sin_cos();
        DVec3::new(
            -cos_declination * sin,
            cos_latitude * sin_declination - sin_latitude * cos_declination * cos,
            sin_latitude * sin_declination + cos_latitude * cos_declination * cos,
        )
    };
    (0..MINUTES_OF_DAY).map(at).filter(|towards| towards.z > 0.0).map(sun).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, Vec3};
    use umbrae_core::{Mesh, Object, Topology, shapes};

    use super::*;

    fn lights(count: usize) -> Lights {
        let mesh = Arc::new(Mesh::new(shapes::cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0))).expect("a good mesh"));
        let topology = Arc::new(Topology::new(&mesh));
        Lights::new(&[Caster::new(&Object::new("box", mesh, DAffine3::IDENTITY), topology)], count)
    }

    #[test]
    fn lights_are_the_same_on_every_run_and_fewer_are_the_first_of_more() {
        let [few, more] = [lights(10).apart, lights(64).apart];
        assert_eq!(few, more[..10]);
        assert_eq!(more, lights(64).apart);
    }

    #[test]
    fn a_fifth_is_inside_and_a_fifth_in_the_plane_of_a_face() {
        let apart = lights(100).apart;
        let lamps = || apart.iter().filter(|light| !light.is_directional()).map(|light| light.homogeneous().truncate());
        let size = DVec3::new(1.0, 2.0, 3.0);
        let inside = lamps().filter(|p| p.cmpgt(DVec3::ZERO).all() && p.cmplt(size).all()).count();
        assert_eq!(inside, 20);
        let in_a_plane = |p: &DVec3| (0..3).any(|axis| p[axis].abs() < 1e-6 || (p[axis] - size[axis]).abs() < 1e-6);
        assert!(lamps().filter(in_a_plane).count() >= 10);
        assert!(apart.iter().filter(|light| light.is_directional()).count() >= 20);
    }

    #[test]
    fn the_midsummer_sun_shines_for_sixteen_hours_and_moves_a_quarter_of_a_degree_a_minute_at_most() {
        let minutes = minutes();
        let hours = minutes.len() as f64 / 60.0;
        assert!((15.7..16.2).contains(&hours), "{hours} hours at 48 degrees north");
        for pair in minutes.windows(2) {
            let [a, b] = [0, 1].map(|i| pair[i].homogeneous().truncate());
            assert!(a.angle_between(b).to_degrees() < 0.2501);
        }
        let highest = minutes.iter().map(|sun| sun.homogeneous().z.asin().to_degrees()).fold(0.0, f64::max);
        assert!((highest - (90.0 - 48.0 + 23.44)).abs() < 0.01, "{highest} degrees at noon");
    }
}
