// Faces of shadow volumes, for the stencil only. Needs view.wgsl and light.wgsl.
//
// The fourth coordinate says what the first three are: 0 a vertex on the caster; 1 its copy at infinity, straight away from the
// light (for a directional light all copies are the same bits, because 0 * position vanishes); 2 a direction, for caps.

fn volume_position(vertex: vec4f) -> vec4f {
    var homogeneous = vec4f(vertex.xyz, view.unit);
    if vertex.w > 1.5 {
        homogeneous = vec4f(vertex.xyz, 0.0);
    } else if vertex.w > 0.5 {
        homogeneous = vec4f(vertex.xyz * light.position_world.w - light.position_world.xyz, 0.0);
    }
    return clip_position(homogeneous);
}

@vertex
fn vs_volume(@location(0) vertex: vec4f) -> @builtin(position) @invariant vec4f {
    return volume_position(vertex);
}

// One triangle that covers the picture, for the stencil alone.
@vertex
fn vs_everywhere(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// For passes that have colour attachments beside the stencil.
@fragment
fn fs_nothing() {
}

// +1 for each fragment.
@fragment
fn fs_one() -> @location(0) vec4f {
    return vec4f(1.0);
}

// +1 where a volume is entered, -1 where it is left.
@fragment
fn fs_signed(@builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return vec4f(select(-1.0, 1.0, is_front));
}
