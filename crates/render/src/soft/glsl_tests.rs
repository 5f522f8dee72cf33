//! The shaders of one sample a pixel in GLSL, as WebGL2 has it. Not on Apple's systems, where nothing that we use writes it.

use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;
use naga::valid::Capabilities;

const VIEW: &str = include_str!("../shaders/view.wgsl");
const LIGHT: &str = include_str!("../shaders/light.wgsl");

#[test]
fn every_shader_is_glsl_as_webgl2_has_it() {
    let coverage = [
        VIEW,
        LIGHT,
        include_str!("../shaders/volume.wgsl"),
        include_str!("../shaders/light_face.wgsl"),
        include_str!("../shaders/soft_coverage.wgsl"),
        include_str!("../shaders/soft_depth.wgsl"),
    ];
    let composite = [include_str!("../shaders/soft_composite.wgsl")];
    let mut written = 0;
    for source in [coverage.concat(), composite.concat()] {
        let module = naga::front::wgsl::parse_str(&source).expect("valid WGSL");
        let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).expect("valid without any capability");
        for entry_point in &module.entry_points {
            let version = glsl::Version::Embedded { version: 300, is_webgl: true };
            let options = glsl::Options { version, ..glsl::Options::default() };
            let (shader_stage, entry_point) = (entry_point.stage, entry_point.name.clone());
            let pipeline = glsl::PipelineOptions { shader_stage, entry_point: entry_point.clone(), multiview: None };
            let mut text = String::new();
            let unchecked = BoundsCheckPolicies::default();
            let writer = glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, unchecked);
            let result = writer.and_then(|mut writer| writer.write().map(|_| ()));
            assert!(result.is_ok(), "{entry_point}: {:?}", result.err());
            written += 1;
        }
    }
    assert!(written >= 9, "{written} entry points");
}
