//! Places on surfaces.

use lumel_sample::{Dim, Sampler, Stream, StreamKey, uniform_triangle};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};

/// Random places on the surfaces of a scene, uniform by area: Sobol points. Both sides of a two-sided surface count.
#[derive(Clone, Debug)]
pub struct RandomPlaces {
    /// The area of all triangles up to each, m².
    areas: Vec<f64>,
    stream: Stream,
}

impl RandomPlaces {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        let areas = (0..scene.triangle_count() as u32).scan(0.0, |sum, tri| {
            *sum += f64::from(scene.area(TriId(tri)));
            Some(*sum)
        });
        Self { areas: areas.collect(), stream: Sampler::Sobol.stream(StreamKey::new(0), Dim::Area) }
    }

    /// Of all surfaces, m².
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or_default()
    }

    /// A place by its number. The first `n` are spread evenly, whatever `n` is.
    ///
    /// # Panics
    ///
    /// If there are no surfaces.
    pub fn place(&self, index: u32) -> SurfacePoint {
        /// The last digit of a number in the unit interval.
        const DIGIT: f64 = 1.0 / (1u32 << 24) as f64;
        let [s, t, u, v] = self.stream.sample_4d(index);
        // More triangles than one number tells apart.
        let area = (f64::from(s) + DIGIT * f64::from(t)) * self.area();
        let tri = self.areas.partition_point(|&sum| sum <= area).min(self.areas.len() - 1);
        SurfacePoint { tri: TriId(tri as u32), bary: Barycentrics::from(uniform_triangle([u, v])) }
    }
}
