// Positions moved by a function of the user's, and surfaces that follow, one fragment for each vertex and each four words of surfaces. Needs
// found_tables.wgsl, flat_normal.wgsl, and the function `moved`; see displacement.rs.

struct Displacing {
    time_s: f32,
    // How far `moved` may take a vertex, in metres.
    max_offset: f32,
    // Of surfaces.
    triangle_count: u32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> displacing: Displacing;
// The fourth word is one more than the vertex's number where it is moved, else 0.
@group(0) @binding(1) var at_rest: texture_2d<u32>;
@group(0) @binding(2) var shown: texture_2d<u32>;
// Of each triangle of surfaces: where its corners are in `shown`, and whether they are moved.
@group(0) @binding(3) var triangles: texture_2d<u32>;
// The words of surfaces in rows of `SURFACE_WIDTH` texels.
@group(0) @binding(4) var surfaces_at_rest: texture_2d<u32>;

// Position, normal, colour and texture coordinates.
const SURFACE_WORDS: u32 = 9u;
// In a vertex's colour; see gpu_scene.rs.
const FLAT: u32 = 0xFF000000u;
// In texels; see texture_displacer.rs.
const SURFACE_WIDTH: u32 = 2016u;

@vertex
fn vs_table(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_positions(@builtin(position) fragment: vec4f) -> @location(0) vec4u {
    let texel = textureLoad(at_rest, vec2i(fragment.xy), 0);
    if texel.w == 0u {
        return texel;
    }
    let p = position_in(texel);
    var to = moved(p, texel.w - 1u, displacing.time_s);
    let size = length(to - p);
    if size > displacing.max_offset {
        to = p + (to - p) * (displacing.max_offset / size);
    }
    let bits = bitcast<vec3u>(to);
    // Adding +0 would turn -0 into +0 too, but a compiler may drop that.
    return vec4u(select(bits, vec3u(0u), bits == vec3u(0x80000000u)), 0u);
}

fn corner(i: u32) -> vec3f {
    return position_in(textureLoad(shown, place_of(i), 0));
}

@fragment
fn fs_surfaces(@builtin(position) fragment: vec4f) -> @location(0) vec4u {
    let place = vec2u(fragment.xy);
    var words = textureLoad(surfaces_at_rest, vec2i(place), 0);
    let first = 4u * (place.y * SURFACE_WIDTH + place.x);
    for (var i = 0u; i < 4u; i++) {
        let vertex = (first + i) / SURFACE_WORDS;
        let word = (first + i) % SURFACE_WORDS;
        if word > 6u || vertex / 3u >= displacing.triangle_count {
            continue;
        }
        let triangle = textureLoad(triangles, place_of(vertex / 3u), 0);
        if triangle.w == 0u {
            continue;
        }
        if word < 3u {
            words[i] = textureLoad(shown, place_of(triangle[vertex % 3u]), 0)[word];
        } else if word == 6u {
            // Normals to shade with were those of its rest: what moves here is flat.
            words[i] |= FLAT;
        } else {
            let normal = flat_normal(corner(triangle.x), corner(triangle.y), corner(triangle.z));
            words[i] = bitcast<u32>(normal[word - 3u]);
        }
    }
    return words;
}
