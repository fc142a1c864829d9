//! Lights as texts describe them: in project files and on the command line, with the same keys.

use crate::decimal::decimal;
use crate::spec::SpecError;
use glam::{DVec3, Vec2, Vec3};
use lumel_scene::{
    DirectionalLight, DiskLight, Light, PointLight, Radiance, RectLight, SphereLight, SpotLight, SunLight,
};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The cosine up to which two half-edges count as perpendicular; the tolerance of scenes, see
/// [`SceneError::BadLight`](lumel_scene::SceneError::BadLight).
const RIGHT_ANGLE_COS: f32 = 1e-3;
/// Angular diameter of the sun seen from the earth, degrees.
const SUN_DEG: f32 = 0.53;
/// The cone of a spot that names none, degrees from its axis: that of glTF.
const SPOT_DEG: f32 = 45.0;
/// The narrowest difference between a spot's cones, degrees.
const LEAST_PENUMBRA_DEG: f32 = 0.06;

/// The kind of a light in a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    /// A rectangle: `center`, `u` and `v` or `size` with `direction` or `toward`, `radiance`.
    #[default]
    Rect,
    /// A disk: `center`, `direction` or `toward`, `radius`, `radiance`.
    Disk,
    /// A point, or a sphere if it has a `radius`: `position`, `intensity`, `range`.
    Point,
    /// A cone: `position`, `direction` or `toward`, `intensity`, `inner`, `outer`, `range`.
    Spot,
    /// A disk in the sky: `direction`, `irradiance`, `angle`.
    Sun,
}

impl LightKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Rect, Self::Disk, Self::Point, Self::Spot, Self::Sun];

    /// Its name in texts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rect => "rect",
            Self::Disk => "disk",
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Sun => "sun",
        }
    }

    /// The keys that it may have besides its name.
    pub fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Rect => &["center", "u", "v", "size", "direction", "toward", "radiance"],
            Self::Disk => &["center", "direction", "toward", "radius", "radiance"],
            Self::Point => &["position", "radius", "intensity", "range"],
            Self::Spot => &["position", "direction", "toward", "inner", "outer", "intensity", "range"],
            Self::Sun => &["direction", "angle", "irradiance"],
        }
    }

    /// An example, which is a light.
    pub fn example(self) -> &'static str {
        match self {
            Self::Rect => "rect center=0,2,0 direction=0,-1,0 size=1,1 radiance=10,10,10",
            Self::Disk => "disk center=0,2,0 toward=0,0,0 radius=0.2 radiance=10,10,10",
            Self::Point => "point position=0,2,0 radius=0.05 intensity=10,10,10",
            Self::Spot => "spot position=0,2,0 toward=0,0,0 inner=20 outer=30 intensity=50,50,50",
            Self::Sun => "sun direction=-1,-2,-1 irradiance=5,5,5 angle=0.53",
        }
    }

    /// The kind that a light has in texts.
    pub fn of(light: &Light) -> Self {
        match light {
            Light::Rect(_) => Self::Rect,
            Light::Disk(_) => Self::Disk,
            Light::Point(_) | Light::Sphere(_) => Self::Point,
            Light::Spot(_) => Self::Spot,
            Light::Directional(_) | Light::Sun(_) => Self::Sun,
        }
    }
}

/// A light in a project file. Which keys it has depends on its [kind](LightKind).
///
/// ```
/// let project: lumel::Project = r#"
///     builtin = "cornell-box"
///     [[light]]
///     kind = "sun"
///     direction = [-1.0, -2.0, -1.0]
///     irradiance = [5.0, 5.0, 5.0]
/// "#.parse().unwrap();
/// assert!(matches!(project.lights[0].light(), Ok(lumel::Light::Sun(_))));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightEntry {
    /// Its name in editors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What it is.
    #[serde(default, skip_serializing_if = "is_default")]
    pub kind: LightKind,
    /// Centre of a rectangle or a disk, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub center: Option<DVec3>,
    /// Position of a point or a spot, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<DVec3>,
    /// Half of one edge of a rectangle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub u: Option<Vec3>,
    /// Half of the other edge; light leaves on the `u × v` side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub v: Option<Vec3>,
    /// Width and height of a rectangle, metres, with `direction` or `toward` instead of `u` and `v`; its width is
    /// horizontal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<Vec2>,
    /// The direction in which it shines, of any length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<Vec3>,
    /// A point that it faces, instead of `direction`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toward: Option<DVec3>,
    /// Radius of a disk, or of a point that is a sphere, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// The angle from the axis at which a spot begins to fade, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inner: Option<f32>,
    /// The angle from the axis at which it is dark, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outer: Option<f32>,
    /// Angular diameter of a sun, degrees; 0 for sharp shadows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<f32>,
    /// Emitted radiance of a rectangle or a disk, W·m⁻²·sr⁻¹.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radiance: Option<Vec3>,
    /// Radiant intensity of a point or a spot, W·sr⁻¹.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intensity: Option<Vec3>,
    /// Irradiance of a sun on a surface that faces it, W·m⁻².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub irradiance: Option<Vec3>,
    /// Distance beyond which a point or a spot does not reach, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<f32>,
    /// An image that multiplies the radiance of a rectangle, relative to the project file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<PathBuf>,
    /// Whether it is kept but emits no light.
    #[serde(default, skip_serializing_if = "is_default")]
    pub off: bool,
    /// Whether editors preserve its power instead of its radiance when they resize it.
    #[serde(default, skip_serializing_if = "is_default")]
    pub constant_power: bool,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn problem<T>(message: impl Into<String>) -> Result<T, SpecError> {
    Err(SpecError::new(message))
}

impl LightEntry {
    /// The light without its texture, whether it is on or off.
    ///
    /// # Errors
    /// A key that is missing, that its kind does not have, or that has an impossible value; the message names it.
    pub fn light(&self) -> Result<Light, SpecError> {
        self.check_keys()?;
        let light = match self.kind {
            LightKind::Rect => Light::Rect(self.rect()?),
            LightKind::Disk => Light::Disk(DiskLight {
                center: required("center", self.center)?.as_vec3(),
                direction: self.facing(required("center", self.center)?)?,
                radius: positive("radius", required("radius", self.radius)?)?,
                radiance: Radiance(power("radiance", self.radiance)?),
            }),
            LightKind::Point => self.point_or_sphere()?,
            LightKind::Spot => Light::Spot(self.spot()?),
            LightKind::Sun => self.sun()?,
        };
        light.problem().map_or(Ok(light), problem)
    }

    /// The light elsewhere.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        let moved = |place: Option<DVec3>| place.map(|place| place + by);
        Self {
            center: moved(self.center),
            position: moved(self.position),
            toward: moved(self.toward),
            ..self.clone()
        }
    }

    /// Every key that was given, by its name.
    fn given(&self) -> impl Iterator<Item = &'static str> {
        let keys = [
            ("center", self.center.is_some()),
            ("position", self.position.is_some()),
            ("u", self.u.is_some()),
            ("v", self.v.is_some()),
            ("size", self.size.is_some()),
            ("direction", self.direction.is_some()),
            ("toward", self.toward.is_some()),
            ("radius", self.radius.is_some()),
            ("inner", self.inner.is_some()),
            ("outer", self.outer.is_some()),
            ("angle", self.angle.is_some()),
            ("radiance", self.radiance.is_some()),
            ("intensity", self.intensity.is_some()),
            ("irradiance", self.irradiance.is_some()),
            ("range", self.range.is_some()),
        ];
        keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| key)
    }

    fn check_keys(&self) -> Result<(), SpecError> {
        let (name, keys) = (self.kind.name(), self.kind.keys());
        if let Some(key) = self.given().find(|key| !keys.contains(key)) {
            return problem(format!("a {name} has no {key}; its keys are {}", keys.join(", ")));
        }
        if self.texture.is_some() && self.kind != LightKind::Rect {
            return problem(format!("a {name} has no texture; only a rect has"));
        }
        Ok(())
    }

    fn rect(&self) -> Result<RectLight, SpecError> {
        let center = required("center", self.center)?;
        let by_edges = self.u.is_some() || self.v.is_some();
        let by_size = self.size.is_some() || self.direction.is_some() || self.toward.is_some();
        if by_edges && by_size {
            return problem("give either u and v, or size with direction or toward");
        }
        let [u, v] = if by_size {
            let size = required("size", self.size)?;
            let half = [size.x, size.y].map(|side| positive("size", 0.5 * side));
            half_edges(self.facing(center)?, [half[0].clone()?, half[1].clone()?])
        } else {
            let [u, v] = [directed("u", required("u", self.u)?)?, directed("v", required("v", self.v)?)?];
            // Not `a > b`: overflowing lengths give NaN, and such edges are no better.
            let perpendicular = u.dot(v).abs() <= RIGHT_ANGLE_COS * u.length() * v.length();
            if !perpendicular {
                return problem("u and v must be perpendicular");
            }
            [u, v]
        };
        let radiance = Radiance(power("radiance", self.radiance)?);
        Ok(RectLight { center: center.as_vec3(), u, v, radiance, texture: None })
    }

    /// The unit direction of its front.
    fn facing(&self, from: DVec3) -> Result<Vec3, SpecError> {
        match (self.direction, self.toward) {
            (Some(_), Some(_)) => problem("give either direction or toward"),
            (Some(direction), None) => unit("direction", direction),
            (None, Some(target)) => unit("toward", (target - from).as_vec3()),
            (None, None) => problem("direction or toward is missing"),
        }
    }

    fn point(&self) -> Result<PointLight, SpecError> {
        let range = self.range.map(|range| positive("range", range)).transpose()?;
        Ok(PointLight {
            position: required("position", self.position)?.as_vec3(),
            intensity: power("intensity", self.intensity)?,
            range: range.unwrap_or(f32::INFINITY),
        })
    }

    fn point_or_sphere(&self) -> Result<Light, SpecError> {
        let PointLight { position, intensity, .. } = self.point()?;
        match (self.radius, self.range) {
            (None, _) => Ok(Light::Point(self.point()?)),
            (Some(_), Some(_)) => problem("a point with a radius has no range"),
            (Some(radius), None) => {
                let radius = positive("radius", radius)?;
                Ok(Light::Sphere(SphereLight::of_intensity(position, radius, intensity)))
            }
        }
    }

    fn spot(&self) -> Result<SpotLight, SpecError> {
        let point = self.point()?;
        let direction = self.facing(required("position", self.position)?)?;
        let outer = self.outer.unwrap_or(SPOT_DEG);
        let inner = self.inner.unwrap_or(0.0);
        if !(0.0 <= inner && inner < outer && outer <= 90.0) {
            return problem(format!("inner is {inner} and outer {outer} degrees; 0 <= inner < outer <= 90"));
        }
        if outer.to_radians() < SpotLight::LEAST_OUTER {
            return problem(format!(
                "outer is {outer} degrees, but must be 0.2 or more; use a wider cone, or a sun"
            ));
        }
        let inner = inner.min(outer - LEAST_PENUMBRA_DEG).max(0.0);
        let [cos_inner, cos_outer] = [inner, outer].map(|angle| angle.to_radians().cos());
        Ok(SpotLight { point, direction, cos_inner, cos_outer })
    }

    fn sun(&self) -> Result<Light, SpecError> {
        let direction = unit("direction", required("direction", self.direction)?)?;
        let parallel = DirectionalLight { direction, irradiance: power("irradiance", self.irradiance)? };
        let angle = self.angle.unwrap_or(SUN_DEG);
        if !(0.0..=180.0).contains(&angle) {
            return problem(format!("angle is {angle} degrees; it must be from 0 to 180"));
        }
        let sin_half_angle = (0.5 * angle).to_radians().sin();
        let sharp = sin_half_angle <= 0.0;
        Ok(if sharp {
            Light::Directional(parallel)
        } else {
            Light::Sun(SunLight { parallel, sin_half_angle })
        })
    }
}

/// Half of the edges of a rectangle that faces a unit direction, the first horizontal: up is +Y.
pub(crate) fn half_edges(facing: Vec3, [width, height]: [f32; 2]) -> [Vec3; 2] {
    let right = Vec3::Y.cross(facing).try_normalize().filter(|_| facing.y.abs() < 0.9999);
    let right = right.unwrap_or(Vec3::X);
    // Light leaves on the u × v side.
    [right * width, facing.cross(right).normalize_or_zero() * height]
}

fn required<T>(key: &str, value: Option<T>) -> Result<T, SpecError> {
    value.map_or_else(|| problem(format!("{key} is missing")), Ok)
}

fn positive(key: &str, value: f32) -> Result<f32, SpecError> {
    let possible = value > 0.0 && value.is_finite();
    if possible { Ok(value) } else { problem(format!("{key}: it must be greater than zero")) }
}

fn directed(key: &str, value: Vec3) -> Result<Vec3, SpecError> {
    unit(key, value).map(|_| value)
}

fn unit(key: &str, value: Vec3) -> Result<Vec3, SpecError> {
    value.try_normalize().map_or_else(|| problem(format!("{key}: it has no direction")), Ok)
}

fn power(key: &str, value: Option<Vec3>) -> Result<Vec3, SpecError> {
    let value = required(key, value)?;
    if value.is_finite() && value.min_element() >= 0.0 {
        Ok(value)
    } else {
        problem(format!("{key}: light cannot be negative or infinite"))
    }
}

impl From<&Light> for LightEntry {
    /// The entry whose [`light`](LightEntry::light) is this one, up to rounding; without a texture.
    fn from(light: &Light) -> Self {
        let new = Self { kind: LightKind::of(light), ..Self::default() };
        let range = |range: f32| range.is_finite().then_some(range);
        match *light {
            Light::Rect(RectLight { center, u, v, radiance, .. }) => Self {
                center: Some(decimal(center)),
                u: Some(u),
                v: Some(v),
                radiance: Some(radiance.0),
                ..new
            },
            Light::Disk(DiskLight { center, direction, radius, radiance }) => Self {
                center: Some(decimal(center)),
                direction: Some(direction),
                radius: Some(radius),
                radiance: Some(radiance.0),
                ..new
            },
            Light::Point(point) => Self {
                position: Some(decimal(point.position)),
                intensity: Some(point.intensity),
                range: range(point.range),
                ..new
            },
            Light::Sphere(sphere) => Self {
                position: Some(decimal(sphere.center)),
                intensity: Some(sphere.intensity()),
                radius: Some(sphere.radius),
                ..new
            },
            Light::Spot(SpotLight { point, direction, cos_inner, cos_outer }) => Self {
                position: Some(decimal(point.position)),
                direction: Some(direction),
                intensity: Some(point.intensity),
                inner: Some(cos_inner.min(1.0).acos().to_degrees()),
                outer: Some(cos_outer.clamp(0.0, 1.0).acos().to_degrees()),
                range: range(point.range),
                ..new
            },
            Light::Directional(sun) => Self {
                direction: Some(sun.direction),
                irradiance: Some(sun.irradiance),
                angle: Some(0.0),
                ..new
            },
            Light::Sun(SunLight { parallel, sin_half_angle }) => Self {
                direction: Some(parallel.direction),
                irradiance: Some(parallel.irradiance),
                angle: Some(2.0 * sin_half_angle.min(1.0).asin().to_degrees()),
                ..new
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-5
    }

    #[test]
    fn examples_are_lights_that_survive_being_an_entry() {
        for kind in LightKind::ALL {
            let spec = crate::spec::light(kind.example()).unwrap();
            assert_eq!(LightKind::of(&spec.light().unwrap()), kind);
            let entry = LightEntry::from(&spec.light().unwrap());
            let again = LightEntry::from(&entry.light().unwrap());
            let text = |entry: &LightEntry| toml::to_string(entry).unwrap();
            assert_eq!(toml::from_str::<LightEntry>(&text(&entry)).unwrap(), entry);
            for (a, b) in text(&entry).lines().zip(text(&again).lines()) {
                let [a, b] = [a, b].map(|line| line.split_once(" = ").unwrap());
                assert_eq!(a.0, b.0);
                let numbers = |text: &str| -> Vec<f32> {
                    let text = text.trim_matches(['[', ']']);
                    text.split(',').filter_map(|number| number.trim().parse().ok()).collect()
                };
                for (x, y) in numbers(a.1).into_iter().zip(numbers(b.1)) {
                    assert!((x - y).abs() <= 1e-3 * x.abs().max(1.0), "{}: {x} {y}", a.0);
                }
            }
        }
    }

    #[test]
    fn rectangles_face_where_they_are_told_with_level_edges() {
        let light = |text: &str| crate::spec::light(text).unwrap().light().unwrap();
        let Light::Rect(rect) = light("rect center=1,2,3 toward=4,6,3 size=2,4 radiance=1,1,1") else {
            panic!("it is a rectangle")
        };
        assert!(near(rect.normal().unwrap(), Vec3::new(0.6, 0.8, 0.0)));
        assert!((rect.u.length() - 1.0).abs() < 1e-6 && (rect.v.length() - 2.0).abs() < 1e-6);
        assert!(rect.u.y.abs() < 1e-6 && rect.v.y > 0.0);
        let Light::Rect(down) = light("rect center=0,2,0 direction=0,-3,0 size=2,4 radiance=1,1,1") else {
            panic!("it is a rectangle")
        };
        assert!(near(down.normal().unwrap(), -Vec3::Y) && near(down.u, Vec3::X));
    }

    #[test]
    fn suns_have_the_angle_of_the_sun_unless_they_say_otherwise() {
        let sun = |text: &str| crate::spec::light(text).unwrap().light().unwrap();
        let Light::Sun(SunLight { sin_half_angle, .. }) = sun("sun direction=0,-1,0 irradiance=1,1,1") else {
            panic!("it has a size")
        };
        assert!((2.0 * sin_half_angle.asin().to_degrees() - SUN_DEG).abs() < 1e-5);
        assert!(matches!(sun("sun direction=0,-1,0 irradiance=1,1,1 angle=0"), Light::Directional(_)));
    }

    #[test]
    fn problems_name_the_key() {
        for (text, problem) in [
            ("disk center=0,0,0 radius=1 radiance=1,1,1", "direction or toward is missing"),
            ("disk center=0,0,0 toward=0,0,0 radius=1 radiance=1,1,1", "toward: it has no direction"),
            (
                "disk center=0,0,0 toward=0,1,0 radius=0 radiance=1,1,1",
                "radius: it must be greater than zero",
            ),
            ("rect center=0,0,0 u=1,0,0 v=0,0,1 size=1,1 radiance=1,1,1", "give either u and v, or size"),
            (
                "rect center=0,0,0 direction=0,1,0 toward=0,1,0 size=1,1 radiance=1,1,1",
                "give either direction",
            ),
            ("spot position=0,0,0 direction=0,1,0 intensity=1,1,1 outer=0.01", "outer is 0.01 degrees"),
            ("spot position=0,0,0 direction=0,1,0 intensity=1,1,1 inner=50", "inner is 50 and outer 45"),
            ("spot position=0,0,0 direction=0,1,0 intensity=1,1,1 outer=91", "inner is 0 and outer 91"),
            ("sun direction=0,1,0 irradiance=1,1,1 angle=181", "angle is 181 degrees"),
            ("point position=0,0,0 intensity=1,1,1 radius=1 range=3", "a point with a radius has no range"),
            ("point position=0,0,0 intensity=-1,1,1", "intensity: light cannot be negative"),
            ("point position=0,0,0", "intensity is missing"),
            ("sun direction=0,1,0 radiance=1,1,1", "there is no key \"radiance\""),
        ] {
            let error = crate::spec::light(text).unwrap_err().to_string();
            assert!(error.starts_with(problem), "{text}: {error}");
        }
        let entry = LightEntry { kind: LightKind::Sun, radius: Some(1.0), ..LightEntry::default() };
        assert!(entry.light().unwrap_err().to_string().starts_with("a sun has no radius; its keys are"));
    }
}
