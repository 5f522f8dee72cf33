// Faces of shadow volumes, for the stencil only. Needs view.wgsl and light.wgsl.
//
// The fourth coordinate says what the first three are: 0 a vertex on the caster; 1 its copy at infinity, straight away from the
// light (for a directional light all copies are the same bits, because 0 * position vanishes); 2 a direction, for caps.

@vertex
fn vs_volume(@location(0) vertex: vec4f) -> @builtin(position) @invariant vec4f {
    var homogeneous = vec4f(vertex.xyz, view.unit);
    if vertex.w > 1.5 {
        homogeneous = vec4f(vertex.xyz, 0.0);
    } else if vertex.w > 0.5 {
        homogeneous = vec4f(vertex.xyz * light.position_world.w - light.position_world.xyz, 0.0);
    }
    return clip_position(homogeneous);
}
