//! Ambient occlusion: how much of an even sky is seen past what is near.

/// How surfaces near a site hide what is behind them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientOcclusion {
    /// What is farther away hides nothing, metres; positive, or infinite.
    pub distance: f32,
    /// The power with which hiding falls from 1 at the site to 0 at that distance; with 0, all that is nearer hides.
    pub falloff: f32,
}

impl AmbientOcclusion {
    /// The share of light that passes a surface so far away, metres.
    pub fn openness(&self, distance: f32) -> f32 {
        if distance >= self.distance {
            1.0
        } else {
            1.0 - (1.0 - distance / self.distance).powf(self.falloff)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_hides_more() {
        let linear = AmbientOcclusion { distance: 2.0, falloff: 1.0 };
        assert_eq!(
            [0.0, 0.5, 1.0, 2.0, 9.0, f32::INFINITY].map(|t| linear.openness(t)),
            [0.0, 0.25, 0.5, 1.0, 1.0, 1.0]
        );
        let hard = AmbientOcclusion { falloff: 0.0, ..linear };
        assert_eq!([0.0, 1.9, 2.0].map(|t| hard.openness(t)), [0.0, 0.0, 1.0]);
        let without_end = AmbientOcclusion { distance: f32::INFINITY, falloff: 1.0 };
        assert_eq!([0.0, 1e9, f32::INFINITY].map(|t| without_end.openness(t)), [0.0, 0.0, 1.0]);
    }
}
