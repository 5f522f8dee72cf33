//! Smooth shadows of real models against rays through the curved surfaces that they stand for.
//!
//! Each model gets suns and lamps from all sides, and for each of them:
//!
//! - its volume is closed, and counts are the same on every path;
//! - its shadow on a screen behind it is that of the finely cut surface, pixel by pixel, but for a band about that one's boundary, and where two parts of it
//!   overlap by less than twice [`subject::THIN`], so that an error of that size on both of them bares the light between them;
//! - what its normals turn to the light is not in its own shadow, unless something is in the way, but for such a band.
//!
//! Run with `--nocapture` for the tables. `UMBRAE_SMOOTH=all` takes 64 lights and more pixels and points.

#[path = "smooth/against.rs"]
mod against;
#[path = "smooth/screen.rs"]
mod screen;
mod shared_data;
#[path = "smooth/subject.rs"]
mod subject;

use glam::DVec3;
use umbrae_core::{LightPosition, RayCaster};

use against::{Random, SelfShadow};
use screen::Screen;
use subject::{Lit, Subject};

/// How much is looked at.
struct Effort {
    lights: u32,
    /// On the longer side of the screen.
    longest_px: usize,
    /// On the body.
    samples: usize,
    /// About the body.
    points: u32,
}

impl Effort {
    fn asked_for() -> Self {
        if std::env::var_os("UMBRAE_SMOOTH").is_some_and(|effort| effort == "all") {
            return Self { lights: 64, longest_px: 400, samples: 20_000, points: 12 };
        }
        Self { lights: 8, longest_px: 160, samples: 4_000, points: 4 }
    }
}

/// Differences are expected within so much of the reference's boundary: on the screen in halves of the shadow's size, on the body in its radii, where the
/// distance between points that are asked adds to it.
#[derive(Debug, Clone, Copy)]
struct Bands {
    on_screen: f64,
    on_body: f64,
    /// Of the points of the body that are lit, so few stray.
    most_strays: f64,
}

/// How two shadows differ on the screen, over all lights.
#[derive(Debug, Clone, Copy, Default)]
struct OnScreen {
    pixels: usize,
    dark: usize,
    /// Lit where the reference is dark, but only just: its surface, moved inward a little, is lit too.
    thin: usize,
    /// Other pixels that are farther from the reference's boundary than the band.
    strays: usize,
    /// The farthest from it but for those that are thin, and the light.
    farthest: (f64, usize),
}

impl OnScreen {
    /// `differences` in halves of the shadow's size from the reference's boundary, and whether the shadow is thin there.
    fn add(&mut self, differences: impl Iterator<Item = (f64, bool)>, light: usize, band: f64) {
        for (far, is_thin) in differences {
            self.pixels += 1;
            let is_thin = far > band && is_thin;
            self.thin += usize::from(is_thin);
            self.strays += usize::from(far > band && !is_thin);
            if far > self.farthest.0 && !is_thin {
                self.farthest = (far, light);
            }
        }
    }

    fn describe(&self) -> String {
        let percent = 100.0 * self.pixels as f64 / self.dark.max(1) as f64;
        format!(
            "{percent:.3} % differ, {} stray, {} thin, {:.1} % far (light {})",
            self.strays,
            self.thin,
            100.0 * self.farthest.0,
            self.farthest.1
        )
    }
}

/// All that was found out about one model.
#[derive(Debug, Default)]
struct Findings {
    smooth: OnScreen,
    discrete: OnScreen,
    on_body: SelfShadow,
    counts: usize,
}

#[expect(clippy::print_stdout, reason = "the table is what the test is run for")]
fn check(name: &str, file: &str, pieces: u32, bands: Bands) {
    let Some(folder) = shared_data::folder() else { return };
    let effort = Effort::asked_for();
    let subject = Subject::new(&folder.join(file), pieces);
    let mut random = Random(1);
    let samples = against::samples(&subject, effort.samples, &mut random);
    let mut found = Findings::default();
    for (i, light) in subject.lights(effort.lights).into_iter().enumerate() {
        let lit = subject.lit(light);
        for volume in &lit {
            assert!(volume.smooth.is_closed() && volume.discrete.is_closed(), "{name} under light {i}");
        }
        let caps: Vec<RayCaster> = lit.iter().map(against::cap_of).collect();
        for _ in 0..effort.points {
            found.counts += same_on_every_path(&subject, &lit, &caps, light, &mut random);
        }
        let screen = Screen::behind(&subject, light, effort.longest_px);
        let by_rays = screen.of_rays(&subject);
        let [mut smooth, mut discrete] = [screen.lit(), screen.lit()];
        for (part, volume) in subject.parts.iter().zip(&lit) {
            screen.add_sides(&volume.positions, &volume.smooth.sides, &mut smooth);
            screen.add_sides(&part.caster.positions, &volume.discrete.sides, &mut discrete);
        }
        let dark = by_rays.dark.iter().filter(|&&dark| dark).count();
        for (mask, on_screen) in [(smooth, &mut found.smooth), (discrete, &mut found.discrete)] {
            let differences = mask.differences(&by_rays).into_iter().map(|difference| {
                let is_lit_twice = !mask.dark[difference.pixel]
                    && !subject.is_blocked_amply(screen.middle_of(difference.pixel), light);
                (difference.to_boundary_px / screen.half_shadow_px(), is_lit_twice)
            });
            on_screen.add(differences, i, bands.on_screen);
            on_screen.dark += dark;
        }
        found.on_body.add(against::self_shadow(&subject, &caps, &samples, light, bands.on_body));
    }
    println!("{}", table(name, &subject, &found, bands));
    let share = |some: usize, of: usize| some as f64 / of.max(1) as f64;
    assert!(found.counts > 0, "{name}: no count was decided");
    assert_eq!(found.smooth.strays, 0, "{name}, on the screen: {found:#?}");
    assert!(share(found.on_body.strays, found.on_body.lit) <= bands.most_strays, "{name}, on the body: {found:#?}");
}

/// A random point's count for each part along several ways, which must agree; how many were decided.
fn same_on_every_path(
    subject: &Subject,
    lit: &[Lit],
    caps: &[RayCaster],
    light: LightPosition,
    random: &mut Random,
) -> usize {
    let mut any = || DVec3::from_array(std::array::from_fn(|_| 2.0 * random.next() - 1.0));
    // From within the body to well behind it.
    let away = -light.offset_from(subject.bounds.center()).normalize_or_zero();
    let point = subject.bounds.center() + subject.radius_m * (0.7 * any() + 1.5 * any().x.max(0.0) * away);
    let ways = [any(), any()];
    let mut decided = 0;
    for (volume, cap) in lit.iter().zip(caps) {
        let to_light = against::count_to_light(cap, point, light);
        for way in ways {
            if let Some(count) = volume.smooth.count_to_infinity(&volume.positions, light, point, way) {
                assert_eq!(count, to_light, "at {point} along {way} and to the light {light:?}");
                decided += 1;
            }
        }
    }
    decided
}

fn table(name: &str, subject: &Subject, found: &Findings, bands: Bands) -> String {
    let smooth = subject.parts.iter().filter(|part| part.smooth.is_some());
    let triangles: usize = smooth.map(|part| part.caster.mesh.triangles().len()).sum();
    let all: usize = subject.parts.iter().map(|part| part.caster.mesh.triangles().len()).sum();
    let percent = |points: usize| 100.0 * points as f64 / found.on_body.lit.max(1) as f64;
    let on_body = format!(
        "{:.3} % of {} points darkened, {:.3} % leak, {:.4} % stray, {:.1} % far (at {:.3})",
        percent(found.on_body.darkened),
        found.on_body.lit,
        percent(found.on_body.leaked),
        percent(found.on_body.strays),
        100.0 * found.on_body.farthest,
        found.on_body.worst
    );
    format!(
        "{name}: {triangles} of {all} triangles smooth, {} counts; bands {:.1} % on the screen, {:.1} % on the body\n  smooth    {}\n  discrete  {}\n  on body   {on_body}",
        found.counts,
        100.0 * bands.on_screen,
        100.0 * bands.on_body,
        found.smooth.describe(),
        found.discrete.describe()
    )
}

#[test]
fn the_control_mesh_of_a_cow() {
    check(
        "spot_control_mesh",
        "mesh/spot_control_mesh.obj",
        10,
        Bands { on_screen: 0.02, on_body: 0.15, most_strays: 0.001 },
    );
}

#[test]
fn a_cow() {
    check(
        "spot_low_resolution",
        "mesh/spot_low_resolution.obj",
        6,
        Bands { on_screen: 0.02, on_body: 0.1, most_strays: 0.0001 },
    );
}

#[test]
fn a_bunny() {
    check("bunny_closed", "mesh/bunny_closed.obj", 4, Bands { on_screen: 0.02, on_body: 0.1, most_strays: 0.0001 });
}

#[test]
fn an_armadillo() {
    check("armadillo", "mesh/armadillo.obj", 3, Bands { on_screen: 0.02, on_body: 0.1, most_strays: 0.0001 });
}

#[test]
fn a_dragon() {
    check("dragon_100k", "mesh/dragon_100k.ply", 2, Bands { on_screen: 0.02, on_body: 0.1, most_strays: 0.0005 });
}

#[test]
fn a_bust() {
    check("nefertiti", "mesh/nefertiti-lowres.obj", 2, Bands { on_screen: 0.02, on_body: 0.1, most_strays: 0.0001 });
}

#[test]
fn a_walking_man() {
    check("CesiumMan", "gltf/CesiumMan.glb", 5, Bands { on_screen: 0.02, on_body: 0.1, most_strays: 0.0001 });
}
