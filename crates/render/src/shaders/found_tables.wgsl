// Tables in textures: what a shader without storage buffers can read at will. Entry `i` is a texel of four u32.

// `TABLE_WIDTH` in tables.rs, as a power of 2: no device has textures narrower.
const TABLE_WIDTH_LOG2: u32 = 11u;

fn place_of(entry: u32) -> vec2i {
    return vec2i(i32(entry & ((1u << TABLE_WIDTH_LOG2) - 1u)), i32(entry >> TABLE_WIDTH_LOG2));
}

fn entry_at(fragment: vec4f) -> u32 {
    let place = vec2u(fragment.xy);
    return (place.y << TABLE_WIDTH_LOG2) + place.x;
}

fn position_in(texel: vec4u) -> vec3f {
    return bitcast<vec3f>(texel.xyz);
}

// How often a triangle casts from light `i` of 64: of two bits, the lower is set for +1, the higher for -1.
fn coefficient_in(texel: vec4u, i: u32) -> i32 {
    let bits = texel[i >> 4u] >> (2u * (i & 15u));
    return i32(bits & 1u) - i32((bits >> 1u) & 1u);
}
