//! The shaders in GLSL. Not on Apple's systems, where nothing that we use writes it.

use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;
use naga::valid::Capabilities;

use super::tests::sources;

#[test]
fn every_shader_is_glsl_as_webgl2_has_it() {
    let mut written = 0;
    for (name, source) in sources() {
        let module = naga::front::wgsl::parse_str(&source).expect("valid WGSL");
        let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).expect("valid without any capability");
        for entry_point in &module.entry_points {
            let options = glsl::Options {
                version: glsl::Version::Embedded { version: 300, is_webgl: true },
                ..glsl::Options::default()
            };
            let pipeline = glsl::PipelineOptions {
                shader_stage: entry_point.stage,
                entry_point: entry_point.name.clone(),
                multiview: None,
            };
            let mut text = String::new();
            let writer =
                glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, BoundsCheckPolicies::default());
            let result = writer.and_then(|mut writer| writer.write().map(|_| ()));
            assert!(result.is_ok(), "{name}, {}: {:?}", entry_point.name, result.err());
            assert!(text.starts_with("#version 300 es"));
            written += 1;
        }
    }
    assert!(written >= 12, "{written} entry points");
}
