//! What every file says about how it came about.

use crate::study::results::Results;
use crate::study::site::{days_text, hours_text, offsets};

/// Names and values, in the order in which a reader would ask for them.
pub(super) fn parameters(results: &Results) -> Vec<(&'static str, String)> {
    let site = &results.site;
    let steps = &results.timetable.steps;
    let step_s = steps.first().map_or(0.0, umbrae_study::Step::duration_s);
    let [largest_error_s, mean_error_s] = results.error_bounds_s();
    let mut parameters = vec![
        ("SUBJECT", results.subject.clone()),
        ("LATITUDE_DEG", format!("{:.6}", site.place.latitude_deg())),
        ("LONGITUDE_DEG", format!("{:.6}", site.place.longitude_deg())),
        ("PLACE_FROM", site.place_from.to_owned()),
        ("DATES", days_text(&results.timetable)),
        ("HOURS_OF_DAY", hours_text(&results.timetable)),
        ("CLOCK", site.clock.clone()),
        ("UTC_OFFSET", offsets(&results.timetable).join(", ")),
        ("STEP_SECONDS", format!("{step_s}")),
        ("STEPS", steps.len().to_string()),
        ("STEPS_WITH_SUN_UP", results.day_steps().to_string()),
        ("HOURS_POSSIBLE", format!("{:.4}", results.possible_hours())),
        ("SUN", results.sun_text()),
        ("TRUE_NORTH_DEG_CLOCKWISE_FROM_Y", format!("{:.4}", site.north_deg)),
        ("SKY", "clear: where the sun would reach without clouds".to_owned()),
        ("ERROR_BOUND_SECONDS_LARGEST", format!("{largest_error_s:.1}")),
        ("ERROR_BOUND_SECONDS_MEAN", format!("{mean_error_s:.1}")),
        ("PARTIAL", if results.is_partial { "yes" } else { "no" }.to_owned()),
        ("SOFTWARE", format!("umbrae {}", env!("CARGO_PKG_VERSION"))),
    ];
    if let Some(crs) = &results.frame.crs {
        parameters.insert(1, ("CRS", format!("EPSG:{} ({})", crs.epsg(), crs.name())));
    }
    parameters
}
