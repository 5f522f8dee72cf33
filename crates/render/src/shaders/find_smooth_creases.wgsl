// The part of a smooth silhouette that runs along creases, what closes it, and what is on the wrong side of it. Needs find_smooth.wgsl and find_smooth_facing.wgsl.

const NO_NAME: u32 = 0xFFFFFFFFu;

// What a run along a crease is on the side to the lower end: a lit piece on one hand and a dark one on the other, both on the wrong side or neither. `from_point` is
// where the lit side's walk comes from. If the run `is_chord`, it is an edge of a triangle there, and one of the two is none.
//
// A face closes it, to the lower end; a piece that goes over takes it away, and the second one adds it the other way round.
fn add_piece_of_run(low: u32, from_point: u32, to_point: u32, is_chord: bool) {
    let is_cone = from_point != low && to_point != low;
    let goes_over = (job.flags & CURVED) != 0u && is_cone && faces_light(low, to_point, from_point);
    let is_turned = goes_over && !is_chord;
    let first = select(from_point, to_point, is_turned);
    let last = select(to_point, from_point, is_turned);
    if is_cone && is_turned == goes_over {
        add_face(low, first, last);
    }
    if is_turned == goes_over {
        add_side(first, last);
    }
    let copies = select(0u, select(2u, 1u, is_chord), goes_over);
    for (var i = 0u; i < copies; i++) {
        add_side(low, to_point);
        add_side(from_point, low);
    }
}

// What one side of a crease adds to the cone from its lower end: the way from the upper end, or from the crossing, down to the fold and up to the silhouette;
// walked forwards where its triangle walks the crease from its lower end. And the piece between both ends and the crossing, dark where the lower end is lit, else lit.
// A straight run from the upper end may have `met` the crossing: then nothing is between them.
fn add_way(low: u32, high: u32, p: u32, is_forward: bool, is_high_lit: bool, met: vec2u) {
    let walk = vec4u(high, p + 1u, p, high);
    for (var i = select(0u, 1u, is_high_lit); i < 3u; i++) {
        let a = select(walk[i], walk[i + 1u], is_forward);
        let b = select(walk[i + 1u], walk[i], is_forward);
        let is_piece = i == 2u;
        if is_piece && ((job.flags & CURVED) == 0u || any(met == vec2u(p)) || !faces_light(low, a, b)) {
            return;
        }
        add_face(low, a, b);
        if is_piece {
            add_side(low, a);
            add_side(a, b);
            add_side(b, low);
        }
    }
}

// A part of the silhouette that runs along a crease, between two names and places; walked so by the lit side where it `is_forward`.
struct Run {
    names: vec2u,
    u: vec2f,
    is_forward: bool,
}

// Where it has none of its ends at `low`, the lower end of the crease, what it is on that side too. Returns the other end of a run that is straight from `high`.
fn add_run(low: u32, high: u32, edges: vec2u, run: Run) -> u32 {
    let names = run.names;
    let u = run.u;
    let curve = curve_of_edge(edges.x);
    var cut = Cut(0u, 1u);
    var sunk = vec3f(0.0);
    if (job.flags & CURVED) != 0u {
        cut = cut_for(curve_pieces(curve, u.y - u.x, chord_m(curve.start)));
        sunk = sunk_of(edges.x, edges.y, curve);
    }
    var met = NO_NAME;
    if cut.pieces == 1u && any(names == vec2u(high)) {
        met = select(names.x, names.y, names.x == high);
    }
    var before = names.x;
    for (var i = 1u; i <= cut.pieces; i++) {
        var here = names.y;
        if i < cut.pieces {
            here = cut.first + i - 1u;
            let v = u.x + (u.y - u.x) * f32(i) / f32(cut.pieces);
            points[here] = vec4f(curve_at(curve, v) + sunk * (4.0 * v * (1.0 - v)), 0.0);
        }
        add_piece_of_run(low, select(here, before, run.is_forward), select(before, here, run.is_forward), met != NO_NAME);
        before = here;
    }
    return met;
}

// By how much the middle of a crease is moved into the body, where its curve goes into it.
fn sunk_of(e: u32, other: u32, curve: Curve) -> vec3f {
    let a = ends_of_edge(e);
    let b = ends_of_edge(other);
    let outward = unit_or_zero(normal_of_wedge(a.x) + normal_of_wedge(a.y) + normal_of_wedge(b.x) + normal_of_wedge(b.y));
    let size = length(curve.chord);
    let bulge_m = dot(curve_at(curve, 0.5) - curve.start - 0.5 * curve.chord, outward);
    if bulge_m < -LEAST_DENT * size {
        return -outward * min(INSET * size, job.most_inset_m);
    }
    return vec3f(0.0);
}

// What is lit of one side of a crease: from where to where on it, and by what names.
struct Lit {
    u: vec2f,
    names: vec2u,
}

fn lit_of(e: u32, turned: u32, low: u32, high: u32) -> Lit {
    var lit = Lit(vec2f(0.0, 1.0), vec2u(low, high));
    if turned == 1u {
        lit.u.y = points[crossing(e)].w;
        lit.names.y = crossing(e);
    } else if turned == 2u {
        lit.u.x = points[crossing(e)].w;
        lit.names.x = crossing(e);
    }
    return lit;
}

// Which ends of edge `e` are turned to the light: 1 for the lower, 2 for the higher.
fn turned_ends(e: u32) -> u32 {
    let ends = ends_of_edge(e);
    return select(0u, 1u, is_turned(ends.x)) + select(0u, 2u, is_turned(ends.y));
}

// What is lit on one side of a crease and not on the other. `edges` are that whose triangle walks from the vertex `low` to `high`, and the other side's.
fn add_crease(low: u32, high: u32, edges: vec2u) {
    let turned = vec2u(turned_ends(edges.x), turned_ends(edges.y));
    if turned.x == turned.y && (turned.x == 0u || turned.x == 3u) {
        return;
    }
    // The first side's lit part less the second's: from where the first begins to where the second does, and from where the second ends to where the
    // first does. That is backwards where the second is the longer one, and closes in any case.
    let a = lit_of(edges.x, turned.x, low, high);
    let b = lit_of(edges.y, turned.y, low, high);
    var runs = array<Run, 2>(
        Run(vec2u(a.names.x, b.names.x), vec2f(a.u.x, b.u.x), true),
        Run(vec2u(b.names.y, a.names.y), vec2f(b.u.y, a.u.y), true),
    );
    let is_apart = max(a.u.x, b.u.x) > min(a.u.y, b.u.y);
    if is_apart || turned.x == 0u || turned.y == 0u {
        runs[0] = Run(select(a.names, vec2u(low), turned.x == 0u), a.u, true);
        runs[1] = Run(select(b.names, vec2u(low), turned.y == 0u), b.u, false);
    }
    var met = vec2u(NO_NAME);
    for (var r = 0u; r < 2u; r++) {
        if runs[r].names.x != runs[r].names.y {
            met[r] = add_run(low, high, edges, runs[r]);
        }
    }
    for (var s = 0u; s < 2u; s++) {
        if turned[s] == 1u || turned[s] == 2u {
            add_way(low, high, crossing(edges[s]), (s == 0u) == (turned[s] == 1u), turned[s] == 2u, met);
        }
    }
}

@compute @workgroup_size(64)
fn find_creases(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = thread(id, groups);
    if number < job.crease_count {
        let crease = job.creases + 4u * number;
        let edges = vec2u(tables[crease + 2u], tables[crease + 3u]);
        add_crease(VERTEX | tables[crease], VERTEX | tables[crease + 1u], edges);
    }
}
