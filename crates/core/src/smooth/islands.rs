//! Small islands of light among the dark, or of dark among the lit, that are turned the wrong way.
//!
//! What is lit by its normals should show the light its front. On a very coarse mesh a few vertices beside a crease may not: their triangles turn away though
//! their normals do not yet. An island of these is seen from behind, so it counts -1, and where something else counts 1 light would leak through. Likewise a
//! dark island whose triangles all face the light is a hole in the light cap. Such an island is given to what is around it: which wedges are turned to the light is anyone's
//! choice, the volume is closed all the same.
//!
//! Not in the papers.

use crate::LightPosition;

use super::body::SmoothBody;

/// Larger islands are the surface itself.
const MOST_WEDGES: usize = 48;

/// What is kept for the next light.
#[derive(Debug, Default, Clone)]
pub(super) struct Islands {
    is_seen: Vec<bool>,
    seen: Vec<u32>,
    island: Vec<u32>,
}

impl Islands {
    /// Turns islands over in `turned`, and takes their edges from `found`.
    pub(super) fn settle(
        &mut self,
        body: &SmoothBody,
        light: LightPosition,
        turned: &mut [i8],
        found: &mut Vec<[u32; 2]>,
    ) {
        self.is_seen.resize(body.vertex_of_wedge.len(), false);
        let mut is_changed = false;
        for end in [0, 1] {
            for &edge in found.iter() {
                if !self.is_seen[edge[end] as usize] && self.find(body, turned, edge[end]) {
                    let is_lit = end == 0;
                    let area = self.area(body, light, turned);
                    if if is_lit { area <= 0.0 } else { area >= 0.0 } {
                        self.island.iter().for_each(|&w| turned[w as usize] = i8::from(!is_lit));
                        is_changed = true;
                    }
                }
            }
            self.seen.drain(..).for_each(|w| self.is_seen[w as usize] = false);
        }
        if is_changed {
            found.retain(|&[lit, dark]| turned[lit as usize] > 0 && turned[dark as usize] <= 0);
        }
    }

    /// Whether the wedges that are turned as `start` is and hang together with it are few; they are the island then.
    fn find(&mut self, body: &SmoothBody, turned: &[i8], start: u32) -> bool {
        self.island.clear();
        self.see(start);
        let mut next = 0;
        while next < self.island.len() {
            for &t in body.triangles_at(self.island[next]) {
                for w in body.wedges.mesh.triangles()[t as usize] {
                    if turned[w as usize] != turned[start as usize] {
                        continue;
                    }
                    if !self.is_seen[w as usize] {
                        self.see(w);
                    } else if !self.island.contains(&w) {
                        // It hangs together with something that was too large.
                        return false;
                    }
                }
            }
            next += 1;
            if self.island.len() > MOST_WEDGES {
                return false;
            }
        }
        true
    }

    fn see(&mut self, w: u32) {
        self.is_seen[w as usize] = true;
        self.seen.push(w);
        self.island.push(w);
    }

    /// The area of the island as the light sees it, times its distance if it has one; parts that show the light their backs count less than 0.
    fn area(&self, body: &SmoothBody, light: LightPosition, turned: &[i8]) -> f64 {
        let mut area = 0.0;
        for &w in &self.island {
            for &t in body.triangles_at(w) {
                let corners = body.wedges.mesh.triangles()[t as usize];
                // Each triangle with the first of its corners on the island.
                if corners.iter().find(|corner| self.island.contains(corner)) != Some(&w) {
                    continue;
                }
                let is_on = |c: u32| turned[c as usize] == turned[w as usize];
                let [a, b, c] = corners.map(|c| body.place(c));
                let facing = (b - a).cross(c - a).dot(light.offset_from((a + b + c) / 3.0));
                area += facing * share(corners.map(is_on), corners.map(|c| body.height(c, light).abs()));
            }
        }
        area
    }
}

/// The part of a triangle that belongs to those corners which are `on`, where heights of these sizes and opposite signs meet at 0.
fn share(on: [bool; 3], heights: [f64; 3]) -> f64 {
    let corner = |i: usize| {
        let part = |k: usize| heights[i] / (heights[i] + heights[(i + k) % 3]).max(f64::MIN_POSITIVE);
        part(1) * part(2)
    };
    match on.iter().filter(|&&on| on).count() {
        3 => 1.0,
        1 => on.iter().position(|&on| on).map_or(0.0, corner),
        2 => 1.0 - on.iter().position(|&on| !on).map_or(0.0, corner),
        _ => 0.0,
    }
}
