//! Light as a vector of coefficients.

use crate::{Basis, NodeId, NodeWeights};
use glam::{DVec3, Vec3};
use lumel_scene::{Irradiance, SurfacePoint};

/// Irradiance in a basis: one coefficient per node, W·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    values: Vec<Vec3>,
}

impl Field {
    /// Darkness.
    pub fn zeros(nodes: usize) -> Self {
        Self { values: vec![Vec3::ZERO; nodes] }
    }

    /// A field of given coefficients.
    pub fn from_values(values: Vec<Vec3>) -> Self {
        Self { values }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// A coefficient.
    #[inline]
    pub fn node(&self, node: NodeId) -> Irradiance {
        Irradiance(self.values[node.index()])
    }

    /// All coefficients, W·m⁻².
    pub fn values(&self) -> &[Vec3] {
        &self.values
    }

    /// All coefficients, to change.
    pub fn values_mut(&mut self) -> &mut [Vec3] {
        &mut self.values
    }

    /// The field at a surface point; `weights` is scratch space.
    #[inline]
    pub fn at<B: Basis + ?Sized>(
        &self,
        basis: &B,
        at: SurfacePoint,
        weights: &mut NodeWeights,
    ) -> Irradiance {
        weights.clear();
        basis.weights_at(at, weights);
        weights.iter().map(|(node, weight)| self.node(node) * weight).sum()
    }

    /// The sum of several fields over the same nodes, rounded once.
    pub fn sum<'a>(nodes: usize, fields: impl IntoIterator<Item = &'a Field>) -> Self {
        let mut sums = vec![DVec3::ZERO; nodes];
        for field in fields {
            for (sum, value) in sums.iter_mut().zip(&field.values) {
                *sum += value.as_dvec3();
            }
        }
        Self { values: sums.into_iter().map(DVec3::as_vec3).collect() }
    }

    /// The sum of the coefficients by weight, such as power by area; in f64, in order.
    pub fn weighted_sum(&self, weights: impl IntoIterator<Item = Vec3>) -> DVec3 {
        self.values
            .iter()
            .zip(weights)
            .fold(DVec3::ZERO, |sum, (value, w)| sum + value.as_dvec3() * w.as_dvec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_rounded_once() {
        let tiny = Field::from_values(vec![Vec3::splat(3e-8)]);
        let one = Field::from_values(vec![Vec3::ONE]);
        // Added one after the other in f32, each of the tiny values would vanish.
        let many: Vec<&Field> = std::iter::once(&one).chain(std::iter::repeat_n(&tiny, 4)).collect();
        assert_eq!(Field::sum(1, many).node(NodeId(0)).0, Vec3::splat(1.0 + 1.2e-7));
    }

    #[test]
    fn weighted_sum_is_per_channel() {
        let field = Field::from_values(vec![Vec3::new(1.0, 2.0, 3.0), Vec3::ONE]);
        let power = field.weighted_sum([Vec3::splat(2.0), Vec3::new(0.0, 1.0, 4.0)]);
        assert_eq!(power, DVec3::new(2.0, 5.0, 10.0));
    }
}
