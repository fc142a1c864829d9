//! Light as a vector of coefficients.

use crate::NodeId;
use glam::{DVec3, Vec3};
use lumel_scene::Irradiance;

/// Light in a basis: `channels` coefficients per node, W·m⁻².
///
/// Channel 0 is irradiance: surfaces reflect it and bounces read nothing else. Further channels are moments of the
/// light that arrives from different directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    channels: usize,
    /// Node by node.
    values: Vec<Vec3>,
}

impl Field {
    /// Darkness in one channel.
    pub fn zeros(nodes: usize) -> Self {
        Self::with_channels(1, vec![Vec3::ZERO; nodes])
    }

    /// Irradiance of given coefficients, one per node.
    pub fn from_values(values: Vec<Vec3>) -> Self {
        Self::with_channels(1, values)
    }

    /// A field of given coefficients, all channels of a node side by side.
    ///
    /// # Panics
    /// If there is no channel, or the values are no whole number of nodes.
    pub fn with_channels(channels: usize, values: Vec<Vec3>) -> Self {
        assert!(channels > 0 && values.len().is_multiple_of(channels), "{channels} channels per node");
        Self { channels, values }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Coefficients per node.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Irradiance at a node.
    #[inline]
    pub fn node(&self, node: NodeId) -> Irradiance {
        Irradiance(self.values[node.index() * self.channels])
    }

    /// All channels of a node.
    #[inline]
    pub fn coefficients(&self, node: NodeId) -> &[Vec3] {
        &self.values[node.index() * self.channels..][..self.channels]
    }

    /// All channels of a node, to change.
    pub fn coefficients_mut(&mut self, node: NodeId) -> &mut [Vec3] {
        &mut self.values[node.index() * self.channels..][..self.channels]
    }

    /// Replaces irradiance, channel 0, by that of another field over the same nodes.
    ///
    /// # Panics
    /// If the other field has another number of nodes.
    pub fn set_irradiance(&mut self, other: &Self) {
        assert_eq!(self.node_count(), other.node_count(), "fields over other nodes");
        let irradiance = other.values.iter().step_by(other.channels);
        self.values.iter_mut().step_by(self.channels).zip(irradiance).for_each(|(own, other)| *own = *other);
    }

    /// All coefficients, node by node.
    pub fn values(&self) -> &[Vec3] {
        &self.values
    }

    /// All coefficients, to change.
    pub fn values_mut(&mut self) -> &mut [Vec3] {
        &mut self.values
    }

    /// The sum of several fields over the same nodes and channels, rounded once; one channel of darkness for none.
    pub fn sum<'a>(nodes: usize, fields: impl IntoIterator<Item = &'a Field>) -> Self {
        let mut fields = fields.into_iter().peekable();
        let channels = fields.peek().map_or(1, |field| field.channels);
        let mut sums = vec![DVec3::ZERO; nodes * channels];
        for field in fields {
            for (sum, value) in sums.iter_mut().zip(&field.values) {
                *sum += value.as_dvec3();
            }
        }
        Self { channels, values: sums.into_iter().map(DVec3::as_vec3).collect() }
    }

    /// The sum of the irradiance by weight, such as power by area; in f64, in order.
    pub fn weighted_sum(&self, weights: impl IntoIterator<Item = Vec3>) -> DVec3 {
        let irradiance = self.values.iter().step_by(self.channels);
        irradiance.zip(weights).fold(DVec3::ZERO, |sum, (value, w)| sum + value.as_dvec3() * w.as_dvec3())
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
    fn weighted_sum_is_of_the_irradiance_by_colour() {
        let irradiance = [Vec3::new(1.0, 2.0, 3.0), Vec3::ONE];
        let power = |field: Field| field.weighted_sum([Vec3::splat(2.0), Vec3::new(0.0, 1.0, 4.0)]);
        assert_eq!(power(Field::from_values(irradiance.to_vec())), DVec3::new(2.0, 5.0, 10.0));
        let with_moments = irradiance.into_iter().flat_map(|e| [e, Vec3::splat(9.0)]).collect();
        assert_eq!(power(Field::with_channels(2, with_moments)), DVec3::new(2.0, 5.0, 10.0));
    }

    #[test]
    fn channels_of_a_node_lie_side_by_side() {
        let values: Vec<Vec3> = (0..6).map(|i| Vec3::splat(i as f32)).collect();
        let field = Field::with_channels(3, values);
        assert_eq!((field.node_count(), field.node(NodeId(1)).0), (2, Vec3::splat(3.0)));
        assert_eq!(field.coefficients(NodeId(1)), [3.0, 4.0, 5.0].map(Vec3::splat));
        assert_eq!(Field::sum(2, [&field, &field]).coefficients(NodeId(0))[2], Vec3::splat(4.0));
    }
}
