// Chains and their boundaries for many lights at once, one fragment for each triangle or edge. Needs found_tables.wgsl and flat_normal.wgsl.

struct FoundLights {
    // McGuire's homogeneous positions.
    positions_world: array<vec4f, 64>,
    count: u32,
    triangle_count: u32,
    edge_count: u32,
    // Of a multiplicity: as many as the edge with the most triangles needs.
    lane_bits: u32,
}

// The lights whose multiplicities go into one target.
struct FoundLanes {
    first_light: u32,
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
}

@group(0) @binding(0) var<uniform> found: FoundLights;
@group(0) @binding(1) var<uniform> lanes: FoundLanes;
// Three corners, and the component.
@group(0) @binding(2) var triangles: texture_2d<u32>;
// Bits of the lights from which every triangle counts (two words), and the largest coordinate of the caster's box.
@group(0) @binding(3) var components: texture_2d<u32>;
@group(0) @binding(4) var positions: texture_2d<u32>;
// The lower corner, the higher, where its incidences begin, and the middle of the caster's box.
@group(0) @binding(5) var edges: texture_2d<u32>;
// Four words a texel: how many triangles are on the edge; then each, with in the lowest bit whether it walks the edge from the higher corner
// to the lower.
@group(0) @binding(6) var incidences: texture_2d<u32>;
@group(0) @binding(7) var coefficients: texture_2d<u32>;

// `EDGE_ON` of chain.rs in umbrae-core.
const EDGE_ON: f32 = 4e-7;

@vertex
fn vs_table(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn corner(i: u32) -> vec3f {
    return position_in(textureLoad(positions, place_of(i), 0));
}

// The only place where a triangle is tested against a light: sides and caps read what is written here, so that they agree whatever the
// rounding. The rule is that of `Counting::coefficient` in chain.rs.
@fragment
fn fs_coefficients(@builtin(position) fragment: vec4f) -> @location(0) vec4u {
    let entry = entry_at(fragment);
    var words = vec4u(0u);
    if entry >= found.triangle_count {
        return words;
    }
    let triangle = textureLoad(triangles, place_of(entry), 0);
    let component = textureLoad(components, place_of(triangle.w), 0);
    let reach = bitcast<f32>(component.z);
    let a = corner(triangle.x);
    let cross_product = cross(corner(triangle.y) - a, corner(triangle.z) - a);
    // To a size at which its square neither overflows nor vanishes; a triangle without any area stays at 0.
    let size = largest(cross_product);
    let normal = cross_product / select(1.0, size, size > 0.0);
    let normal_length = length(normal);
    for (var i = 0u; i < found.count; i += 1u) {
        let light = found.positions_world[i];
        let height = dot(normal, light.xyz - a * light.w);
        let edge_on = EDGE_ON * select(1.0, max(reach, largest(light.xyz)), light.w > 0.5);
        let is_every = ((component[i >> 5u] >> (i & 31u)) & 1u) == 1u;
        let is_counted = !is_every || abs(height) > edge_on * normal_length;
        let is_facing = height > 0.0;
        let bits = select(select(0u, 2u, is_every), 1u, is_facing);
        words[i >> 4u] |= select(0u, bits, is_counted) << (2u * (i & 15u));
    }
    return words;
}

// The lowest bits of each word, two for each light, moved apart into lanes.
fn in_lanes(bits: vec4u) -> vec4u {
    var x = bits;
    switch found.lane_bits {
        case 4u: {
            x = (x | (x << vec4u(8u))) & vec4u(0x00FF00FFu);
            x = (x | (x << vec4u(4u))) & vec4u(0x0F0F0F0Fu);
            x = (x | (x << vec4u(2u))) & vec4u(0x33333333u);
        }
        case 8u: {
            x = (x | (x << vec4u(12u))) & vec4u(0x000F000Fu);
            x = (x | (x << vec4u(6u))) & vec4u(0x03030303u);
        }
        case 16u: {
            x = (x | (x << vec4u(14u))) & vec4u(0x00030003u);
        }
        default: {}
    }
    return x;
}

// How often the chain's boundary runs along the edge, from the lower corner to the higher: for all lanes at once, whatever the number of lights.
// Half of what a lane can hold is added, so that lanes do not borrow from each other.
@fragment
fn fs_multiplicities(@builtin(position) fragment: vec4f) -> @location(0) vec4u {
    let entry = entry_at(fragment);
    if entry >= found.edge_count {
        return vec4u(0u);
    }
    // 1 in each lane.
    let ones = vec4u(0xFFFFFFFFu / (0xFFFFFFFFu >> (32u - found.lane_bits)));
    // Two bits a light are 64 / lane_bits a word.
    let first_bits = 2u * lanes.first_light + 64u / found.lane_bits * vec4u(0u, 1u, 2u, 3u);
    let used = vec4u(0xFFFFFFFFu >> (32u - 64u / found.lane_bits));
    var words = ones << vec4u(found.lane_bits - 1u);
    let edge = textureLoad(edges, place_of(entry), 0);
    var four = textureLoad(incidences, place_of(edge.z), 0);
    let count = four.x;
    for (var i = 1u; i <= count; i += 1u) {
        if (i & 3u) == 0u {
            four = textureLoad(incidences, place_of(edge.z + (i >> 2u)), 0);
        }
        let incidence = four[i & 3u];
        let texel = textureLoad(coefficients, place_of(incidence >> 1u), 0);
        let at = first_bits >> vec4u(5u);
        let bits = vec4u(texel[at.x], texel[at.y], texel[at.z], texel[at.w]) >> (first_bits & vec4u(31u));
        let x = in_lanes(bits & used);
        let sum = (x & ones) - ((x >> vec4u(1u)) & ones);
        words = select(words + sum, words - sum, (incidence & 1u) == 1u);
    }
    return words;
}
