//! How shadows are determined: the method, who casts, and a switch for everything that may be left out.

use clap::{Args, ValueEnum};
use umbrae_core::FinderKind;
use umbrae_render::{ShadowOptions, SilhouetteSource, Smooth};

use crate::cast::{CastChoice, Pattern};
use crate::parse::{crease_deg, metres, pixels};

/// How silhouettes are found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Silhouette {
    /// On the CPU, as suits each mesh
    #[default]
    Auto,
    /// Facing bits of all faces, then every edge through them
    Scan,
    /// A tree over the edges in dual space
    Dual,
    /// A tree over the surface with cones of normals
    Cones,
    /// What has changed since the last light
    Coherent,
    /// By compute shaders, for all lights at once; the report can't tell what only the GPU knows
    Gpu,
    /// In textures, for all lights at once, with no more than WebGL2 has; the report can't tell either
    GpuBasic,
}

/// How volumes are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// z-pass where it is safe, z-fail where it is needed: always right
    Auto,
    /// z-pass for all: fast, and wrong where the eye is in shadow
    Zpass,
    /// z-fail for all: always right
    Zfail,
    /// z-pass for all, from as many volumes as the eye is in; z-fail for a caster whose volume's side crosses the near rectangle: always right
    EyeCount,
}

/// Which silhouettes smooth shadows are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SmoothKind {
    /// Curves on the smooth surface
    Curved,
    /// Lines on the mesh, where normals turn away from the light
    Accurate,
}

/// How pixels that a light can't change are kept out of counting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LightMark {
    /// Not at all
    Off,
    /// By the light's reach, exactly: what is seen is inside it
    Exact,
    /// By the light's reach, and some of what is in front of it
    Select,
    /// By the surfaces that the light would brighten: in reach, in the cone, and turned to it
    Receivers,
}

/// Everything that was said about shadows.
#[derive(Debug, Args)]
#[command(next_help_heading = "Shadows")]
pub struct ShadowArgs {
    /// Only these cast shadows: names of objects or materials, separated by commas, in which * stands for anything and ? for one
    /// character; `umbrae inspect` lists them, and the ground is an object `ground`
    #[arg(long, value_name = "PATTERNS", value_delimiter = ',', value_parser = Pattern::new)]
    cast: Vec<Pattern>,

    /// These cast no shadow, even if --cast names them
    #[arg(long, value_name = "PATTERNS", value_delimiter = ',', value_parser = Pattern::new)]
    no_cast: Vec<Pattern>,

    /// Let glass (what glTF calls alpha mode BLEND) cast like anything else
    #[arg(long)]
    glass_casts: bool,

    /// How shadow volumes are counted
    #[arg(long, default_value = "auto")]
    method: Method,

    /// Cast the shadows of the smooth surfaces that vertex normals tell of, and shade by them: boundaries do not show how finely a mesh is cut.
    /// Objects that are not closed or have flat faces cast those of their triangles. `--smooth=accurate` stays on the mesh, where normals turn away from the light
    #[arg(
        long,
        value_name = "HOW",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "curved",
        conflicts_with = "verify",
        help_heading = SMOOTH
    )]
    smooth: Option<SmoothKind>,

    /// Cut each triangle of smooth objects into so many pieces a side, on the surface that they stand for, so that their own outlines are round too
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(2..=16),
        allow_hyphen_values = true,
        requires = "smooth",
        help_heading = SMOOTH
    )]
    pub tessellate: Option<u32>,

    /// How far a smooth silhouette may be from its curve, in metres
    #[arg(
        long,
        value_name = "M",
        default_value = "0.01",
        value_parser = metres,
        allow_hyphen_values = true,
        requires = "smooth",
        help_heading = SMOOTH
    )]
    epsilon: f64,

    /// How far its shadow may be from the curve's on the picture, in pixels; both hold
    #[arg(
        long,
        value_name = "PX",
        default_value = "0.5",
        value_parser = pixels,
        allow_hyphen_values = true,
        requires = "smooth",
        help_heading = SMOOTH
    )]
    epsilon_px: f64,

    /// Edges that bend by more than this stay sharp, in degrees; where a file gives normals, they tell
    #[arg(
        long,
        value_name = "DEG",
        default_value = "40",
        value_parser = crease_deg,
        allow_hyphen_values = true,
        requires = "smooth",
        help_heading = SMOOTH
    )]
    crease: f64,

    /// How silhouettes are found; changes no picture, only its cost. (With --smooth, `gpu` agrees with the others within --epsilon, and darkens a little
    /// more of a coarse body where it is edge on to the light.)
    #[arg(long, value_name = "HOW", default_value = "auto", hide_short_help = true)]
    silhouette: Silhouette,

    /// How pixels that a light can't change are kept out of counting; changes no picture, only its cost
    #[arg(long, value_name = "KIND", default_value = "exact", hide_short_help = true, help_heading = WORTH)]
    light_mark: LightMark,

    /// The same as --light-mark off
    #[arg(long, conflicts_with = "light_mark", hide_short_help = true, help_heading = WORTH)]
    no_light_mark: bool,

    /// Draw also what can't change a pixel: the same as the next four together
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_cull: bool,

    /// Draw also lights whose reach is out of view
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_light_cull: bool,

    /// Draw also the volumes of casters outside a light's range or cone
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_reach_cull: bool,

    /// Draw also the volumes of casters whose shadow can't be in view
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_view_cull: bool,

    /// Draw also caps that are out of view
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_cap_cull: bool,

    /// Draw into the whole picture: the same as the next two together
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_scissor: bool,

    /// Draw a light not only into the rectangle around its reach
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_light_scissor: bool,

    /// Draw a caster's volume not only into the rectangle around its shadow
    #[arg(long, hide_short_help = true, help_heading = WORTH)]
    no_caster_scissor: bool,

    /// Count for --json, light by light, the fragments that go into the stencil, and what all would cost if nothing were left out
    #[arg(long = "count-fragments", requires = "json", hide_short_help = true, help_heading = WORTH)]
    pub counts_fragments: bool,
}

/// Where these options stand in the help.
const SMOOTH: &str = "Smooth shadows";

/// No picture depends on them.
const WORTH: &str = "What is left out of counting; switches to measure its worth and to test it";

impl ShadowArgs {
    /// Who casts.
    pub fn cast_choice(&self) -> CastChoice {
        CastChoice { cast: self.cast.clone(), no_cast: self.no_cast.clone(), glass_casts: self.glass_casts }
    }

    /// Edges that bend by more stay sharp; `None` where nothing is smooth.
    pub fn crease_rad(&self) -> Option<f64> {
        self.smooth.map(|_| self.crease.to_radians())
    }

    /// How shadows are determined.
    pub fn options(&self) -> ShadowOptions {
        ShadowOptions {
            method: self.method.into(),
            smooth: match self.smooth {
                None => Smooth::Off,
                Some(SmoothKind::Accurate) => Smooth::Accurate,
                Some(SmoothKind::Curved) => {
                    Smooth::Curved { epsilon_m: self.epsilon, epsilon_px: Some(self.epsilon_px) }
                }
            },
            silhouettes: self.silhouette.into(),
            cull_lights: !(self.no_cull || self.no_light_cull),
            cull_unreached: !(self.no_cull || self.no_reach_cull),
            cull_unseen: !(self.no_cull || self.no_view_cull),
            cull_caps: !(self.no_cull || self.no_cap_cull),
            light_scissor: !(self.no_scissor || self.no_light_scissor),
            caster_scissor: !(self.no_scissor || self.no_caster_scissor),
            // Lights say themselves whether they are.
            soft: false,
            light_mark: if self.no_light_mark { LightMark::Off } else { self.light_mark }.into(),
        }
    }
}

impl Silhouette {
    /// As on the command line and in reports.
    pub fn name(source: SilhouetteSource) -> &'static str {
        match source {
            SilhouetteSource::Auto => "auto",
            SilhouetteSource::Cpu(kind) => kind.name(),
            SilhouetteSource::Gpu => "gpu",
            SilhouetteSource::GpuBasic => "gpu-basic",
        }
    }
}

impl Method {
    /// As on the command line and in reports.
    pub fn name(method: umbrae_render::Method) -> &'static str {
        match method {
            umbrae_render::Method::Auto => "auto",
            umbrae_render::Method::ZPass => "zpass",
            umbrae_render::Method::ZFail => "zfail",
            umbrae_render::Method::EyeCount => "eye-count",
        }
    }
}

impl LightMark {
    /// As on the command line and in reports.
    pub fn name(mark: umbrae_render::LightMark) -> &'static str {
        match mark {
            umbrae_render::LightMark::Off => "off",
            umbrae_render::LightMark::Exact => "exact",
            umbrae_render::LightMark::Select => "select",
            umbrae_render::LightMark::Receivers => "receivers",
        }
    }
}

impl From<Silhouette> for SilhouetteSource {
    fn from(silhouette: Silhouette) -> Self {
        match silhouette {
            Silhouette::Auto => Self::Auto,
            Silhouette::Scan => Self::Cpu(FinderKind::Scan),
            Silhouette::Dual => Self::Cpu(FinderKind::Dual),
            Silhouette::Cones => Self::Cpu(FinderKind::Cones),
            Silhouette::Coherent => Self::Cpu(FinderKind::Coherent),
            Silhouette::Gpu => Self::Gpu,
            Silhouette::GpuBasic => Self::GpuBasic,
        }
    }
}

impl From<Method> for umbrae_render::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Auto => Self::Auto,
            Method::Zpass => Self::ZPass,
            Method::Zfail => Self::ZFail,
            Method::EyeCount => Self::EyeCount,
        }
    }
}

impl From<LightMark> for umbrae_render::LightMark {
    fn from(mark: LightMark) -> Self {
        match mark {
            LightMark::Off => Self::Off,
            LightMark::Exact => Self::Exact,
            LightMark::Select => Self::Select,
            LightMark::Receivers => Self::Receivers,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        shadows: ShadowArgs,
        #[arg(long)]
        json: bool,
        #[arg(long)]
        verify: bool,
    }

    fn options(line: &str) -> ShadowOptions {
        let words = std::iter::once("umbrae").chain(line.split_whitespace());
        Line::try_parse_from(words).expect(line).shadows.options()
    }

    #[test]
    fn silhouettes_are_found_as_one_says() {
        for choice in Silhouette::value_variants() {
            let name = choice.to_possible_value().expect("none is hidden").get_name().to_owned();
            let silhouettes = (*choice).into();
            let expected = ShadowOptions { silhouettes, ..ShadowOptions::default() };
            assert_eq!(options(&format!("--silhouette {name}")), expected);
            assert_eq!(Silhouette::name(silhouettes), name);
        }
    }

    #[test]
    fn nothing_said_is_the_library_s_default() {
        assert_eq!(options(""), ShadowOptions::default());
    }

    #[test]
    fn each_switch_turns_one_rule_off() {
        let all = ShadowOptions::default();
        assert_eq!(options("--no-light-cull"), ShadowOptions { cull_lights: false, ..all });
        assert_eq!(options("--no-reach-cull"), ShadowOptions { cull_unreached: false, ..all });
        assert_eq!(options("--no-view-cull"), ShadowOptions { cull_unseen: false, ..all });
        assert_eq!(options("--no-cap-cull"), ShadowOptions { cull_caps: false, ..all });
        assert_eq!(options("--no-light-scissor"), ShadowOptions { light_scissor: false, ..all });
        assert_eq!(options("--no-caster-scissor"), ShadowOptions { caster_scissor: false, ..all });
        for (kind, light_mark) in [
            ("off", umbrae_render::LightMark::Off),
            ("exact", umbrae_render::LightMark::Exact),
            ("select", umbrae_render::LightMark::Select),
            ("receivers", umbrae_render::LightMark::Receivers),
        ] {
            assert_eq!(options(&format!("--light-mark {kind}")), ShadowOptions { light_mark, ..all });
            assert_eq!(LightMark::name(light_mark), kind);
        }
    }

    #[test]
    fn the_three_broad_switches_leave_nothing_out() {
        let method = umbrae_render::Method::EyeCount;
        let line = "--method eye-count --no-cull --no-scissor --no-light-mark";
        assert_eq!(options(line), ShadowOptions::without_culling(method));
        assert_eq!(Method::name(method), "eye-count");
    }
}
