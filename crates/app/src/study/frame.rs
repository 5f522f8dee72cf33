//! Where scene space is in the world.

use glam::DVec3;
use umbrae_formats::Crs;

/// From scene space to the model's own coordinates, and on to the Earth where that is known.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    /// A point of the scene plus this is a point of the model's own coordinates.
    pub(crate) origin: DVec3,
    /// What those are in; always projected.
    pub(crate) crs: Option<Crs>,
}

impl Frame {
    /// A point of the scene in the model's own coordinates.
    pub(crate) fn to_model(&self, scene: DVec3) -> DVec3 {
        scene + self.origin
    }

    /// Longitude and latitude (WGS 84, degrees) of a point of the scene; `None` where the model's coordinates are anywhere.
    pub(crate) fn to_lon_lat(&self, scene: DVec3) -> Option<[f64; 2]> {
        let crs = self.crs.as_ref()?;
        crs.lon_lat_of(self.to_model(scene).truncate()).ok().map(|place| place.to_array())
    }

    /// Where true north is at a point of the scene: clockwise from the y axis, in radians. `None` where nobody knows.
    pub(crate) fn true_north_rad(&self, scene: DVec3) -> Option<f64> {
        let crs = self.crs.as_ref()?;
        crs.convergence_rad(self.to_model(scene).truncate()).ok().map(|convergence| -convergence)
    }
}
