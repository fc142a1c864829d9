//! Coefficients of harmonics at many places.

use super::{Directional, HARMONICS, IncidentRadiance};
use glam::Vec3;
use lumel_scene::{Scene, SurfacePoint};

/// What is known at some places, such as vertices, of the light that arrives from different directions: coefficients of incident
/// radiance, W·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    kind: Directional,
    /// Place by place.
    values: Vec<Vec3>,
}

impl Coefficients {
    /// Those of all places, each with as many as its kind has side by side; `None` if it has none, or they are no whole number
    /// of places.
    pub fn new(kind: Directional, values: Vec<Vec3>) -> Option<Self> {
        let fits = kind != Directional::Off && values.len().is_multiple_of(kind.harmonics());
        fits.then_some(Self { kind, values })
    }

    /// Which harmonics they are of.
    pub fn kind(&self) -> Directional {
        self.kind
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.values.len() / self.kind.harmonics()
    }

    /// Whether there is no place.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Those of a place, in the order of [`Harmonics`](super::Harmonics).
    #[inline]
    pub fn of(&self, place: usize) -> &[Vec3] {
        &self.values[place * self.kind.harmonics()..][..self.kind.harmonics()]
    }

    /// Those at a surface point, if the places are the vertices of the scene.
    ///
    /// # Panics
    /// If there are fewer places than vertices.
    pub fn at(&self, scene: &Scene, at: SurfacePoint) -> Option<IncidentRadiance> {
        let mut sums = [Vec3::ZERO; HARMONICS];
        for (vertex, weight) in scene.triangle(at.tri).into_iter().zip(at.bary.weights()) {
            sums.iter_mut().zip(self.of(vertex as usize)).for_each(|(sum, c)| *sum += *c * weight);
        }
        IncidentRadiance::new(&sums[..self.kind.harmonics()])
    }

    /// Of all places, place by place.
    pub fn values(&self) -> &[Vec3] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_of_a_place_lie_side_by_side() {
        let values: Vec<Vec3> = (0..8).map(|i| Vec3::splat(i as f32)).collect();
        let coefficients = Coefficients::new(Directional::Sh1, values.clone()).unwrap();
        assert_eq!((coefficients.len(), coefficients.of(1)), (2, &values[4..]));
        assert_eq!(Coefficients::new(Directional::Sh2, values.clone()), None);
        assert_eq!(Coefficients::new(Directional::Off, values), None);
    }
}
