//! Before and after.

use crate::files::{Place, box_at};
use crate::studied::{SLAB, Studied, WHEN};

#[test]
fn what_is_proposed_takes_sun_where_its_shadow_falls_and_nowhere_gives_any() {
    let place = Place::new();
    let (neighbour, tower) = (place.file("neighbour.obj", box_at([-40.0, 0.0, -30.0])), place.file("tower.obj", SLAB));
    let study = Studied::new(&place, "c", &format!("{neighbour} --proposed {tower} {WHEN} --spacing 2 --rule bre209"));
    let (_, _, before) = study.tif("hours_before.tif");
    let (_, _, after) = study.tif("hours_after.tif");
    let (_, _, difference) = study.tif("difference.tif");
    let mut lost = 0;
    for ((before, after), difference) in before.iter().zip(&after).zip(&difference) {
        assert_eq!(difference.is_nan(), before.is_nan() || after.is_nan());
        if !difference.is_nan() {
            assert!((after - before - difference).abs() < 1e-6 && *difference <= 0.0, "{before} {after} {difference}");
            lost += usize::from(*difference < 0.0);
        }
    }
    assert!(lost > 200, "{lost} cells");
    for name in ["difference.png", "hours_before.png", "hours_after.png", "bits_before.npz", "shadows_after.geojson"] {
        assert!(study.names().contains(&name.to_owned()), "{name} in {:?}", study.names());
    }
    let rows = study.rows();
    assert!(rows.iter().any(|row| row.number("difference") < -1.0));
    assert!(study.text("report.html").contains("Before"));
}

#[test]
fn what_goes_gives_its_sun_back() {
    let place = Place::new();
    let (neighbour, tower) = (place.file("neighbour.obj", box_at([-40.0, 0.0, -30.0])), place.file("tower.obj", SLAB));
    let study = Studied::new(&place, "c", &format!("{neighbour} --existing {tower} {WHEN} --spacing 2"));
    let (_, _, difference) = study.tif("difference.tif");
    assert!(difference.iter().all(|difference| difference.is_nan() || *difference >= 0.0));
    assert!(difference.iter().any(|difference| *difference > 4.0));
}
