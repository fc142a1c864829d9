//! Where light that is stored at vertices bends.

use super::criterion::{Criterion, Probe, SHORTEST};
use super::refiner::edges;
use lumel_scene::Bisection;
use std::collections::{BTreeSet, HashMap};

/// The edges across which light at vertices bends by more than it may, each by its vertices: those between a triangle's corner
/// and the edge that it shares with the triangle on the other side of the bend.
///
/// From one triangle to the next, the slope of light changes by its second derivative times the distance of their middles. It
/// says little about noise.
pub(super) fn doubtful(mesh: &Bisection, light: &[f64], criterion: &Criterion) -> Vec<[u32; 2]> {
    let mut first: HashMap<[u32; 2], u32> = HashMap::new();
    let mut found = BTreeSet::new();
    for part in mesh.parts() {
        for (k, ends) in edges(part).into_iter().enumerate() {
            let corner = part.vertices[(k + 2) % 3];
            let Some(other) = first.insert(ends, corner) else { continue };
            let [here, there] = [corner, other].map(|corner| Wing::new(mesh, light, ends, corner));
            let second_derivative = 2.0 * (here.slope + there.slope) / (here.height + there.height);
            for (wing, corner) in [(here, corner), (there, other)] {
                let difference = (0.125 * second_derivative * wing.height * wing.height).abs();
                let probe = |light: f64| Probe { light, ..Probe::NONE };
                let between = light[corner as usize];
                for end in ends {
                    let edge = [end.min(corner), end.max(corner)];
                    let length = mesh.relative_length(edge);
                    let excess = criterion.excess(&probe(between + difference), [&probe(between); 2], length);
                    if excess > 1.0 && length > SHORTEST {
                        found.insert(edge);
                    }
                }
            }
        }
    }
    found.into_iter().collect()
}

/// A triangle beside an edge.
struct Wing {
    /// Of light, away from the edge.
    slope: f64,
    /// Of the corner above the edge, metres.
    height: f64,
}

impl Wing {
    fn new(mesh: &Bisection, light: &[f64], [a, b]: [u32; 2], corner: u32) -> Self {
        let position = |vertex: u32| mesh.position(vertex).as_dvec3();
        let (along, up) = (position(b) - position(a), position(corner) - position(a));
        let share = up.dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        let height = (up - share * along).length().max(f64::MIN_POSITIVE);
        let [la, lb, lc] = [a, b, corner].map(|vertex| light[vertex as usize]);
        Self { slope: (lc - (la + share * (lb - la))) / height, height }
    }
}
