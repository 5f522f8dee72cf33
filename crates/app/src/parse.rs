//! Values on the command line.

use glam::DVec3;

/// `1280x720` into pixels across and down.
///
/// # Errors
///
/// A sentence when it is not two whole numbers above 0.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is not a size; write pixels across and down, such as 1280x720");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let size = [side(width)?, side(height)?];
    if size.contains(&0) {
        return Err(format!("a picture of {text} has no pixels; write a size such as 1280x720"));
    }
    Ok(size)
}

/// `1,2.5,-3` into a point.
///
/// # Errors
///
/// A sentence when it is not three finite numbers.
pub fn xyz(text: &str) -> Result<DVec3, String> {
    numbers(text).map(DVec3::from).ok_or_else(|| format!("`{text}` is not a point; write x,y,z in metres, such as 10,-4.5,1.7"))
}

/// `235,38` into an azimuth and an altitude in degrees.
///
/// # Errors
///
/// A sentence when it is not two finite numbers, or the altitude is not from -90 to 90.
pub fn azimuth_altitude_deg(text: &str) -> Result<[f64; 2], String> {
    let [azimuth, altitude] = numbers(text).ok_or_else(|| {
        format!("`{text}` is not a sun; write degrees from north and degrees above the horizon, such as 235,38")
    })?;
    if !(-90.0..=90.0).contains(&altitude) {
        return Err(format!("an altitude of {altitude} degrees is not from -90 to 90"));
    }
    Ok([azimuth, altitude])
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
        for bad in ["0x0", "640x0", "640", "x", "-1x5", "640x480x3", "1e3x4"] {
            assert!(picture_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn points_are_three_finite_numbers() {
        assert_eq!(xyz("1, -2.5,3e2"), Ok(DVec3::new(1.0, -2.5, 300.0)));
        for bad in ["1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "a,b,c", ""] {
            assert!(xyz(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn an_altitude_beyond_the_zenith_is_refused() {
        assert!(azimuth_altitude_deg("180,91").is_err());
        assert_eq!(azimuth_altitude_deg("-30,45"), Ok([-30.0, 45.0]));
    }
}
