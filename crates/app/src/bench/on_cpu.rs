//! Times of the finders on the CPU, on one thread and in turns.

use umbrae_core::{Caster, Finder, FinderKind, Found, LightPosition};
use web_time::Instant;

use super::lights::Lights;
use super::report::{Figures, FinderTimes};

/// How often each light is measured; odd, so that the median is one of them.
const ROUNDS: usize = 5;

/// What all finders take for `casters`, in the order of [`FinderKind::ALL`] and then [`FinderKind::Coherent`] again, from minute to minute;
/// and how many edges are between different faces.
///
/// `make` makes them, on as many threads as it likes; finding is on one.
///
/// # Errors
///
/// When no thread can be started.
pub(super) fn measure(
    casters: &[Caster],
    lights: &Lights,
    make: impl Fn(&Caster, FinderKind) -> Finder,
) -> anyhow::Result<(Vec<FinderTimes>, usize)> {
    let built = FinderKind::ALL.map(|kind| Built::new(casters, kind, &make));
    let mut walks: Vec<Walk<'_>> = built.iter().map(|built| Walk::new(built, &lights.apart)).collect();
    let mut by_minutes = [FinderKind::Scan, FinderKind::Coherent].map(|kind| {
        let built = built.iter().find(|built| built.kind == kind).expect("all kinds were built");
        Walk::new(built, &lights.minutes)
    });
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one_thread.install(|| {
        compare(&mut walks);
        compare(&mut by_minutes);
        // In turns, so that what else the machine does hits all alike; a finder keeps its memory at hand during its turn.
        let [_, coherent] = &mut by_minutes;
        for _ in 0..ROUNDS {
            walks.iter_mut().for_each(Walk::go);
            coherent.go();
        }
    });
    let edges_between_faces = built[0].finders.iter().map(Finder::edge_count).sum();
    let [_, coherent] = by_minutes;
    let mut times: Vec<FinderTimes> = walks.into_iter().map(|walk| walk.times(walk.built.kind.name())).collect();
    times.push(FinderTimes { is_by_minutes: true, ..coherent.times(FinderKind::Coherent.name()) });
    Ok((times, edges_between_faces))
}

/// Finders of one kind, one for each caster.
struct Built {
    kind: FinderKind,
    finders: Vec<Finder>,
    build_ms: f64,
}

impl Built {
    fn new(casters: &[Caster], kind: FinderKind, make: impl Fn(&Caster, FinderKind) -> Finder) -> Self {
        let start = Instant::now();
        let finders = casters.iter().map(|caster| make(caster, kind)).collect();
        Self { kind, finders, build_ms: start.elapsed().as_secs_f64() * 1e3 }
    }
}

/// One kind of finder on its way along some lights.
struct Walk<'a> {
    built: &'a Built,
    lights: &'a [LightPosition],
    /// By each finder, of the light where the walk is.
    found: Vec<Found>,
    /// Of each light, in each round.
    us: Vec<[f64; ROUNDS]>,
    round: usize,
    tested: usize,
    edges: usize,
    is_equal: bool,
}

impl<'a> Walk<'a> {
    fn new(built: &'a Built, lights: &'a [LightPosition]) -> Self {
        let found = vec![Found::default(); built.finders.len()];
        let us = vec![[0.0; ROUNDS]; lights.len()];
        Self { built, lights, found, us, round: 0, tested: 0, edges: 0, is_equal: true }
    }

    fn find(&mut self, light: LightPosition) {
        self.built.finders.iter().zip(&mut self.found).for_each(|(finder, found)| finder.find(light, found));
    }

    /// Whether it found the same sides as `other`, each as often; sorts them.
    fn is_as(&mut self, other: &Self) -> bool {
        self.found.iter_mut().zip(&other.found).all(|(own, other)| {
            own.sides.sort_unstable();
            own.sides == other.sides
        })
    }

    /// Goes along all lights once, and takes the time for each.
    fn go(&mut self) {
        for i in 0..self.lights.len() {
            let start = Instant::now();
            self.find(self.lights[i]);
            self.us[i][self.round] = start.elapsed().as_secs_f64() * 1e6;
        }
        self.round += 1;
    }

    fn times(&self, name: &'static str) -> FinderTimes {
        let mean = |sum: usize| sum as f64 / self.lights.len() as f64;
        let mut each_us: Vec<f64> = self.us.iter().map(|rounds| Figures::of(&mut rounds.clone()).median).collect();
        let followed: usize = self.found.iter().map(Found::bytes).sum();
        FinderTimes {
            name,
            is_by_minutes: false,
            build_ms: self.built.build_ms,
            bytes: self.built.finders.iter().map(Finder::bytes).sum::<usize>() + followed,
            us: Figures::of(&mut each_us),
            edges_tested: mean(self.tested),
            edges_found: mean(self.edges),
            is_equal: self.is_equal,
        }
    }
}

/// Sends `walks` along their lights, which are the same, and compares what they find with what the scan among them does. So all memory has
/// been touched before times are taken.
fn compare(walks: &mut [Walk<'_>]) {
    let lights = walks[0].lights;
    for &light in lights {
        for walk in &mut *walks {
            walk.find(light);
            walk.tested += walk.found.iter().map(|found| found.tested).sum::<usize>();
            walk.edges += walk.found.iter().map(|found| found.sides.len()).sum::<usize>();
        }
        let scan = walks.iter().position(|walk| walk.built.kind == FinderKind::Scan).expect("the scan is among them");
        walks[..=scan].rotate_right(1);
        if let [scan, others @ ..] = &mut *walks {
            scan.found.iter_mut().for_each(|found| found.sides.sort_unstable());
            for other in others {
                other.is_equal &= other.is_as(scan);
            }
        }
        walks[..=scan].rotate_left(1);
    }
}
