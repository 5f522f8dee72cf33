//! Edges at which a model is not a closed, consistently wound surface.

use umbrae_core::Topology;
use umbrae_render::{Overlay, OverlayColor, OverlayVertex};

use super::Subject;
use super::canvas::Rgb;
use super::legend::{Legend, Swatch};
use super::numbers::{counted, grouped};

/// In what way an edge is odd.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Oddity {
    /// One triangle.
    Border,
    /// More than two triangles.
    NonManifold,
    /// Two triangles that walk it in the same direction.
    Inconsistent,
}

impl Oddity {
    const ALL: [Self; 3] = [Self::Border, Self::NonManifold, Self::Inconsistent];

    /// That of edge `e`; `None` where two triangles meet as they should.
    fn of(topology: &Topology, e: usize) -> Option<Self> {
        let mut directions = topology.triangles_on_edge(e).map(|(_, direction)| direction);
        match directions.len() {
            1 => Some(Self::Border),
            2 => (directions.next() == directions.next()).then_some(Self::Inconsistent),
            _ => Some(Self::NonManifold),
        }
    }

    fn color(self) -> Rgb {
        match self {
            Self::Border => [225, 90, 10],
            Self::NonManifold => [200, 30, 190],
            Self::Inconsistent => [20, 110, 225],
        }
    }

    fn meaning(self, count: usize) -> String {
        let count = grouped(count as u64);
        match self {
            Self::Border => format!("border, 1 triangle: {count}"),
            Self::NonManifold => format!("non-manifold, 3 or more: {count}"),
            Self::Inconsistent => format!("inconsistently wound: {count}"),
        }
    }
}

/// The odd edges of all models over the lit picture.
pub(super) fn topology(subject: &Subject<'_>) -> (Overlay, Legend) {
    let mut overlay = Overlay { hidden_opacity: 0.4, ..Overlay::default() };
    let mut counts = [0; 3];
    let (mut edges, mut closed, mut other) = (0, 0, 0);
    for (_, caster) in subject.models() {
        let topology = &caster.topology;
        edges += topology.edges().len();
        closed += topology.components().iter().filter(|component| component.is_closed).count();
        other += topology.components().iter().filter(|component| !component.is_closed).count();
        for (e, edge) in topology.edges().iter().enumerate() {
            let Some(oddity) = Oddity::of(topology, e) else { continue };
            counts[oddity as usize] += 1;
            let color = OverlayColor::new(oddity.color(), 1.0);
            let ends = [edge.low, edge.high].map(|v| OverlayVertex::at(caster.positions[v as usize], color));
            overlay.lines.push(ends);
        }
    }
    let mut legend = Legend::new(format!("Topology: odd ones of {}", counted(edges, "edge")));
    for oddity in Oddity::ALL {
        legend = legend.entry(Swatch::Line(oddity.color()), oddity.meaning(counts[oddity as usize]));
    }
    let parts = format!("{}, {} not", counted(closed, "closed part"), grouped(other as u64));
    (overlay, legend.text("Faint where hidden").text(format!("{parts}; shadows are exact for both kinds")))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use umbrae_core::{Mesh, Surface};

    use super::*;

    #[test]
    fn odd_edges_are_as_many_as_the_topology_counts() {
        // A tetrahedron with a fin on one edge, one face turned round, and a triangle of its own.
        let triangles = vec![[0, 2, 1], [0, 1, 3], [2, 1, 3], [2, 0, 3], [0, 1, 4], [5, 6, 7]];
        let positions = (0..8).map(|i| Vec3::new(i as f32, (i * i) as f32, (i * i * i) as f32)).collect();
        let mesh = Mesh::new(Surface { positions, triangles, ..Surface::default() }).expect("a good mesh");
        let topology = Topology::new(&mesh);
        let mut found = [0; 3];
        for e in 0..topology.edges().len() {
            if let Some(oddity) = Oddity::of(&topology, e) {
                found[oddity as usize] += 1;
            }
        }
        let counts = topology.counts();
        assert_eq!(found, [counts.border_edges, counts.non_manifold_edges, counts.inconsistent_edges]);
        assert!(found.iter().all(|&count| count > 0), "{found:?}");
    }
}
