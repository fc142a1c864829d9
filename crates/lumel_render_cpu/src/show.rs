//! What a picture shows of a scene.

use crate::names::named;
use crate::rect_light::VisibleLight;
use crate::view::{Sight, View};
use glam::Vec3;
use lumel_accel::Ray;
use lumel_basis::Moment;
use lumel_scene::{Albedo, Irradiance};

/// What a picture shows.
///
/// Samples are averaged as linear values; the display transform is applied to the mean:
///
/// | | sample | display of the mean `c` |
/// |---|---|---|
/// | `Radiance` | `Le + ρE/π`, rectangle lights, sky | `srgb(tone(2^stops · c))` |
/// | `Irradiance` | `E/π`: white walls look the same as in `Radiance` | `srgb(tone(2^stops · c))` |
/// | `Albedo` | `ρ` | `srgb(c)` |
/// | `Normals` | `(n + 1)/2`, `n` the shading normal with the normal map | `c` |
/// | `FalseColor` | `E` | see [`FalseColor`](crate::FalseColor) |
/// | `Moment(Direction)` | `(d + 1)/2`, `d` the [dominant direction](lumel_basis::IncidentRadiance::dominant) | `c` |
/// | `Moment` of a coefficient | the coefficient | as `FalseColor`; zero is in the middle of the range |
///
/// Where no lit side of a surface is visible, all but `Radiance` are black, and moments where light is not known by direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Show {
    /// What the eye would see.
    #[default]
    Radiance,
    /// Irradiance, shown as on white surfaces.
    Irradiance,
    /// The fraction of light that surfaces reflect.
    Albedo,
    /// The direction that surfaces face: red is +x, green +y, blue +z.
    Normals,
    /// Luminance of the irradiance as colours, with a legend.
    FalseColor,
    /// What is known of light by direction.
    Moment(Moment),
}

named!(
    Show,
    "quantity to show",
    Radiance = "radiance",
    Irradiance = "irradiance",
    Albedo = "albedo",
    Normals = "normals",
    FalseColor = "false-color",
    Moment(Moment::Direction) = Moment::Direction.name(),
    Moment(Moment::Sh0) = Moment::Sh0.name(),
    Moment(Moment::Sh1) = Moment::Sh1.name(),
    Moment(Moment::Sh2) = Moment::Sh2.name(),
    Moment(Moment::Sh3) = Moment::Sh3.name(),
    Moment(Moment::Sh4) = Moment::Sh4.name(),
    Moment(Moment::Sh5) = Moment::Sh5.name(),
    Moment(Moment::Sh6) = Moment::Sh6.name(),
    Moment(Moment::Sh7) = Moment::Sh7.name(),
    Moment(Moment::Sh8) = Moment::Sh8.name(),
);

impl Show {
    /// Whether exposure and tone mapping apply.
    pub fn is_exposed(self) -> bool {
        matches!(self, Self::Radiance | Self::Irradiance)
    }

    /// Whether it is shown in false colours.
    pub fn is_in_false_color(self) -> bool {
        match self {
            Self::FalseColor => true,
            Self::Moment(moment) => moment.harmonic().is_some(),
            Self::Radiance | Self::Irradiance | Self::Albedo | Self::Normals => false,
        }
    }

    /// The linear value along a ray; `None` where there is nothing of this kind.
    pub(crate) fn sample(self, view: &View<'_>, lights: &[VisibleLight<'_>], ray: Ray) -> Option<Vec3> {
        if self == Self::Radiance {
            return Some(view.radiance(lights, ray).0);
        }
        let (Sight::Surface(at), _) = view.sight(ray) else { return None };
        Some(match self {
            Self::Irradiance | Self::Radiance => as_on_white(view.irradiance(at)),
            Self::FalseColor => view.irradiance(at).0,
            Self::Albedo => view.scene.albedo(at).0,
            Self::Normals => encoded(view.shown_normal(at)),
            Self::Moment(Moment::Direction) => encoded(Moment::Direction.of(&view.lighting.incident(at)?)),
            Self::Moment(coefficient) => coefficient.of(&view.lighting.incident(at)?),
        })
    }
}

/// A vector, as long as 1 at most, as a colour.
fn encoded(vector: Vec3) -> Vec3 {
    0.5 * vector + Vec3::splat(0.5)
}

/// The radiance of a white surface under this light.
fn as_on_white(irradiance: Irradiance) -> Vec3 {
    irradiance.reflected(Albedo::splat(1.0)).radiance().0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for &show in Show::ALL {
            assert_eq!(show.to_string().parse(), Ok(show));
        }
        assert_eq!(
            Show::NAMES.join(" "),
            "radiance irradiance albedo normals false-color direction sh0 sh1 sh2 sh3 sh4 sh5 sh6 sh7 sh8",
            "names are part of the command line"
        );
        assert!("False-Color".parse::<Show>().is_err());
    }
}
