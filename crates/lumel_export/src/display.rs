//! Viewable colours of vertices: their scale and the sRGB curve.

use crate::ExportError;
use glam::Vec3;
use lumel_basis::{Lighting, irradiance_at_vertices};
use lumel_scene::{Albedo, Irradiance, Radiance, Scene, SurfacePoint};
use std::borrow::Cow;
use std::path::Path;

/// The fraction of lit vertices that an automatic exposure shows without clipping. The rest are highlights near lights.
const UNCLIPPED_SHARE: f64 = 0.98;

/// The scale from radiance to the viewable colours that lit meshes carry beside their irradiance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ColorScale {
    /// Chosen so that a white surface at the 98th percentile of irradiance is displayed as white.
    #[default]
    Auto,
    /// Chosen so that nothing is clipped: the brightest value is displayed as white.
    Unclipped,
    /// A fixed factor: radiance times this is displayed; 1 is white.
    Factor(f32),
}

impl ColorScale {
    /// The factor of radiance before display: finite and greater than zero.
    pub(crate) fn factor(self, path: &Path, irradiance: &[Vec3]) -> Result<f32, ExportError> {
        match self {
            Self::Factor(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
            Self::Factor(factor) => {
                let problem = format!("the exposure is {factor}; it must be finite and greater than zero");
                Err(ExportError::content(path, problem))
            }
            Self::Auto => Ok(factor_at(whites(irradiance), UNCLIPPED_SHARE)),
            Self::Unclipped => Ok(factor_at(whites(irradiance), 1.0)),
        }
    }
}

/// Brightness of white surfaces.
fn whites(irradiance: &[Vec3]) -> impl Iterator<Item = f32> {
    irradiance.iter().map(|&e| white_radiance(e).max_element())
}

/// The factor under which a share of all positive values is at most 1; 1 where there are none.
pub(crate) fn factor_at(values: impl Iterator<Item = f32>, share: f64) -> f32 {
    let mut lit: Vec<f32> = values.filter(|&radiance| radiance > 0.0).collect();
    if lit.is_empty() {
        return 1.0;
    }
    let rank = ((lit.len() - 1) as f64 * share) as usize;
    let (_, &mut white, _) = lit.select_nth_unstable_by(rank, f32::total_cmp);
    // Radiance below 1e-38 has no finite inverse.
    let factor = 1.0 / white;
    if factor.is_finite() { factor } else { 1.0 }
}

/// Radiance of a white diffuse surface under this irradiance, W·m⁻²·sr⁻¹.
pub(crate) fn white_radiance(irradiance: Vec3) -> Vec3 {
    Irradiance(irradiance).reflected(Albedo::splat(1.0)).radiance().0
}

/// Radiance that leaves a surface point: emitted and reflected.
pub(crate) fn seen_radiance(scene: &Scene, at: SurfacePoint, irradiance: Vec3) -> Radiance {
    scene.emission(at) + Irradiance(irradiance).reflected(scene.albedo(at)).radiance()
}

/// A linear value, clamped to 0..=1, on the sRGB curve: 0..=1.
pub(crate) fn srgb(linear: f32) -> f64 {
    let c = f64::from(linear.clamp(0.0, 1.0));
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// The linear value of a place on the sRGB curve, both 0..=1.
pub(crate) fn linear(srgb: f64) -> f64 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// A linear value on the sRGB curve as a byte.
pub(crate) fn srgb_byte(linear: f32) -> u8 {
    (255.0 * srgb(linear)).round() as u8
}

/// Irradiance at every vertex, W·m⁻², checked to be finite.
pub(crate) fn finite_irradiance<'a>(
    path: &Path,
    scene: &Scene,
    lighting: &'a dyn Lighting,
) -> Result<Cow<'a, [Vec3]>, ExportError> {
    let irradiance = irradiance_at_vertices(scene, lighting)
        .map_err(|error| ExportError::content(path, error.to_string()))?;
    match irradiance.iter().position(|e| !e.is_finite()) {
        None => Ok(irradiance),
        Some(vertex) => {
            let problem = format!("the irradiance at vertex {vertex} is not a finite number");
            Err(ExportError::content(path, problem))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_exposure_shows_all_but_the_brightest_spots() {
        let mut irradiance = vec![Vec3::splat(2.0); 98];
        irradiance.extend([Vec3::splat(500.0); 2]);
        irradiance.extend([Vec3::ZERO; 1000]);
        let exposure = ColorScale::Auto.factor(Path::new("x"), &irradiance).unwrap();
        assert!((white_radiance(irradiance[0]).x * exposure - 1.0).abs() < 1e-6);
    }

    #[test]
    fn darkness_and_bad_factors_are_handled() {
        let factor = |exposure: ColorScale, irradiance: &[Vec3]| exposure.factor(Path::new("x"), irradiance);
        assert_eq!(factor(ColorScale::Auto, &[]).unwrap(), 1.0);
        assert_eq!(factor(ColorScale::Auto, &[Vec3::ZERO, -Vec3::ONE]).unwrap(), 1.0);
        assert_eq!(factor(ColorScale::Auto, &[Vec3::splat(1e-44)]).unwrap(), 1.0);
        assert_eq!(factor(ColorScale::Factor(0.25), &[]).unwrap(), 0.25);
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(factor(ColorScale::Factor(bad), &[]).is_err());
        }
    }

    #[test]
    fn the_srgb_curve_passes_its_known_points() {
        let bytes = [-1.0, 0.0, 0.002, 0.214_041, 1.0, 9.0, f32::NAN].map(srgb_byte);
        assert_eq!(bytes, [0, 0, 7, 127, 255, 255, 0]);
        for byte in 0..=255 {
            assert_eq!(srgb_byte(linear(f64::from(byte) / 255.0) as f32), byte);
        }
    }
}
