//! The balance heuristic: shadow rays and hemisphere rays estimate the same light together.
//!
//! Each sample counts by its share of the density of both kinds in its direction, so that the kind that is worse there
//! adds little noise.
//!
//! Veach and Guibas, *Optimally Combining Sampling Techniques for Monte Carlo Rendering*, 1995.

use crate::hemisphere::HemisphereDensity;
use crate::plan::Plan;

/// Hemisphere rays and their density beside shadow rays to a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// Hemisphere rays per shadow ray.
    rays: f64,
    density: HemisphereDensity,
}

impl Balance {
    /// Of a light that every receiver samples.
    ///
    /// As requested: any number is unbiased, as long as both kinds use the same.
    pub(crate) fn new(plan: &Plan, density: HemisphereDensity) -> Self {
        Self { rays: f64::from(plan.indirect_samples) / f64::from(plan.direct_samples.max(1)), density }
    }

    /// Of a light that a shadow ray chooses with this probability.
    pub(crate) fn when_chosen(self, probability: f64) -> Self {
        Self { rays: self.rays / probability, ..self }
    }

    /// The density of both kinds in a direction, per shadow ray to the light, sr⁻¹; `pdf` is that of shadow rays.
    pub(crate) fn combined_pdf(self, pdf: f64, cos: f32) -> f64 {
        pdf + f64::from(self.density.pdf(cos)) * self.rays
    }

    /// The share that a hemisphere ray keeps of what it brings.
    pub(crate) fn ray_share(self, pdf: f64, cos: f32) -> f32 {
        let by_rays = f64::from(self.density.pdf(cos)) * self.rays;
        (by_rays / (by_rays + pdf)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_shares_of_a_direction_sum_to_one() {
        let plan = Plan { direct_samples: 16, indirect_samples: 256, ..Plan::default() };
        for density in [HemisphereDensity::Cosine, HemisphereDensity::Mixed] {
            for (probability, pdf, cos) in [(1.0, 0.1, 0.5), (0.2, 1e5, 0.9), (1e-9, 1e-6, 0.01)] {
                let balance = Balance::new(&plan, density).when_chosen(probability);
                let by_shadow_rays = pdf / balance.combined_pdf(pdf, cos);
                assert!((by_shadow_rays + f64::from(balance.ray_share(pdf, cos)) - 1.0).abs() < 1e-6);
            }
        }
    }
}
