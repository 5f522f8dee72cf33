// Faces of shadow volumes, for the stencil only. Needs view.wgsl and light.wgsl.
//
// `extruded` is 0 for a vertex on the caster and 1 for its copy at infinity, straight away from the light.
// For a directional light all copies are the same bits, because 0 * position vanishes.

@vertex
fn vs_volume(@location(0) vertex: vec4f) -> @builtin(position) @invariant vec4f {
    let extruded = vertex.w > 0.5;
    let on_caster = vec4f(vertex.xyz, view.unit);
    let at_infinity = vec4f(vertex.xyz * light.position_world.w - light.position_world.xyz, 0.0);
    return clip_position(select(on_caster, at_infinity, extruded));
}
