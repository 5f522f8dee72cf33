//! What was measured, as a table for whoever reads and as JSON for whatever does.

use std::fmt::Write as _;

use serde::Serialize;

/// The median of values, and what 95 of a hundred are at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Figures {
    pub(super) median: f64,
    pub(super) p95: f64,
}

impl Figures {
    /// Of `values`, which are sorted; NaN where there is none. With an even number of them the median is the upper one of two.
    pub(super) fn of(values: &mut [f64]) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let at = |index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        Self { median: at(values.len() / 2), p95: at((values.len() * 95).div_ceil(100).saturating_sub(1)) }
    }
}

/// What one way of finding took.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FinderTimes {
    pub(super) name: &'static str,
    /// From minute to minute of a day's sun, and not under lights that are apart.
    pub(super) is_by_minutes: bool,
    pub(super) build_ms: f64,
    pub(super) bytes: usize,
    /// For each light.
    pub(super) us: Figures,
    /// Means over the lights.
    pub(super) edges_tested: f64,
    pub(super) edges_found: f64,
    pub(super) is_equal: bool,
}

impl FinderTimes {
    /// Its name, and which lights it had if they were others.
    pub(super) fn label(&self) -> String {
        if self.is_by_minutes { format!("{}, by minutes", self.name) } else { self.name.to_owned() }
    }
}

/// What all ways took for one model.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ModelTimes {
    /// As given.
    pub(super) model: String,
    pub(super) adapter: Option<String>,
    pub(super) triangles: usize,
    pub(super) edges: usize,
    pub(super) edges_between_faces: usize,
    pub(super) lights: usize,
    pub(super) minutes: usize,
    pub(super) finders: Vec<FinderTimes>,
    pub(super) peak_bytes: Option<u64>,
}

/// The JSON of one model.
#[derive(Debug, Serialize)]
pub(super) struct ModelJson<'a> {
    model: &'a str,
    triangles: usize,
    edges: usize,
    finders: Vec<FinderJson>,
}

#[derive(Debug, Serialize)]
struct FinderJson {
    name: &'static str,
    build_ms: f64,
    bytes: usize,
    median_us: f64,
    p95_us: f64,
    edges_tested: f64,
    edges_found: f64,
    equal: bool,
}

impl ModelTimes {
    pub(super) fn json(&self) -> ModelJson<'_> {
        let apart = self.finders.iter().filter(|finder| !finder.is_by_minutes);
        let json = |finder: &FinderTimes| {
            let by_minutes = self.finders.iter().find(|other| other.is_by_minutes && other.name == finder.name);
            let timed = by_minutes.unwrap_or(finder);
            FinderJson {
                name: finder.name,
                build_ms: finder.build_ms,
                bytes: finder.bytes,
                median_us: timed.us.median,
                p95_us: timed.us.p95,
                edges_tested: timed.edges_tested,
                edges_found: finder.edges_found,
                equal: finder.is_equal && timed.is_equal,
            }
        };
        ModelJson {
            model: &self.model,
            triangles: self.triangles,
            edges: self.edges,
            finders: apart.map(json).collect(),
        }
    }

    /// Lines for a terminal.
    pub(super) fn table(&self) -> String {
        let Self { model, triangles, edges, edges_between_faces, lights, minutes, .. } = self;
        let mut text = format!(
            "{}: {triangles} triangles, {edges} edges ({edges_between_faces} between different faces), {lights} lights\n\
             finder              build ms       bytes  median us     95% us      tested     found  as the scan\n",
            crate::talk::printable(model)
        );
        for finder in &self.finders {
            let name = finder.label();
            let is_equal = if finder.is_equal { "yes" } else { "NO" };
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{name:<20} {:>7.1} {:>11} {:>10.1} {:>10.1} {:>11.0} {:>9.0}  {is_equal}",
                finder.build_ms, finder.bytes, finder.us.median, finder.us.p95, finder.edges_tested, finder.edges_found
            );
        }
        let _ = writeln!(text, "by minutes: a midsummer day's sun in {minutes} steps of one minute");
        if let Some(adapter) = &self.adapter {
            let _ = writeln!(text, "on the GPU: {adapter}");
        }
        if let Some(bytes) = self.peak_bytes {
            let _ = writeln!(text, "peak memory so far: {:.0} MiB", bytes as f64 / f64::from(1 << 20));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_hundred_values_95_are_at_most_the_percentile() {
        let mut values: Vec<f64> = (0..100).rev().map(f64::from).collect();
        assert_eq!(Figures::of(&mut values), Figures { median: 50.0, p95: 94.0 });
        assert_eq!(Figures::of(&mut [3.0, 1.0, 2.0]), Figures { median: 2.0, p95: 3.0 });
        assert_eq!(Figures::of(&mut [7.0]), Figures { median: 7.0, p95: 7.0 });
    }
}
