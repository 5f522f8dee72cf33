//! How shadows are determined, and what may be left out of it. Every choice but [`Method::ZPass`] gives the same verdicts.

use umbrae_core::{Bounds, Camera, FinderKind, OnScreen, Precision, Smoothness};

/// How volumes are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// z-pass where nothing of the near rectangle can be in the caster's shadow, else z-fail. Always right.
    #[default]
    Auto,
    /// z-pass for all: wrong where the near rectangle is in shadow.
    ZPass,
    /// z-fail for all: always right, and dearer.
    ZFail,
    /// z-pass for all, started at the number of volumes around the near rectangle (the lecture notes' method, section 3);
    /// z-fail for a caster whose volume has a side that crosses the near rectangle. Always right.
    EyeCount,
}

/// How pixels that the light can't change are kept out of counting, in place of the depth-bounds test that WebGPU lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LightMark {
    /// Not at all.
    Off,
    /// The light's reach as a convex body that inverts a stencil bit where it is behind what is seen: the bit is set exactly where what is
    /// seen is inside. Whatever the order of its faces, and with the eye inside too.
    #[default]
    Exact,
    /// The same body, whose back sets the bit and whose front clears it: marks all that is inside, and, depending on the order of faces,
    /// some of what is in front (id Software's `RB_StencilSelectLight`).
    Select,
    /// Every surface that the light would brighten if nothing shaded it: in reach, in the cone, and turned to the light. Draws the
    /// scene once more; a caller of its own passes draws it ([`crate::Shadows::draw_counts`]).
    Receivers,
}

/// Where silhouettes are found: which triangles face a light, which edges are between, and how each caster is counted.
///
/// On the CPU, light by light, and indices are uploaded in each frame. All give the same verdicts, but for triangles that `f32` can't tell from edge-on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SilhouetteSource {
    /// On the CPU, as is best for each caster: see [`umbrae_core::Silhouettes`].
    #[default]
    Auto,
    /// On the CPU, as one says.
    Cpu(FinderKind),
    /// By compute shaders, all lights of a frame at once; nothing of a triangle is on the CPU, and nothing is read back.
    /// [`Method::EyeCount`] counts as [`Method::Auto`] does. Needs [`crate::Tier::Full`].
    Gpu,
    /// By render passes into textures of integers, all lights of a frame at once; needs nothing that WebGL2 lacks. z-fail is chosen from boxes
    /// alone, so it draws more than [`SilhouetteSource::Gpu`], and each edge that might be on a silhouette goes through the vertex shader.
    /// [`Method::EyeCount`] counts as [`Method::Auto`] does.
    GpuBasic,
}

/// How finely smooth silhouettes are cut, for casters that were given as smooth bodies ([`crate::ShadowCasters::give_body`]); others cast the exact shadow
/// of their triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smooth {
    /// Not: all casters cast the shadows of their triangles.
    Off,
    /// Along the accurate silhouette on the mesh (A. Hertzmann and D. Zorin 2000), neither moved nor cut.
    Accurate,
    /// Along the curves of O. Mattausch et al. 2012.
    Curved {
        /// How far a curve may be off in the world, metres; more than 0.
        epsilon_m: f64,
        /// And its shadow on the picture, pixels; `None` if that does not matter.
        epsilon_px: Option<f64>,
    },
}

impl Smooth {
    /// What silhouettes follow, for shadows within `receivers` that `camera` looks at; `None` for those of triangles.
    pub(crate) fn smoothness(self, camera: &Camera, receivers: Bounds) -> Option<Smoothness> {
        match self {
            Self::Off => None,
            Self::Accurate => Some(Smoothness::Accurate),
            Self::Curved { epsilon_m, epsilon_px } => {
                let on_screen = |epsilon_px| OnScreen::of_camera(camera, receivers, epsilon_px);
                Some(Smoothness::Smooth(Precision { epsilon_m, on_screen: epsilon_px.map(on_screen) }))
            }
        }
    }
}

/// What is left out because it can't change a pixel, each with a switch so that its worth can be measured and its correctness
/// tested.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowOptions {
    /// How volumes are counted.
    pub method: Method,
    /// Whose silhouettes volumes are extruded from.
    pub smooth: Smooth,
    /// Where silhouettes are found.
    pub silhouettes: SilhouetteSource,
    /// A light whose reach is out of the view draws nothing.
    pub cull_lights: bool,
    /// A caster outside the light's reach or cone draws nothing.
    pub cull_unreached: bool,
    /// A caster whose shadow can't be in view draws nothing.
    pub cull_unseen: bool,
    /// A light cap or dark cap out of view is not drawn.
    pub cull_caps: bool,
    /// A light draws only into the rectangle around its reach.
    pub light_scissor: bool,
    /// A caster's volume draws only into the rectangle around its shadow.
    pub caster_scissor: bool,
    /// See [`LightMark`].
    pub light_mark: LightMark,
    /// Pictures have soft shadows of lights with a size ([`umbrae_core::Extent`]); else, and in masks, these are points and directions too.
    /// Silhouettes of such lights are found on the CPU, from the casters' positions there.
    pub soft: bool,
}

impl Default for ShadowOptions {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            smooth: Smooth::Off,
            silhouettes: SilhouetteSource::Auto,
            cull_lights: true,
            cull_unreached: true,
            cull_unseen: true,
            cull_caps: true,
            light_scissor: true,
            caster_scissor: true,
            light_mark: LightMark::default(),
            soft: false,
        }
    }
}

impl From<Method> for ShadowOptions {
    fn from(method: Method) -> Self {
        Self { method, ..Self::default() }
    }
}

impl ShadowOptions {
    /// `method` with nothing left out.
    pub fn without_culling(method: Method) -> Self {
        Self {
            method,
            smooth: Smooth::Off,
            silhouettes: SilhouetteSource::Auto,
            cull_lights: false,
            cull_unreached: false,
            cull_unseen: false,
            cull_caps: false,
            light_scissor: false,
            caster_scissor: false,
            light_mark: LightMark::Off,
            soft: false,
        }
    }

    /// These options with one rule off at a time, or another kind of mark, by name; and last with all off.
    pub fn each_rule_off(self) -> impl Iterator<Item = (&'static str, Self)> + Clone {
        [
            ("lights are not culled", Self { cull_lights: false, ..self }),
            ("casters out of reach are not culled", Self { cull_unreached: false, ..self }),
            ("casters with unseen shadows are not culled", Self { cull_unseen: false, ..self }),
            ("caps are not culled", Self { cull_caps: false, ..self }),
            ("no scissor for lights", Self { light_scissor: false, ..self }),
            ("no scissor for casters", Self { caster_scissor: false, ..self }),
            ("no light mark", Self { light_mark: LightMark::Off, ..self }),
            ("receivers marked", Self { light_mark: LightMark::Receivers, ..self }),
            ("selecting light mark", Self { light_mark: LightMark::Select, ..self }),
            (
                "nothing is left out",
                Self {
                    silhouettes: self.silhouettes,
                    smooth: self.smooth,
                    soft: self.soft,
                    ..Self::without_culling(self.method)
                },
            ),
        ]
        .into_iter()
    }
}
