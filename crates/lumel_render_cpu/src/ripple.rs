//! Waves over surfaces.

use glam::{Vec3, Vec4, Vec4Swizzles};
use lumel_scene::MaterialId;

/// Waves that run over surfaces and tilt their normals, as those of water do; nothing moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// Length of the longest waves over 2π, metres.
    pub length: f32,
    /// The steepest slope.
    pub slope: f32,
    /// How far the longest waves have run, radians. Shorter ones are slower, as on deep water.
    pub phase: f32,
}

/// A ripple, and the materials that have it.
#[derive(Clone, Copy, Debug)]
pub struct Rippled<'a> {
    /// The waves.
    pub ripple: Ripple,
    /// Where they are.
    pub materials: &'a [MaterialId],
}

impl Ripple {
    /// The waves: their direction, as long as they are shorter than the longest, and their share of the slope.
    ///
    /// Directions are in space, so that surfaces that face any way have waves, and neighbours the same.
    pub const WAVES: [Vec4; 4] = [
        Vec4::new(0.71, 0.52, -0.47, 0.4),
        Vec4::new(-0.62, 1.17, 0.98, 0.27),
        Vec4::new(1.05, -0.83, 1.86, 0.2),
        Vec4::new(-1.93, -1.41, -2.34, 0.13),
    ];

    /// A unit normal where waves tilt it.
    pub fn tilted(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let slope: Vec3 = Self::WAVES
            .iter()
            .map(|wave| {
                let (along, shortness) = (wave.xyz(), wave.xyz().length());
                let phase = along.dot(position) / self.length - shortness.sqrt() * self.phase;
                along * (self.slope * wave.w / shortness * phase.cos())
            })
            .sum();
        (normal - slope.reject_from_normalized(normal)).try_normalize().unwrap_or(normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_run_and_are_no_steeper_than_they_may_be() {
        let shares: f32 = Ripple::WAVES.iter().map(|wave| wave.w).sum();
        assert!((shares - 1.0).abs() < 1e-6);
        let at = |phase: f32, p: Vec3| Ripple { length: 0.1, slope: 0.4, phase }.tilted(p, Vec3::Y);
        let mut mean = Vec3::ZERO;
        for i in 0..400 {
            let p = Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32) * 0.173;
            let n = at(1.0, p);
            assert!(n.is_normalized() && n.y >= (1.0 + 0.16_f32).sqrt().recip() - 1e-6, "{n}");
            mean += n / 400.0;
        }
        assert!(mean.y > 0.9 && mean.x.abs() + mean.z.abs() < 0.05, "{mean}");
        assert!(at(1.0, Vec3::ONE).distance(at(1.5, Vec3::ONE)) > 0.02, "they run");
        // Walls have waves, too.
        let wall = Ripple { length: 0.1, slope: 0.4, phase: 1.0 }.tilted(Vec3::ONE, Vec3::X);
        assert!(wall.x > 0.9 && wall.x < 1.0, "{wall}");
        assert_eq!(Ripple { length: 0.1, slope: 0.0, phase: 2.0 }.tilted(Vec3::ONE, Vec3::Z), Vec3::Z);
    }
}
