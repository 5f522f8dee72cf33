//! The eye, and the reversed infinite projection through which it looks.
//!
//! Source: C. Wallner, "Geometry of real time shadows", 2007, section 6. We reverse depth (1 at the near plane,
//! 0 at infinity), which keeps float depth precise far away, and let x, y of clip space follow wgpu.

use glam::{DMat4, DVec2, DVec3, DVec4};

/// A perspective camera in scene space.
///
/// The eye, target and up are finite, eye and target differ, and the view direction is not along `up`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    fov_y_rad: f64,
    near: f64,
    size_px: [u32; 2],
}

/// Why a camera can't be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// Eye and target coincide, or a coordinate is not finite.
    #[error("the eye {eye} and the target {target} must be finite and differ")]
    NoDirection {
        /// The eye.
        eye: DVec3,
        /// The target.
        target: DVec3,
    },
    /// The picture has no pixel, or more than any device can draw.
    #[error("a picture of {width}x{height} pixels can't be drawn; each side must be 1 to {MAX_SIZE_PX}")]
    BadSize {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The field of view is not an angle that a flat picture can have.
    #[error("a field of view of {degrees} degrees can't be drawn; give 1 to 170")]
    BadFov {
        /// The angle asked for, in degrees.
        degrees: f64,
    },
    /// The near distance is not positive.
    #[error("a near distance of {near} m can't be used; it must be above 0")]
    BadNear {
        /// The distance asked for.
        near: f64,
    },
}

/// The largest texture side that every tier of device must support is 8192; 16384 is usual on desktop ones.
const MAX_SIZE_PX: u32 = 16384;

impl Camera {
    /// A camera at `eye` that looks at `target`, upright about +z (or +y when it looks along z).
    ///
    /// `fov_y_rad` is the full vertical angle; `near` the view depth, in metres, below which nothing is seen.
    ///
    /// # Errors
    ///
    /// [`CameraError`] names the value that can't be used.
    pub fn new(eye: DVec3, target: DVec3, fov_y_rad: f64, near: f64, size_px: [u32; 2]) -> Result<Self, CameraError> {
        let forward = (target - eye).try_normalize().filter(|_| eye.is_finite() && target.is_finite());
        let Some(forward) = forward else { return Err(CameraError::NoDirection { eye, target }) };
        // Looking within a hair of straight up or down leaves no upright about z.
        let up = if forward.z.abs() > 0.999_999 { DVec3::Y } else { DVec3::Z };
        Self::with_up(eye, target, up, fov_y_rad, near, size_px)
    }

    /// Like [`Camera::new`], upright about `up`, which must not be along the view direction.
    ///
    /// # Errors
    ///
    /// [`CameraError`] names the value that can't be used.
    pub fn with_up(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        fov_y_rad: f64,
        near: f64,
        size_px: [u32; 2],
    ) -> Result<Self, CameraError> {
        let [width, height] = size_px;
        if !(1..=MAX_SIZE_PX).contains(&width) || !(1..=MAX_SIZE_PX).contains(&height) {
            return Err(CameraError::BadSize { width, height });
        }
        let degrees = fov_y_rad.to_degrees();
        if !(0.999..=170.001).contains(&degrees) {
            return Err(CameraError::BadFov { degrees });
        }
        if !(near > 0.0 && near.is_finite()) {
            return Err(CameraError::BadNear { near });
        }
        let direction = target - eye;
        if !eye.is_finite() || !target.is_finite() || direction.cross(up).try_normalize().is_none() {
            return Err(CameraError::NoDirection { eye, target });
        }
        Ok(Self { eye, target, up, fov_y_rad, near, size_px })
    }

    /// Where the eye is, scene space.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// What it looks at, scene space.
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// The direction that is up in the picture (not necessarily across the view direction).
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The full vertical field of view.
    pub fn fov_y_rad(&self) -> f64 {
        self.fov_y_rad
    }

    /// The view depth, in metres, below which nothing is seen.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// Pixels across and down.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Unit vectors to the right, up and into the picture.
    pub fn axes(&self) -> [DVec3; 3] {
        let forward = (self.target - self.eye).normalize_or_zero();
        let right = forward.cross(self.up).normalize_or_zero();
        [right, right.cross(forward), forward]
    }

    /// Half the width and height of the picture at view depth 1.
    pub fn half_extent(&self) -> DVec2 {
        let half_height = (0.5 * self.fov_y_rad).tan();
        let [width, height] = self.size_px.map(f64::from);
        DVec2::new(half_height * width / height, half_height)
    }

    /// Clip space from scene space: reversed, infinite.
    ///
    /// A point at view depth `near` has depth 1; a point at infinity (`w = 0`) has depth exactly 0.
    pub fn clip_from_world(&self) -> DMat4 {
        let [right, up, forward] = self.axes();
        let half = self.half_extent();
        let row = |axis: DVec3, scale: f64| axis.extend(-axis.dot(self.eye)) * scale;
        DMat4::from_cols(
            row(right, 1.0 / half.x),
            row(up, 1.0 / half.y),
            DVec4::new(0.0, 0.0, 0.0, self.near),
            row(forward, 1.0),
        )
        .transpose()
    }

    /// The ray through the picture at `(x, y)` in pixels, (0, 0) the top left *corner* of the picture, so that
    /// `(0.5, 0.5)` is the middle of the first pixel.
    ///
    /// The direction has view depth 1: a point at parameter `t` on it is at view depth `t`, and seen only where
    /// `t >= near`.
    pub fn ray_direction(&self, x: f64, y: f64) -> DVec3 {
        let [right, up, forward] = self.axes();
        let half = self.half_extent();
        let [width, height] = self.size_px.map(f64::from);
        forward + right * (half.x * (2.0 * x / width - 1.0)) + up * (half.y * (1.0 - 2.0 * y / height))
    }

    /// The corners of the visible part of the near plane, in order around it.
    pub fn near_rectangle(&self) -> [DVec3; 4] {
        let [width, height] = self.size_px.map(f64::from);
        [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
            .map(|(x, y)| self.eye + self.ray_direction(x, y) * self.near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::new(DVec3::new(3.0, -10.0, 2.0), DVec3::new(0.0, 1.0, 0.5), 0.8, 0.25, [160, 90])
            .expect("a good camera")
    }

    #[test]
    fn a_point_at_infinity_lands_exactly_on_depth_0() {
        let clip = camera().clip_from_world().as_mat4() * glam::Vec4::new(0.3, 0.9, -0.2, 0.0);
        assert_eq!(clip.z.to_bits(), 0);
    }

    #[test]
    fn the_ray_of_a_pixel_projects_back_onto_that_pixel() {
        let camera = camera();
        let clip = camera.clip_from_world() * (camera.eye() + camera.ray_direction(17.25, 60.5) * 7.0).extend(1.0);
        let ndc = clip / clip.w;
        assert!((ndc.x - (2.0 * 17.25 / 160.0 - 1.0)).abs() < 1e-12);
        assert!((ndc.y - (1.0 - 2.0 * 60.5 / 90.0)).abs() < 1e-12);
        assert!((clip.w - 7.0).abs() < 1e-12, "w is the view depth");
    }

    #[test]
    fn the_near_rectangle_has_depth_1() {
        let camera = camera();
        for corner in camera.near_rectangle() {
            let clip = camera.clip_from_world() * corner.extend(1.0);
            assert!((clip.z / clip.w - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn looking_straight_down_is_a_good_camera() {
        let camera = Camera::new(DVec3::Z * 10.0, DVec3::ZERO, 0.8, 0.1, [4, 4]).expect("plan view");
        let [right, up, forward] = camera.axes();
        assert_eq!((right, up, forward), (DVec3::X, DVec3::Y, DVec3::NEG_Z), "north is up in a plan");
    }

    #[test]
    fn an_eye_at_its_target_is_refused() {
        let error = Camera::new(DVec3::ONE, DVec3::ONE, 0.8, 0.1, [4, 4]);
        assert!(matches!(error, Err(CameraError::NoDirection { .. })));
    }
}
