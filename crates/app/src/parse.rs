//! Values on the command line.

use glam::{DVec3, Vec3};

/// The most that a [`umbrae_core::Camera`] takes.
const MAX_SIDE_PX: u32 = 16384;
/// As for the coordinates of a mesh: beyond, products of four of them overflow `f32`.
const MAX_COORDINATE: f64 = 1e18;

/// A narrower cone lights no pixel, and its edge is lost in `f32`.
const LEAST_CONE_DEG: f64 = 0.1;
/// A shorter length is lost beside the coordinates of `f32`.
const LEAST_LENGTH_M: f64 = 1e-6;
/// Beyond any lamp, and `f32` has room for its products with other numbers.
const MAX_CANDELA: f32 = 1e18;

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

/// `1.2x0.6` into a width and a height.
///
/// # Errors
///
/// A sentence when it is not two numbers as in [`metres`].
pub fn width_height(text: &str) -> Result<[f64; 2], String> {
    let (width, height) = text
        .split_once(['x', 'X'])
        .ok_or_else(|| format!("`{text}` is not a size; write width and height in metres, such as 1.2x0.6"))?;
    Ok([metres(width)?, metres(height)?])
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

/// A spot on the command line, in the model's coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpotPlace {
    /// Where it is.
    pub position: DVec3,
    /// The unit direction in which it shines.
    pub axis: DVec3,
    /// From the axis to where it shines no more.
    pub outer_deg: f64,
}

/// `1,2,3:0,0,-1:30` into a place, a direction of any length, and an angle in degrees.
///
/// # Errors
///
/// A sentence when it is not three parts, the place is not as in [`xyz`], the direction is zero, or the angle not as in [`cone_deg`].
pub fn spot(text: &str) -> Result<SpotPlace, String> {
    let [position, axis, outer] = <[&str; 3]>::try_from(text.split(':').collect::<Vec<_>>()).map_err(|_| {
        format!("`{text}` is not a spot; write its place, its direction and degrees, such as 10,-4.5,6:0,0,-1:30")
    })?;
    let direction = numbers(axis).map(DVec3::from);
    let axis = direction.and_then(DVec3::try_normalize).ok_or_else(|| {
        format!("`{axis}` is not a direction; write dx,dy,dz, not all of them 0, such as 0,0,-1 for downwards")
    })?;
    Ok(SpotPlace { position: xyz(position)?, axis, outer_deg: cone_deg(outer)? })
}

/// `0,0,2:1.5` into a centre and a radius.
///
/// # Errors
///
/// A sentence when it is not two parts, the centre is not as in [`xyz`], or the radius not as in [`metres`].
pub fn sphere(text: &str) -> Result<(DVec3, f64), String> {
    let (center, radius) = text.split_once(':').ok_or_else(|| {
        format!("`{text}` is not a sphere; write its centre and its radius in metres, such as 10,-4.5,6:1.5")
    })?;
    Ok((xyz(center)?, metres(radius)?))
}

/// `30` into degrees from the middle of a cone to its edge.
///
/// # Errors
///
/// A sentence when it is not a number above 0 and up to 90.
pub fn cone_deg(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse().ok().filter(|degrees| (LEAST_CONE_DEG..=90.0).contains(degrees));
    degrees.ok_or_else(|| {
        format!(
            "`{text}` is not an angle of a cone; write degrees from its middle to its edge, from {LEAST_CONE_DEG} to 90"
        )
    })
}

/// `1,0.5,0.2`, `#ff8800` or `orange` into a linear colour, each channel 0 to 1.
///
/// # Errors
///
/// A sentence when it is none of these, or not opaque.
pub fn linear_color(text: &str) -> Result<Vec3, String> {
    let wrong = || {
        format!(
            "`{text}` is not a colour; write r,g,b from 0 to 1 in linear light, or #rrggbb, or a name of CSS such as orange"
        )
    };
    if let Some(linear) = numbers(text) {
        let is_color = linear.iter().all(|channel| (0.0..=1.0).contains(channel));
        return if is_color { Ok(DVec3::from(linear).as_vec3()) } else { Err(wrong()) };
    }
    let color = csscolorparser::parse(text.trim()).map_err(|_| wrong())?;
    let [red, green, blue, alpha] = color.to_linear_rgba();
    let is_color = [red, green, blue].iter().all(|channel| (0.0..=1.0).contains(channel));
    if alpha < 1.0 || !is_color { Err(wrong()) } else { Ok(Vec3::new(red, green, blue)) }
}

/// `800` into candela.
///
/// # Errors
///
/// A sentence when it is not a number from 0, or one that `f32` can't hold with room to spare.
pub fn candela(text: &str) -> Result<f32, String> {
    let intensity = text.trim().parse().ok().filter(|candela| (0.0..=MAX_CANDELA).contains(candela));
    intensity.ok_or_else(|| {
        format!("`{text}` is not an intensity; write candela from 0 to {MAX_CANDELA:e}, such as 800 for a street lamp")
    })
}

/// `1.5` into seconds.
///
/// # Errors
///
/// A sentence when it is not a finite number from 0.
pub fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.trim().parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds >= 0.0);
    seconds.ok_or_else(|| format!("`{text}` is not a time; write seconds from 0, such as 1.5"))
}

/// `12.5` into a length above 0.
///
/// # Errors
///
/// A sentence when it is not a number above 0 and below 1e18.
pub fn metres(text: &str) -> Result<f64, String> {
    let length = text.trim().parse().ok().filter(|metres| (LEAST_LENGTH_M..MAX_COORDINATE).contains(metres));
    length.ok_or_else(|| {
        format!("`{text}` is not a length; write metres from {LEAST_LENGTH_M} to {MAX_COORDINATE:e}, such as 12.5")
    })
}

/// `0.5` into a part of the picture's pixels.
///
/// # Errors
///
/// A sentence when it is not a number from 0.01 to 100.
pub fn pixels(text: &str) -> Result<f64, String> {
    let pixels = text.trim().parse().ok().filter(|pixels| (0.01..=100.0).contains(pixels));
    pixels.ok_or_else(|| format!("`{text}` is no number of pixels; write one from 0.01 to 100, such as 0.5"))
}

/// `40` into the angle above which an edge is sharp, degrees.
///
/// # Errors
///
/// A sentence when it is not a number from 0 to 180.
pub fn crease_deg(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse().ok().filter(|degrees| (0.0..=180.0).contains(degrees));
    degrees
        .ok_or_else(|| format!("`{text}` is not an angle between two faces; write degrees from 0 to 180, such as 40"))
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
    fn a_lamp_s_size_is_two_lengths_above_0() {
        assert_eq!(width_height("1.2x0.6"), Ok([1.2, 0.6]));
        for bad in ["1.2", "0x1", "1x-1", "nanx1", "1x1e30", "x", "1x1x1"] {
            assert!(width_height(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn spheres_are_a_point_and_a_length() {
        assert_eq!(sphere("1,-2,3:0.5"), Ok((DVec3::new(1.0, -2.0, 3.0), 0.5)));
        for bad in ["1,2,3", "1,2:3", "1,2,3:0", "1,2,3:-1", "1,2,3:4:5", ":"] {
            assert!(sphere(bad).is_err(), "{bad}");
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
    fn a_spot_is_a_place_a_direction_and_an_angle() {
        let down = SpotPlace { position: DVec3::new(1.0, -2.0, 3.0), axis: DVec3::NEG_Z, outer_deg: 30.0 };
        assert_eq!(spot("1,-2,3:0,0,-7:30"), Ok(down));
        for bad in
            ["1,2,3", "1,2,3:0,0,-1", "1,2,3:0,0,0:30", "1,2:0,0,1:30", "1,2,3:0,0,-1:0", "1,2,3:0,0,-1:91", "::"]
        {
            assert!(spot(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn colours_are_linear_numbers_or_what_css_knows() {
        assert_eq!(linear_color("1, 0.5,0"), Ok(Vec3::new(1.0, 0.5, 0.0)));
        assert_eq!(linear_color("#fff"), Ok(Vec3::ONE));
        assert_eq!(linear_color("Red"), Ok(Vec3::X));
        // IEC 61966-2-1: half of sRGB is 0.214 of the light.
        let grey = linear_color("#808080").expect("a colour");
        assert!(grey.distance(Vec3::splat(0.2159)) < 1e-4, "{grey}");
        for bad in ["", "1,2,3", "1,0", "-0.1,0,0", "nan,0,0", "#12", "bluish", "#ff000080", "transparent"] {
            assert!(linear_color(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn strengths_and_lengths_are_finite_and_not_negative() {
        assert_eq!((candela("0"), candela("1e3")), (Ok(0.0), Ok(1000.0)));
        assert_eq!(metres("12.5"), Ok(12.5));
        for bad in ["-1", "nan", "inf", "1e19", "", "bright"] {
            assert!(candela(bad).is_err() && metres(bad).is_err(), "{bad}");
        }
        assert!(metres("0").is_err());
        assert_eq!((seconds("0"), seconds(" 2.5")), (Ok(0.0), Ok(2.5)));
        for bad in ["-1", "nan", "inf", "", "1:30"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "90.5", "nan"] {
            assert!(cone_deg(bad).is_err(), "{bad}");
        }
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
