//! Cones of directions that hold the normals of lights.

use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// All unit vectors within `spread` of `axis`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// Unit vector.
    pub(crate) axis: DVec3,
    /// Radians, up to π for all directions.
    pub(crate) spread: f64,
}

impl Cone {
    /// All directions.
    pub(crate) fn all() -> Self {
        Self { axis: DVec3::Y, spread: PI }
    }

    /// The smallest cone that holds both.
    pub(crate) fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.spread >= other.spread { (self, other) } else { (other, self) };
        let apart = angle(wide.axis, narrow.axis);
        if apart + narrow.spread <= wide.spread {
            return wide;
        }
        let spread = 0.5 * (wide.spread + apart + narrow.spread);
        // Opposite axes leave no plane to turn in, and half of all directions to either side.
        match wide.axis.cross(narrow.axis).try_normalize() {
            Some(pivot) if spread < PI => {
                Self { axis: DQuat::from_axis_angle(pivot, spread - wide.spread) * wide.axis, spread }
            }
            _ => Self { axis: wide.axis, spread: PI },
        }
    }

    /// Solid angle into which diffuse surfaces with these normals shine, weighted by the cosine.
    ///
    /// Conty Estevez and Kulla, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, 2018, eq. 1.
    pub(crate) fn lit_measure(self) -> f64 {
        let (sin, cos) = self.spread.sin_cos();
        let lit = (self.spread + FRAC_PI_2).min(PI);
        let fringe = 2.0 * lit * sin - (self.spread - 2.0 * lit).cos() - 2.0 * self.spread * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * fringe
    }
}

/// The angle between two vectors, with all its digits where it is small.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_union_holds_both_cones_and_no_more() {
        let x = Cone { axis: DVec3::X, spread: 0.1 };
        let y = Cone { axis: DVec3::Y, spread: 0.3 };
        let both = x.union(y);
        assert!((both.spread - 0.5 * (FRAC_PI_2 + 0.4)).abs() < 1e-12);
        assert!((angle(both.axis, x.axis) + x.spread - both.spread).abs() < 1e-12);
        assert!((angle(both.axis, y.axis) + y.spread - both.spread).abs() < 1e-12);
        assert_eq!(Cone { spread: 2.0, ..x }.union(y).spread, 2.0);
        assert_eq!(x.union(Cone { axis: -DVec3::X, spread: 0.1 }).spread, PI);
    }

    #[test]
    fn a_flat_light_shines_into_pi_and_all_directions_into_four_pi() {
        let flat = Cone { axis: DVec3::X, spread: 0.0 };
        assert!((flat.lit_measure() - PI).abs() < 1e-12);
        assert!((Cone { spread: PI, ..flat }.lit_measure() - 4.0 * PI).abs() < 1e-12);
    }
}
