// Finds the silhouettes of all lights of a frame: `find_triangles`, then `find_edges`, then `find_arguments`. Needs job.wgsl, flat_normal.wgsl and near.wgsl.
//
// Each triangle is turned to each light by one expression, once; what comes out is stored as two bits, 0 for 0, 1 for +1 and 2 for -1, of 16
// lights to a word. Sides and caps are made of these bits alone, so that volumes are closed whatever the rounding.
//
// A workgroup goes through one block: triangles or edges of one caster. It counts what it adds to a list of each light before it takes
// room for all of it at once.

// How many lights have their bits in a word.
const LIGHTS: u32 = 16u;
const NONE: u32 = 0xFFFFFFFFu;

struct JobSlot {
    job: Job,
    // To the offset that uniform buffers may be bound at.
    unused: array<vec4u, 12>,
}

// What became of a job, and the arguments of its draws, in the order of `Count`: 4 words each.
struct Result {
    sides: atomic<u32>,
    caps: atomic<u32>,
    // Whether some triangle may shade the near rectangle.
    is_near: atomic<u32>,
    unused: u32,
    arguments: array<vec4u, 5>,
}

@group(0) @binding(0) var<uniform> finding: Finding;
@group(0) @binding(1) var<storage, read> tables: array<u32>;
// Near vertices have a 0 in the fourth place, far ones a 1; see volume.wgsl.
@group(0) @binding(2) var<storage, read> positions: array<vec4f>;
@group(0) @binding(3) var<storage, read> lights: array<FoundLight>;
@group(0) @binding(4) var<storage, read> jobs: array<JobSlot>;
// The job of each caster and light, or NONE; all lights of a caster together.
@group(0) @binding(5) var<storage, read> rows: array<u32>;
// `words` for each triangle.
@group(0) @binding(6) var<storage, read_write> coefficients: array<u32>;
@group(0) @binding(7) var<storage, read_write> lists: array<u32>;
@group(0) @binding(8) var<storage, read_write> results: array<Result>;

var<workgroup> found: array<atomic<u32>, LIGHTS>;

struct CasterTable {
    triangles: u32,
    triangle_count: u32,
    component_of_triangle: u32,
    components: u32,
    edges: u32,
    edge_count: u32,
    firsts: u32,
    coefficients: u32,
}

fn caster_table(caster: u32) -> CasterTable {
    let at = 8u * caster;
    return CasterTable(
        tables[at], tables[at + 1u], tables[at + 2u], tables[at + 3u],
        tables[at + 4u], tables[at + 5u], tables[at + 6u], tables[at + 7u],
    );
}

// Of two dimensions, as one can't have enough groups.
fn block_number(group: vec3u, groups: vec3u) -> u32 {
    return group.y * groups.x + group.x;
}

// The two bits of a triangle. Where only facing triangles count, nothing is edge-on.
fn coefficient_bits(triangle: Triangle, position: vec4f, edge_on: f32, counts_facing: bool) -> u32 {
    let height = dot(triangle.normal, offset_from(position, triangle.corners[0]));
    if counts_facing {
        return select(0u, 1u, height > 0.0);
    }
    if abs(height) <= edge_on * triangle.normal_length {
        return 0u;
    }
    return select(2u, 1u, height > 0.0);
}

fn coefficient(word: u32, light: u32) -> i32 {
    let bits = word >> (2u * light);
    return i32(bits & 1u) - i32((bits >> 1u) & 1u);
}

// Whether neither the light nor the near rectangle comes near the box, so that a closed component in it may count what faces the light.
fn is_clear(position: vec4f, low: vec3f, high: vec3f, slack: f32) -> bool {
    let a = low - slack;
    let b = high + slack;
    let holds_light = position.w != 0.0 && all(position.xyz >= a) && all(position.xyz <= b);
    let meets_near = all(finding.near_max.xyz >= a) && all(finding.near_min.xyz <= b);
    return !(holds_light || meets_near);
}

fn take_room(i: u32, of_word: u32, row: u32, is_cap: bool) {
    let light = of_word * LIGHTS + i;
    let count = atomicLoad(&found[i]);
    if count == 0u {
        return;
    }
    let job = rows[row + light];
    if is_cap {
        atomicStore(&found[i], jobs[job].job.caps + atomicAdd(&results[job].caps, count));
    } else {
        atomicStore(&found[i], jobs[job].job.sides + atomicAdd(&results[job].sides, count));
    }
}

@compute @workgroup_size(64)
fn find_triangles(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) i: u32,
) {
    let block = block_number(group, groups);
    if block >= finding.triangle_block_count {
        return;
    }
    let at = finding.triangle_blocks + 2u * block;
    let caster = tables[at];
    let row = caster * finding.light_count;
    let table = caster_table(caster);
    let t = tables[at + 1u] + i;
    let is_one = t < table.triangle_count;

    var triangle: Triangle;
    var low: vec3f;
    var high: vec3f;
    var is_closed = false;
    var has_corners = false;
    for (var word = 0u; word < finding.words; word++) {
        if i < LIGHTS {
            atomicStore(&found[i], 0u);
        }
        workgroupBarrier();
        let lights_here = min(finding.light_count - word * LIGHTS, LIGHTS);
        var bits = 0u;
        var caps = 0u;
        for (var k = 0u; k < lights_here; k++) {
            let light = word * LIGHTS + k;
            let number = rows[row + light];
            if number == NONE || !is_one {
                continue;
            }
            let job = jobs[number].job;
            if !has_corners {
                has_corners = true;
                let corners = table.triangles + 3u * t;
                triangle = triangle_of(
                    positions[job.near + tables[corners]].xyz,
                    positions[job.near + tables[corners + 1u]].xyz,
                    positions[job.near + tables[corners + 2u]].xyz,
                );
                let component = table.components + 8u * tables[table.component_of_triangle + t];
                is_closed = tables[component + 3u] != 0u;
                low = bitcast<vec3f>(vec3u(tables[component], tables[component + 1u], tables[component + 2u]));
                high = bitcast<vec3f>(vec3u(tables[component + 4u], tables[component + 5u], tables[component + 6u]));
                if (job.flags & MOVED) != 0u {
                    low = job.box_min;
                    high = job.box_max;
                }
            }
            let position = lights[light].position_world;
            let counts_facing =
                is_closed && (job.flags & SEE_THROUGH) == 0u && is_clear(position, low, high, job.slack);
            let own = coefficient_bits(triangle, position, job.edge_on, counts_facing);
            bits |= own << (2u * k);
            if own != 0u && (job.flags & NEEDS_CAPS) != 0u {
                caps |= own << (2u * k);
                atomicAdd(&found[k], 1u);
            }
            if (job.flags & UNDECIDED) != 0u && !is_apart(triangle, light, job.slack) {
                atomicStore(&results[number].is_near, 1u);
            }
        }
        if is_one {
            coefficients[(table.coefficients + t) * finding.words + word] = bits;
        }
        workgroupBarrier();
        if i < lights_here {
            take_room(i, word, row, true);
        }
        workgroupBarrier();
        while caps != 0u {
            let k = firstTrailingBit(caps) / 2u;
            lists[atomicAdd(&found[k], 1u)] = 2u * t + select(0u, 1u, coefficient(caps, k) < 0);
            caps &= ~(3u << (2u * k));
        }
        workgroupBarrier();
    }
}

// The sum over the edge's triangles of direction and coefficient, for one light of a word.
fn multiplicity(first: u32, end: u32, start: u32, word: u32, light: u32) -> i32 {
    var sum = 0;
    for (var i = first; i < end; i++) {
        let incidence = tables[i];
        let c = coefficient(coefficients[(start + (incidence >> 1u)) * finding.words + word], light);
        sum += select(c, -c, (incidence & 1u) != 0u);
    }
    return sum;
}

@compute @workgroup_size(64)
fn find_edges(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) i: u32,
) {
    let block = block_number(group, groups);
    if block >= finding.edge_block_count {
        return;
    }
    let at = finding.edge_blocks + 2u * block;
    let caster = tables[at];
    let row = caster * finding.light_count;
    let table = caster_table(caster);
    let e = tables[at + 1u] + i;
    var first = 0u;
    var end = 0u;
    if e < table.edge_count {
        first = tables[table.firsts + e];
        end = tables[table.firsts + e + 1u];
    }
    for (var word = 0u; word < finding.words; word++) {
        if i < LIGHTS {
            atomicStore(&found[i], 0u);
        }
        workgroupBarrier();
        // Lights for which the sum may not be 0: where two triangles walk the edge in opposite directions, those for which they differ.
        var candidates = 0u;
        if end == first + 2u && ((tables[first] ^ tables[first + 1u]) & 1u) != 0u {
            candidates = coefficients[(table.coefficients + (tables[first] >> 1u)) * finding.words + word]
                ^ coefficients[(table.coefficients + (tables[first + 1u] >> 1u)) * finding.words + word];
        } else {
            for (var incidence = first; incidence < end; incidence++) {
                candidates |= coefficients[(table.coefficients + (tables[incidence] >> 1u)) * finding.words + word];
            }
        }
        var rest = candidates;
        while rest != 0u {
            let k = firstTrailingBit(rest) / 2u;
            let m = multiplicity(first, end, table.coefficients, word, k);
            if m == 0 {
                candidates &= ~(3u << (2u * k));
            } else {
                atomicAdd(&found[k], u32(abs(m)));
            }
            rest &= ~(3u << (2u * k));
        }
        workgroupBarrier();
        if i < LIGHTS {
            take_room(i, word, row, false);
        }
        workgroupBarrier();
        while candidates != 0u {
            let k = firstTrailingBit(candidates) / 2u;
            let m = multiplicity(first, end, table.coefficients, word, k);
            let times = u32(abs(m));
            let start = atomicAdd(&found[k], times);
            for (var n = 0u; n < times; n++) {
                lists[start + n] = 2u * e + select(0u, 1u, m < 0);
            }
            candidates &= ~(3u << (2u * k));
        }
        workgroupBarrier();
    }
}

// What is drawn of one job, now that it is known whether it is counted by z-pass or by z-fail.
@compute @workgroup_size(64)
fn find_arguments(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) i: u32,
) {
    let number = 64u * block_number(group, groups) + i;
    if number >= finding.job_count {
        return;
    }
    let job = jobs[number].job;
    let sides = atomicLoad(&results[number].sides);
    let caps = atomicLoad(&results[number].caps);
    let is_near = atomicLoad(&results[number].is_near) != 0u;
    let is_fail = (job.flags & FAILS) != 0u || ((job.flags & UNDECIDED) != 0u && is_near);
    let of_sides = sides * select(6u, 3u, (job.flags & DIRECTIONAL) != 0u);
    let dark = select(9u * caps, 3u * sides, (job.flags & FAN) != 0u);
    results[number].arguments[0] = vec4u(select(of_sides, 0u, is_fail), 1u, 0u, 0u);
    results[number].arguments[1] = vec4u(select(0u, of_sides, is_fail), 1u, 0u, 0u);
    results[number].arguments[2] = vec4u(select(0u, dark, is_fail), 1u, 0u, 0u);
    results[number].arguments[3] = vec4u(select(3u * caps, 0u, is_fail), 1u, 0u, 0u);
    results[number].arguments[4] = vec4u(select(0u, 3u * caps, is_fail), 1u, 0u, 0u);
}
