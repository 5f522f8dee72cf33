// What is on the wrong side of a smooth silhouette, and goes over: the pieces of `core/src/smooth/facing.rs`, which says why. Needs find_smooth.wgsl.
//
// The triangles cut along the silhouette, whose pieces are either lit or dark, are a closed surface. A lit piece that shows the light its back is taken out of
// the light cap, and a dark one that shows its front is added: as one more face that faces the light in either case, with its border as sides. Those that
// the silhouette has there already, the other way round, are left out with them.
//
// The surface is made of points of the silhouette, of ends of creases, and of the inner places of other vertices. Each piece is decided once, so that rounding
// tears nothing; what is seen nearly edge on, for which it matters, covers nothing.

// `core/src/smooth/facing.rs`.
const SADDLE: f32 = 4.0;

// Of wedge `w`, among normals.
fn inner_place(w: u32) -> u32 {
    return job.normals + job.wedge_count + w;
}

// Where vertices are moved to. But for ends of creases, each edge at a vertex is walked away from it by one of the triangles there.
@compute @workgroup_size(64)
fn find_inner_places(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let w = thread(id, groups);
    if w >= job.wedge_count {
        return;
    }
    let stays = normals[inner_place(w)].w;
    let normal = normal_of_wedge(w);
    var most_m = 0.0;
    if stays == 0.0 {
        let end = tables[job.corner_starts + w + 1u];
        for (var i = tables[job.corner_starts + w]; i < end; i++) {
            let bulge = curve_bulge(curve_of_edge(tables[job.triangle_edges + tables[i]]), 0.5);
            most_m = max(most_m, -dot(bulge, normal));
        }
    }
    normals[inner_place(w)] = vec4f(place_of_wedge(w) - normal * (SADDLE * most_m), stays);
}

// What the surface has for the vertex of wedge `w`: by the vertex's own name where it is there, as others name it so.
fn name_of_wedge(w: u32) -> u32 {
    let name = job.inner_places + w;
    return select(name, VERTEX | tables[job.vertices + w], all(points[name].xyz == place_of_wedge(w)));
}

// Strictly: what is seen edge on shows neither its front nor its back.
fn faces_light(a: u32, b: u32, c: u32) -> bool {
    let at_a = place_of(a);
    return dot(cross(place_of(b) - at_a, place_of(c) - at_a), to_light(at_a)) > 0.0;
}

// The sides of a triangle, and its pieces that go over. Between the points of a curve are a lit piece, to the corner `k`, and a dark one, to the next; and there is
// one from the curve's end to the third corner, lit or dark as that is. A triangle that is not crossed (`k` is 3) is only the last.
//
// All pieces in one loop, as drivers copy what is called to wherever it is called from.
fn add_pieces(corners: vec3u, k: u32, turned: u32, leave: u32, entry: u32, cut: Cut) {
    if (job.flags & CURVED) == 0u {
        add_side(leave, entry);
        return;
    }
    var hubs = vec2u(name_of_wedge(corners[k % 3u]), name_of_wedge(corners[(k + 1u) % 3u]));
    let third = name_of_wedge(corners[(k + 2u) % 3u]);
    let is_last_lit = ((turned >> ((k + 2u) % 3u)) & 1u) != 0u;
    var here = leave;
    if cut.pieces == 0u {
        // Walked so that the last one is the whole.
        here = hubs[u32(is_last_lit)];
        hubs = vec2u(hubs[u32(!is_last_lit)]);
    }
    // Of lit pieces and dark ones, whether the one before goes over.
    var went_over = vec2<bool>(false);
    for (var i = 0u; i <= cut.pieces; i++) {
        let is_last = i == cut.pieces;
        var next = third;
        if i + 1u < cut.pieces {
            next = cut.first + i;
        } else if !is_last {
            next = entry;
        }
        for (var h = 0u; h < 2u; h++) {
            let hub = hubs[h];
            let goes_over = (!is_last || is_last_lit == (h == 0u)) && faces_light(hub, next, here);
            if goes_over {
                add_face(hub, next, here);
            }
            // Between pieces that share an edge there is a side if one of them goes over and the other does not.
            if goes_over != went_over[h] {
                add_side(select(hub, here, goes_over), select(here, hub, goes_over));
            }
            if goes_over && is_last {
                add_side(hub, next);
                add_side(next, here);
            }
            went_over[h] = goes_over;
        }
        if !is_last && went_over.x == went_over.y {
            add_side(select(here, next, went_over.x), select(next, here, went_over.x));
        }
        here = next;
    }
}
