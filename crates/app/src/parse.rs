//! Values on the command line.

use glam::DVec3;

/// The most that a [`umbrae_core::Camera`] takes.
const MAX_SIDE_PX: u32 = 16384;
/// As for the coordinates of a mesh: beyond, products of four of them overflow `f32`.
const MAX_COORDINATE: f64 = 1e18;

/// `1280x720` into pixels across and down.
///
/// # Errors
///
/// A sentence when it is not two whole numbers from 1 to `MAX_SIDE_PX`.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is not a size; write pixels across and down, such as 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let size = [side(width)?, side(height)?];
    if size.contains(&0) {
        return Err(format!("a picture of {text} has no pixels; write a size such as 1280x720"));
    }
    if size.iter().any(|&side| side > MAX_SIDE_PX) {
        return Err(format!("a picture of {text} is too large; each side can be up to {MAX_SIDE_PX} pixels"));
    }
    Ok(size)
}

/// `1,2.5,-3` into a point.
///
/// # Errors
///
/// A sentence when it is not three finite numbers below 1e18.
pub fn xyz(text: &str) -> Result<DVec3, String> {
    let point = numbers(text).map(DVec3::from);
    let point = point.ok_or_else(|| format!("`{text}` is not a point; write x,y,z in metres, such as 10,-4.5,1.7"))?;
    if point.abs().max_element() >= MAX_COORDINATE {
        return Err(format!("`{text}` is too far away; coordinates must be below {MAX_COORDINATE:e}"));
    }
    Ok(point)
}

/// `235,38` into an azimuth and an altitude in degrees.
///
/// # Errors
///
/// A sentence when it is not two finite numbers, or the azimuth is not from -360 to 360 or the altitude from -90 to 90.
pub fn azimuth_altitude_deg(text: &str) -> Result<[f64; 2], String> {
    let [azimuth, altitude] = numbers(text).ok_or_else(|| {
        format!("`{text}` is not a sun; write degrees from north and degrees above the horizon, such as 235,38")
    })?;
    if !(-360.0..=360.0).contains(&azimuth) {
        return Err(format!("an azimuth of {azimuth:?} degrees is not from -360 to 360"));
    }
    if !(-90.0..=90.0).contains(&altitude) {
        return Err(format!("an altitude of {altitude:?} degrees is not from -90 to 90"));
    }
    Ok([azimuth, altitude])
}

/// `35` into a field of view in degrees.
///
/// # Errors
///
/// A sentence when it is not a number from 1 to 170.
pub fn fov_deg(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse().ok().filter(|degrees| (1.0..=170.0).contains(degrees));
    degrees.ok_or_else(|| format!("`{text}` is not a field of view; write degrees from 1 to 170, such as 35"))
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|n| n.trim().parse().ok().filter(|n: &f64| n.is_finite())).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_without_pixels_are_refused() {
        assert_eq!(picture_size("640x480"), Ok([640, 480]));
        for bad in ["0x0", "640x0", "640", "x", "-1x5", "640x480x3", "1e3x4", "16385x1"] {
            assert!(picture_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn points_are_three_finite_numbers() {
        assert_eq!(xyz("1, -2.5,3e2"), Ok(DVec3::new(1.0, -2.5, 300.0)));
        for bad in ["1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "a,b,c", "", "1e18,0,0", "0,-1e300,0"] {
            assert!(xyz(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn an_altitude_beyond_the_zenith_is_refused() {
        assert!(azimuth_altitude_deg("180,91").is_err());
        assert!(azimuth_altitude_deg("1e300,45").is_err());
        assert_eq!(azimuth_altitude_deg("-30,45"), Ok([-30.0, 45.0]));
    }

    #[test]
    fn what_is_parsed_makes_a_camera_and_what_is_not_does_not() {
        let camera = |fov_deg: f64, side_px: u32| {
            umbrae_core::Camera::new(DVec3::ZERO, DVec3::X, fov_deg.to_radians(), 1.0, [1, side_px])
        };
        for fov in ["1", "35", "170"] {
            assert!(camera(fov_deg(fov).expect(fov), MAX_SIDE_PX).is_ok(), "{fov}");
        }
        for fov in ["0", "-5", "171", "180", "nan", "inf", "", "wide"] {
            assert!(fov_deg(fov).is_err(), "{fov}");
        }
        assert!(camera(35.0, MAX_SIDE_PX + 1).is_err());
    }
}
