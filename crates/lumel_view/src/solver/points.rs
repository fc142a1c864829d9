//! What a solve publishes of light at scattered points.

use super::published::{Published, Shared, lock};
use crate::point_light::{Direct, PointIllumination, PointValues};
use glam::Vec3;
use lumel::{Baker, LightReader, Snapshot, SolveState};
use lumel_basis::{Basis as _, Field, Hierarchy, MeshlessBasis, NodeId, NodeWeights, PointCloud};
use std::sync::Arc;

/// The points that carry the light of a solve, if points do.
pub(super) struct Points(Option<Arc<PointCloud>>);

impl Points {
    /// Those of a baker; where they are the ones that are shown already, they need not be sorted again.
    pub(super) fn of(baker: &Baker, shared: &Shared) -> Self {
        let mut known = lock(&shared.cloud);
        *known = baker.basis().points().map(|basis| {
            let same = known.take().filter(|cloud| is_of(cloud, basis));
            same.unwrap_or_else(|| Arc::new(PointCloud::of(basis)))
        });
        Self(known.clone())
    }

    /// A field of the solve as the points have it.
    pub(super) fn values(&self, field: &Field) -> Option<PointValues> {
        self.0.as_ref().map(|_| Arc::new(field.values().to_vec()))
    }

    /// Changes what is published of light at the points.
    pub(super) fn publish(&self, published: &mut Published, change: impl FnOnce(&mut PointIllumination)) {
        let Some(cloud) = &self.0 else { return };
        let points = &mut published.light.points;
        change(points.get_or_insert_with(|| PointIllumination::new(Arc::clone(cloud))));
    }

    /// All light of a state that is done or was stopped, or of a round.
    pub(super) fn publish_all(
        &self,
        published: &mut Published,
        (reader, state): (&LightReader<'_>, &SolveState),
        tail: Option<&Field>,
    ) {
        let direct = reader.direct_at_vertices().map_or(Direct::AtPoints, |_| Direct::AtVertices);
        let tail = tail.and_then(|tail| self.values(tail));
        self.publish(published, |points| {
            points.bounces = state.bounces.iter().filter_map(|field| self.values(field)).collect();
            (points.current, points.tail) = (None, tail);
            points.valid = Arc::new(state.valid.clone());
            points.direct = direct;
        });
    }
}

/// Whether a cloud has the points of a basis.
fn is_of(cloud: &PointCloud, basis: &MeshlessBasis) -> bool {
    let places = cloud.points().iter().map(|point| (point.position, point.normal));
    cloud.level_count() == basis.level_count()
        && places.eq(basis.points().iter().map(|point| (point.position, point.normal)))
}

/// A bounce under way with a guess where nothing is measured yet, from what was measured nearby.
pub(super) fn extrapolated(baker: &Baker, snapshot: &Snapshot) -> Field {
    let adjacency = baker.basis().adjacency();
    // Differences to what is dark yet would be guesses of nothing.
    let hierarchy = baker.basis().points().filter(|basis| basis.level_count() > 1);
    let mut field = match hierarchy {
        Some(basis) => values_at_nodes(basis, &snapshot.current),
        None => (*snapshot.current).clone(),
    };
    adjacency.extrapolate(&mut field, &snapshot.measured);
    if let Some(basis) = hierarchy {
        basis.analyze(&mut field, None);
    }
    field
}

/// The light at each point: its coefficient and what the coarser levels say there.
fn values_at_nodes(basis: &MeshlessBasis, coefficients: &Field) -> Field {
    let (mut values, mut weights) = (coefficients.values().to_vec(), NodeWeights::default());
    for level in 1..basis.level_count() {
        for node in basis.nodes_of_level(level) {
            weights.clear();
            basis.weights_up_to(level - 1, basis.points()[node as usize].at, &mut weights);
            let part = |(other, weight): (NodeId, f32)| coefficients.values()[other.index()] * weight;
            values[node as usize] += weights.iter().map(part).sum::<Vec3>();
        }
    }
    Field::from_values(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_testkit::mesh::{Facing, cuboid};
    use lumel_testkit::scene::{grey, scene};

    #[test]
    fn values_become_coefficients_and_values_again() {
        let room = cuboid(Vec3::ZERO, Vec3::ONE, 3, Facing::Inward, [0; 6]);
        let room = Arc::new(scene(room, vec![grey(0.5, 0.0)], vec![]).build().unwrap().0);
        let basis = MeshlessBasis::with_levels(room, 0.1, 3);
        let wave = |p: Vec3| Vec3::splat(1.0 + (7.0 * p.x).sin() * p.y);
        let values: Vec<Vec3> = basis.points().iter().map(|point| wave(point.position)).collect();
        let mut field = Field::from_values(values.clone());
        basis.analyze(&mut field, None);
        assert!((field.values()[values.len() - 1] - values[values.len() - 1]).length() > 0.1);
        let again = values_at_nodes(&basis, &field);
        assert!(again.values().iter().zip(&values).all(|(a, b)| (*a - *b).length() < 1e-5));
    }
}
