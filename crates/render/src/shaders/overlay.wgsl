// Translucent triangles and lines over the lit picture. Colours are premultiplied. Needs view.wgsl.

struct Overlay {
    // Pixels across and down.
    size_px: vec2f,
    // Half of the lines' width.
    half_width_px: f32,
    // What a hidden line keeps of its opacity.
    hidden_opacity: f32,
    // Lines come nearer by this share of their distance, so that they win over the surfaces on which they lie.
    lift: f32,
    unused_0: f32,
    unused_1: f32,
    unused_2: f32,
}

@group(1) @binding(0) var<uniform> overlay: Overlay;

struct Vertex {
    @location(0) position_world: vec4f,
    @location(1) color: vec4f,
}

struct Covered {
    // As surfaces have it, so that a triangle with a surface's corners has its depth.
    @builtin(position) @invariant clip: vec4f,
    @location(0) color: vec4f,
}

@vertex
fn vs_triangle(vertex: Vertex) -> Covered {
    return Covered(clip_position(vertex.position_world), vertex.color);
}

@fragment
fn fs_triangle(covered: Covered) -> @location(0) vec4f {
    return covered.color;
}

struct Line {
    @location(0) start_world: vec4f,
    @location(1) start_color: vec4f,
    @location(2) end_world: vec4f,
    @location(3) end_color: vec4f,
}

struct Stroke {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
    // Pixels along the line from its start, and across it.
    @location(1) place_px: vec2f,
    @location(2) @interpolate(flat) length_px: f32,
}

// How far inside the pieces of space that the line may not leave: beyond the near plane, and so wide of each side of the picture that
// no end can be seen but coordinates stay small. Positive inside, linear along the line.
fn inside(clip: vec4f, side: u32) -> f32 {
    let wide = 1.0 + 8.0 * (overlay.half_width_px + 1.0) / min(overlay.size_px.x, overlay.size_px.y);
    switch side {
        case 0u: { return clip.w - clip.z; }
        case 1u: { return wide * clip.w + clip.x; }
        case 2u: { return wide * clip.w - clip.x; }
        case 3u: { return wide * clip.w + clip.y; }
        default: { return wide * clip.w - clip.y; }
    }
}

// Six corners of the rectangle around one line: as long as it is seen, and wider by a pixel's fringe all round.
@vertex
fn vs_line(line: Line, @builtin(vertex_index) corner: u32) -> Stroke {
    let start = clip_position(line.start_world);
    let end = clip_position(line.end_world);
    var from_start = 0.0;
    var to_end = 1.0;
    for (var side = 0u; side < 5u; side++) {
        let at_start = inside(start, side);
        let at_end = inside(end, side);
        if at_start < 0.0 && at_end < 0.0 {
            to_end = -1.0;
        } else if at_start < 0.0 {
            from_start = max(from_start, at_start / (at_start - at_end));
        } else if at_end < 0.0 {
            to_end = min(to_end, at_start / (at_start - at_end));
        }
    }
    let a = mix(start, end, from_start);
    let b = mix(start, end, to_end);
    if from_start >= to_end || a.w <= 0.0 || b.w <= 0.0 {
        // Nothing of it is seen: no area.
        return Stroke(vec4f(0.0, 0.0, 0.0, 1.0), vec4f(0.0), vec2f(0.0), 0.0);
    }

    // From here on everything is linear on the screen, depth too.
    let a_px = a.xy / a.w * 0.5 * overlay.size_px;
    let b_px = b.xy / b.w * 0.5 * overlay.size_px;
    let length_px = distance(a_px, b_px);
    var along = vec2f(1.0, 0.0);
    if length_px > 1e-4 {
        along = (b_px - a_px) / length_px;
    }
    let fringe_px = overlay.half_width_px + 1.0;
    let is_end = corner == 1u || corner == 4u || corner == 5u;
    let is_left = corner == 2u || corner == 3u || corner == 5u;
    let place_px = vec2f(select(-fringe_px, length_px + fringe_px, is_end), select(-fringe_px, fringe_px, is_left));
    let screen = (a_px + along * place_px.x + vec2f(-along.y, along.x) * place_px.y) * 2.0 / overlay.size_px;
    let depth = select(a.z / a.w, b.z / b.w, is_end);
    let color = mix(line.start_color, line.end_color, select(from_start, to_end, is_end));
    return Stroke(vec4f(screen, min(depth * (1.0 + overlay.lift), 1.0), 1.0), color, place_px, length_px);
}

// The share of a pixel that the line covers: by the distance from the segment, so ends are round.
fn coverage(stroke: Stroke) -> f32 {
    let beyond_px = max(max(-stroke.place_px.x, stroke.place_px.x - stroke.length_px), 0.0);
    let distance_px = length(vec2f(beyond_px, stroke.place_px.y));
    return clamp(overlay.half_width_px + 0.5 - distance_px, 0.0, 1.0);
}

@fragment
fn fs_line(stroke: Stroke) -> @location(0) vec4f {
    return stroke.color * coverage(stroke);
}

@fragment
fn fs_hidden_line(stroke: Stroke) -> @location(0) vec4f {
    return stroke.color * (coverage(stroke) * overlay.hidden_opacity);
}
