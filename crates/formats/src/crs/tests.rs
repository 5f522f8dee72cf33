use super::*;

/// A position, and its longitude and latitude by PROJ 9, or as published.
type Place = (u32, [f64; 2], [f64; 2]);

fn assert_is_at((epsg, [x, y], [lon, lat]): Place, tolerance_m: f64) {
    let crs = Crs::from_epsg(epsg).expect("it is known");
    let at = DVec2::new(x, y);
    let found = crs.lon_lat_of(at).expect("a place in it");
    let off = (found - DVec2::new(lon, lat)) * DEGREE_M * DVec2::new(lat.to_radians().cos(), 1.0);
    assert!(off.length() < tolerance_m, "{crs}: {found} is off by {off} m");
    let back = crs.of_lon_lat(found).expect("a place on earth");
    assert!(back.distance(at) < 0.01, "{crs}: back at {back}");
}

/// Points for which the land surveys themselves publish both: the tower of Our Lady at Amersfoort (RDNAPTRANS, on
/// ETRS89), the old observatory of Bern (swisstopo, on CHTRS95).
#[test]
fn the_middles_of_the_dutch_and_the_swiss_maps_are_where_their_surveys_say() {
    assert_is_at((28992, [155_000.0, 463_000.0], [5.387_206_21, 52.155_174_40]), 0.5);
    assert_is_at((2056, [2_600_000.0, 1_200_000.0], [7.438_632_50, 46.951_082_78]), 0.1);
}

#[test]
fn places_all_over_the_world_are_where_proj_says() {
    let places = [
        (3946, [1_841_205.541_376_449, 5_176_065.184_761_938], [4.815_665_916, 45.770_160_365]),
        (6677, [-37_036.127, -8_715.29], [139.422_938_157, 35.920_745_106]),
        (25832, [458_880.0, 5_438_350.0], [8.436_718_245, 49.096_625_111]),
        (5555, [458_880.0, 5_438_350.0], [8.436_718_245, 49.096_625_111]),
        (32633, [602_000.0, 5_340_000.0], [16.372_837_556, 48.205_030_158]),
        (2154, [651_998.8, 6_860_881.0], [2.345_921_930, 48.846_184_947]),
        (9794, [651_998.8, 6_860_881.0], [2.345_921_930, 48.846_184_947]),
        (3006, [674_000.0, 6_580_000.0], [18.057_965_337, 59.322_873_218]),
        (3035, [4_321_000.0, 3_210_000.0], [10.0, 52.0]),
        (28992, [92_000.0, 437_000.0], [4.471_457_622, 51.917_915_331]),
        (7415, [92_000.0, 437_000.0], [4.471_457_622, 51.917_915_331]),
        // In feet: 987000 and 200000 of them.
        (2263, [300_838.201_676, 60_960.121_920], [-73.990_079_931, 40.715_630_071]),
    ];
    for place in places {
        assert_is_at(place, 0.01);
    }
    // PROJ 9 takes other shifts of these datums than our definitions, which are good to ten metres.
    for place in [
        (31256, [2_000.0, 340_000.0], [16.359_038_758, 48.198_406_948]),
        (27700, [530_000.0, 180_000.0], [-0.128_353_940, 51.503_990_828]),
        (5514, [-743_000.0, -1_043_000.0], [14.418_593_891, 50.087_346_615]),
    ] {
        assert_is_at(place, 10.0);
    }
}

/// Longitude 139.7, latitude 35.5 in each zone that reaches there, by PROJ 9.
#[test]
fn the_plane_rectangular_zones_of_japan_are_where_proj_says() {
    for (epsg, x, y) in [
        (6674, 335_741.738_8, -49_171.317_6),
        (6675, 229_849.395_3, -52_519.729_6),
        (6676, 108_866.996_6, -54_809.551_3),
        (6677, -12_096.046_0, -55_463.466_9),
        (6678, -102_818.563_4, -498_823.041_5),
        (6679, -49_896.426_9, -943_523.438_8),
    ] {
        assert_is_at((epsg, [x, y], [139.7, 35.5]), 0.001);
    }
    for epsg in 6669..=6687 {
        let zone = Crs::from_epsg(epsg).expect("one of nineteen");
        assert!(!zone.is_geographic() && zone.name().starts_with("JGD2011 / Japan Plane Rectangular CS"), "{zone}");
    }
}

/// To leading order, the convergence of a transverse Mercator map is atan(tan(dlon) sin(lat)).
#[test]
fn grid_north_of_utm_is_turned_as_the_closed_form_says() {
    for lat in [-72.0, -33.9, -1.0, 0.0, 12.5, 48.2, 63.0, 79.0_f64] {
        for dlon in [-2.9, -1.0, 0.0, 0.4, 1.372_837_556, 2.999_f64] {
            let lon_lat = DVec2::new(15.0 + dlon, lat);
            let zone = Crs::utm_of(lon_lat).expect("a zone");
            let at = zone.of_lon_lat(lon_lat).expect("it is in its zone");
            let expected = (dlon.to_radians().tan() * lat.to_radians().sin()).atan();
            let found = zone.convergence_rad(at).expect("far from a pole");
            // The next order is dlon³ e'² sin lat cos⁴ lat: 1e-6 at the most.
            assert!((found - expected).abs() < 1.5e-6, "{lon_lat}: {found} against {expected}");
        }
    }
}

/// In degrees, by PROJ 9. The stereographic map of the Netherlands and conic ones have closed forms of their own.
#[test]
fn grid_north_of_other_maps_is_turned_as_proj_says() {
    for (epsg, [x, y], expected_deg) in [
        (28992, [155_000.0, 463_000.0], 0.0),
        (28992, [92_000.0, 437_000.0], -0.722_099_0),
        (3946, [1_841_205.541, 5_176_065.185], 1.306_118_5),
        (2154, [651_998.8, 6_860_881.0], -0.474_604_1),
        (6677, [-37_036.127, -8_715.29], -0.240_767_5),
        (5514, [-743_000.0, -1_043_000.0], -7.834_414_1),
        (2263, [300_838.201_676, 60_960.121_920], 0.006_488_5),
    ] {
        let crs = Crs::from_epsg(epsg).expect("it is known");
        let found = crs.convergence_rad(DVec2::new(x, y)).expect("a place in it").to_degrees();
        // PROJ means the north of the own datum of the system, some seconds of arc off.
        assert!((found - expected_deg).abs() < 1e-3, "{crs}: {found} against {expected_deg}");
    }
    // A cone of latitude 46 all around: the convergence is (lon - 3) sin 46.
    let (lyon, lon) = (DVec2::new(1_841_205.541, 5_176_065.185), 4.815_665_9 - 3.0_f64);
    let closed = lon * 46.0_f64.to_radians().sin();
    let found = Crs::from_epsg(3946).expect("it is known").convergence_rad(lyon).expect("a place in it").to_degrees();
    assert!((found - closed).abs() < 1e-3, "{found} against {closed}");
}

#[test]
fn zones_of_utm_meet_where_they_should() {
    let zone = |lon, lat| Crs::utm_of(DVec2::new(lon, lat)).expect("a place on earth").epsg();
    assert_eq!([zone(-180.0, 1.0), zone(180.0, 1.0), zone(179.99, 1.0)], [32601, 32660, 32660]);
    assert_eq!([zone(5.99, 52.0), zone(6.0, 52.0), zone(18.42, -33.9)], [32631, 32632, 32734]);
    assert_eq!([zone(0.0, 0.0), zone(0.0, 83.9), zone(0.0, 84.0), zone(0.0, -80.1)], [32631, 32631, 32661, 32761]);
    assert_eq!(zone(200.0, 1.0), 32604, "longitudes may go on");
    for bad in [[f64::NAN, 0.0], [0.0, 90.1], [361.0, 0.0], [0.0, f64::INFINITY]] {
        assert!(Crs::utm_of(DVec2::from(bad)).is_err(), "{bad:?}");
    }
}

#[test]
fn a_web_map_is_one_and_a_half_times_too_large_and_a_good_one_is_not() {
    let vienna = DVec2::new(16.3728, 48.205);
    let scale = |epsg| {
        let crs = Crs::from_epsg(epsg).expect("it is known");
        crs.scale(crs.of_lon_lat(vienna).expect("it reaches there")).expect("a place in it")
    };
    assert!((scale(3857) - 1.0 / 48.205_f64.to_radians().cos()).abs() < 0.01, "{}", scale(3857));
    assert!((scale(32633) - 0.9996).abs() < 5e-4 && (scale(31256) - 1.0).abs() < 5e-4);
    assert_eq!(scale(4326), 1.0);
}

#[test]
fn units_are_those_of_the_definition() {
    let units = |epsg| Crs::from_epsg(epsg).map(|crs| [crs.unit_m(), crs.vertical_unit_m()]).expect("it is known");
    let us_foot = 1200.0 / 3937.0;
    assert_eq!(units(28992), [1.0, 1.0]);
    assert!(units(2263).iter().all(|unit| (unit - us_foot).abs() < 1e-12), "{:?}", units(2263));
    // New York with heights in feet of NAVD88, and Austria in metres throughout.
    assert!(units(6539).iter().all(|unit| (unit - us_foot).abs() < 1e-12), "{:?}", units(6539));
    assert_eq!(units(4326), [1.0, 1.0]);
}

#[test]
fn codes_of_one_projection_have_one_plane() {
    let crs = |epsg| Crs::from_epsg(epsg).expect("it is known");
    assert!(crs(28992).has_plane_of(&crs(7415)) && crs(25832).has_plane_of(&crs(5555)));
    assert!(!crs(28992).has_plane_of(&crs(25832)));
    let p = DVec2::new(84_616.468, 447_422.999);
    assert_eq!(crs(7415).position_in(&crs(28992), p), Ok(p), "bit for bit");
    let utm = crs(7415).position_in(&crs(32631), p).expect("it is there");
    assert!(crs(32631).position_in(&crs(7415), utm).expect("it is there").distance(p) < 0.01);
}

#[test]
fn what_is_no_place_is_never_given_a_number() {
    let utm = Crs::from_epsg(32633).expect("it is known");
    for bad in [[f64::NAN, 0.0], [1e9, 5e6], [f64::INFINITY, 0.0], [1e300, 1e300], [5e5, 3e7]] {
        let error = utm.lon_lat_of(DVec2::from(bad)).expect_err("it is nowhere").to_string();
        assert!(error.contains("is not a place in EPSG:32633 (WGS 84 / UTM zone 33N)"), "{error}");
        assert!(utm.convergence_rad(DVec2::from(bad)).is_err());
    }
    let degrees = Crs::wgs84();
    assert!(degrees.lon_lat_of(DVec2::new(16.0, 91.0)).is_err());
    assert!(utm.of_lon_lat(DVec2::new(105.0, 0.0)).is_err(), "a quarter of a turn away");
    assert!(Crs::from_epsg(2154).expect("it is known").of_lon_lat(DVec2::new(3.0, -90.0)).is_err());
}

#[test]
fn systems_that_can_not_be_used_say_why() {
    let error = |text: &str| Crs::parse(text).expect_err("it can't be used").to_string();
    assert_eq!(
        error("EPSG:1"),
        "EPSG:1 is no coordinate reference system that we know; name another one in which the model is"
    );
    assert_eq!(
        error("Lambert"),
        "\"Lambert\" names no coordinate reference system; write its EPSG code, like EPSG:28992"
    );
    assert!(error("EPSG:4978").contains("(WGS 84) can't be used: its coordinates count from the earth's centre"));
    assert!(error("EPSG:2048").contains("its axes do not point east and north"));
    assert!(error("EPSG:4807").contains("its angles are not degrees"));
    assert!(error("EPSG:27200").contains("its projection or the shift of its datum is missing here"));
}

/// Every definition can be made ready or says why not, and what can be projected comes back.
#[test]
fn no_definition_panics() {
    let mut usable = 0;
    for epsg in 0..=70_000 {
        let Ok(crs) = Crs::from_epsg(epsg) else { continue };
        usable += 1;
        for lon_lat in [[0.0, 0.0], [10.0, 50.0], [-100.0, 40.0], [140.0, -30.0], [180.0, 90.0]] {
            let Ok(p) = crs.of_lon_lat(DVec2::from(lon_lat)) else { continue };
            let _ = crs.convergence_rad(p);
            // On the rim of a projection the way there and back may be just too long.
            let Ok(back) = crs.lon_lat_of(p) else { continue };
            let off = (back - DVec2::from(lon_lat)).abs() * DEGREE_M;
            assert!(off.y < 0.1 && (off.x < 0.1 || lon_lat[1] == 90.0), "{crs}: {p} {back}");
        }
    }
    assert!(usable > 5_500, "only {usable}");
}
