//! An image of the sky as a light: directions where it is bright.
//!
//! Direct light of an image is estimated by shadow rays to bright texels and hemisphere rays that meet nothing, in
//! [balance](crate::balance), so that neither a sun of a few texels nor a dim sky around it is noisy.

use glam::Vec3;
use lumel_sample::PiecewiseConstant2D;
use lumel_scene::{Radiance, SkyImage, luminance};
use std::sync::Arc;

/// A sky whose directions are sampled in proportion to luminance.
#[derive(Clone, Debug)]
pub(crate) struct SkyLight {
    image: Arc<SkyImage>,
    /// Of texels, by the light that comes from each.
    texels: PiecewiseConstant2D,
}

/// A direction to the sky.
pub(crate) struct SkySample {
    pub(crate) direction: Vec3,
    pub(crate) radiance: Radiance,
    /// Density, sr⁻¹.
    pub(crate) pdf: f64,
}

impl SkyLight {
    /// `None` for a black image.
    pub(crate) fn new(image: &Arc<SkyImage>) -> Option<Self> {
        let [width, height] = image.map().size();
        let weight = |column, row| {
            (f64::from(luminance(image.texel([column, row]).0)) * image.map().solid_angle(row)) as f32
        };
        let weights: Vec<f32> =
            (0..height).flat_map(|row| (0..width).map(move |column| weight(column, row))).collect();
        let texels = PiecewiseConstant2D::new(&weights, width as usize, height as usize)?;
        Some(Self { image: Arc::clone(image), texels })
    }

    pub(crate) fn sample(&self, u: [f32; 2]) -> SkySample {
        let size = self.image.map().size();
        let (place, _) = self.texels.sample(u);
        let scaled = [0, 1].map(|axis| f64::from(place[axis]) * f64::from(size[axis]));
        let texel = [0, 1].map(|axis| (scaled[axis] as u32).min(size[axis] - 1));
        let offset = [0, 1].map(|axis| (scaled[axis] - f64::from(texel[axis])) as f32);
        let direction = self.image.map().direction(texel, offset);
        SkySample { direction, radiance: self.image.texel(texel), pdf: self.pdf_of(texel) }
    }

    /// Density of sampling a direction, sr⁻¹.
    pub(crate) fn pdf(&self, direction: Vec3) -> f64 {
        self.pdf_of(self.image.map().texel(direction))
    }

    fn pdf_of(&self, texel: [u32; 2]) -> f64 {
        let size = self.image.map().size();
        let middle = [0, 1].map(|axis| ((f64::from(texel[axis]) + 0.5) / f64::from(size[axis])) as f32);
        let per_texel = f64::from(self.texels.pdf(middle)) / (f64::from(size[0]) * f64::from(size[1]));
        per_texel / self.image.map().solid_angle(texel[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_sample::{Dim, Sampler, StreamKey};
    use lumel_scene::Texture;

    fn light(texels: Vec<[f32; 3]>, [width, height]: [u32; 2]) -> SkyLight {
        let texture = Texture::from_floats("sky", width, height, texels).unwrap();
        SkyLight::new(&Arc::new(SkyImage::new(texture, 0.4, 2.0))).unwrap()
    }

    #[test]
    fn samples_have_the_density_they_were_drawn_with() {
        let mut texels: Vec<[f32; 3]> = (0..64 * 32).map(|i| [(i % 7) as f32, 0.5, 0.0]).collect();
        texels[700] = [1e6; 3];
        let sky = light(texels, [64, 32]);
        let stream = Sampler::Sobol.stream(StreamKey::new(1), Dim::Light(0));
        let n = 4096;
        let (mut sum, mut luminous) = (0.0, 0.0);
        for i in 0..n {
            let SkySample { direction, radiance, pdf } = sky.sample(stream.sample_2d(i));
            // At the edge of a texel, rounding may find its neighbour.
            luminous += f64::from(u8::from((sky.pdf(direction) / pdf - 1.0).abs() < 1e-9));
            sum += f64::from(luminance(radiance.0)) / pdf / f64::from(n);
        }
        assert!(luminous > 0.99 * f64::from(n), "{luminous}");
        // In proportion to luminance, every sample is worth the integral of the sky.
        let integral = 4.0
            * std::f64::consts::PI
            * f64::from(luminance(lumel_scene::Sky::Image(sky.image.clone()).mean().0));
        assert!((sum / integral - 1.0).abs() < 1e-5, "{sum} {integral}");
    }

    #[test]
    fn a_black_image_is_no_light() {
        let texture = Texture::from_floats("sky", 2, 1, vec![[0.0; 3]; 2]).unwrap();
        assert!(SkyLight::new(&Arc::new(SkyImage::new(texture, 0.0, 1.0))).is_none());
    }
}
