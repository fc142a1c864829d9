//! An area light as one receiver sees it.

use crate::balance::Balance;
use crate::lights::AreaLight;
use crate::plan::LightSampling;
use crate::sky_light::SkyLight;
use crate::{cap, polygon};
use glam::{DVec3, Vec3};
use lumel_basis::{HARMONICS, Site};
use lumel_sample::{SphericalCap, SphericalRectangle, SphericalTriangle, concentric_disk, uniform_triangle};
use lumel_scene::{
    Barycentrics, DiskLight, Irradiance, Radiance, RectLight, Scene, SphereLight, SunLight, SurfacePoint,
    TriId, lift_from, offset_from,
};

/// The segment beyond which a light that is infinitely far away has no occluders, in units of the scene's diagonal.
const BEYOND_SCENE: f32 = 4.0;

/// A point in a direction from another, unit length, that lies beyond everything in the scene.
pub(crate) fn beyond(scene: &Scene, origin: Vec3, direction: Vec3) -> Vec3 {
    let reach = BEYOND_SCENE * scene.bounds().diagonal();
    origin + direction * reach
}

/// A light prepared for sampling from one site.
pub(crate) struct LightView<'a> {
    scene: &'a Scene,
    site: &'a Site,
    light: &'a AreaLight,
    front: &'a Front,
    balance: Option<Balance>,
    density: Density,
}

/// How points on the light are chosen.
enum Density {
    /// Uniform in solid angle.
    SolidAngleRect(SphericalRectangle),
    SolidAngleTriangle(SphericalTriangle),
    /// Likewise.
    Cap {
        cap: SphericalCap,
        /// Of a sphere, its distance and its squared radius.
        sphere: Option<[f64; 2]>,
        /// Unblocked irradiance per radiance.
        per_radiance: f64,
    },
    /// Uniform over the area, or by brightness.
    Area,
}

/// How far points keep from the edges of a light, in lengths of their lift: walls may rise there at a quarter of a right angle.
const INSET: f32 = 4.0;

/// The space before a light, where shadow rays end. By default they end on the light itself.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Front {
    /// From a point of the light to where they end, as the light is geometry or may lie on some. Its points are rounded
    /// more often than ray origins: twice the offset.
    lift: Vec3,
    /// Near the edges of the light, points move towards this as well, so that none is lifted into the next wall.
    center: Vec3,
}

impl Front {
    pub(crate) fn new(scene: &Scene, light: &AreaLight) -> Self {
        match light {
            AreaLight::Rect(rect) | AreaLight::TexturedRect(rect, _) => Self::of_polygon(&rect.corners()),
            AreaLight::Triangle(tri, _) | AreaLight::TexturedTriangle(tri, _) => {
                Self::of_polygon(&scene.triangle_positions(*tri))
            }
            AreaLight::Disk(disk) => Self::of_disk(disk),
            AreaLight::Sphere(_) | AreaLight::Sun(_) | AreaLight::Sky(_) => Self::default(),
        }
    }

    pub(crate) fn of_polygon(corners: &[Vec3]) -> Self {
        let lift = 2.0 * lift_from([corners[0], corners[1], corners[2]]);
        Self { lift, center: corners.iter().sum::<Vec3>() / corners.len() as f32 }
    }

    fn of_disk(disk: &DiskLight) -> Self {
        let (right, up) = disk.direction.any_orthonormal_pair();
        let corner = |x: f32, y: f32| disk.center + (right * x + up * y) * disk.radius;
        let offset = offset_from([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
        Self { lift: disk.direction * (2.0 * offset), center: disk.center }
    }

    /// Where the shadow ray to a point of the light ends.
    pub(crate) fn before(&self, point: Vec3) -> Vec3 {
        let inwards = (self.center - point).normalize_or_zero();
        point + self.lift + inwards * (INSET * self.lift.length())
    }
}

/// One point of a light.
pub(crate) struct LightSample {
    /// Where its shadow ray ends.
    pub(crate) target: Vec3,
    /// What it contributes to the mean if nothing is in the way.
    pub(crate) unblocked: Irradiance,
    /// The cosine to the site's normal, above zero.
    pub(crate) cos: f32,
}

impl LightSample {
    /// What it would contribute to a surface that faces it, W·m⁻².
    pub(crate) fn facing(&self) -> DVec3 {
        (self.unblocked.0 / self.cos).as_dvec3()
    }
}

impl<'a> LightView<'a> {
    /// `None` when no light of it can reach the site, however empty the scene.
    pub(crate) fn new(
        scene: &'a Scene,
        (light, front): (&'a AreaLight, &'a Front),
        site: &'a Site,
        sampling: LightSampling,
    ) -> Option<Self> {
        let density = match light {
            AreaLight::Rect(rect) | AreaLight::TexturedRect(rect, _) => {
                Density::of_polygon(light, &rect.corners(), site, sampling)?
            }
            AreaLight::Triangle(tri, _) | AreaLight::TexturedTriangle(tri, _) => {
                Density::of_polygon(light, &scene.triangle_positions(*tri), site, sampling)?
            }
            AreaLight::Sphere(sphere) => Density::of_sphere(sphere, site)?,
            AreaLight::Sun(sun) => Density::of_sun(sun, site)?,
            AreaLight::Disk(_) | AreaLight::Sky(_) => Density::Area,
        };
        Some(Self { scene, site, light, front, balance: None, density })
    }

    /// Whether the light has a [closed form](Self::unblocked).
    pub(crate) fn has_closed_form(&self) -> bool {
        match self.light {
            AreaLight::Rect(_) | AreaLight::Triangle(..) | AreaLight::Sphere(_) | AreaLight::Sun(_) => true,
            AreaLight::TexturedRect(..)
            | AreaLight::TexturedTriangle(..)
            | AreaLight::Disk(_)
            | AreaLight::Sky(_) => false,
        }
    }

    /// Irradiance if nothing were in the way, by the closed form if there is one; otherwise zero.
    pub(crate) fn unblocked(&self) -> Irradiance {
        let Site { origin, frame, .. } = self.site;
        let (radiance, per_radiance) = match self.light {
            AreaLight::Rect(rect) => {
                (rect.radiance, polygon::unit_irradiance(&rect.corners(), *origin, frame.normal))
            }
            AreaLight::Triangle(tri, radiance) => {
                let corners = self.scene.triangle_positions(*tri);
                (*radiance, polygon::unit_irradiance(&corners, *origin, frame.normal))
            }
            AreaLight::Sphere(SphereLight { radiance, .. }) => (*radiance, self.cap_irradiance()),
            AreaLight::Sun(sun) => (sun.radiance(), self.cap_irradiance()),
            _ => return Irradiance::ZERO,
        };
        Irradiance(radiance.0 * per_radiance as f32)
    }

    /// The radiance of a polygon that shines evenly, of a sphere or a sun, and what would arrive per unit of it in all channels of light by direction if
    /// nothing were in the way.
    pub(crate) fn unblocked_moments(&self) -> Option<(DVec3, [f64; 1 + HARMONICS])> {
        let Site { origin, frame, .. } = self.site;
        let of = |corners: &[Vec3]| polygon::unit_moments(corners, *origin, frame.normal);
        let of_cap = |axis, sin_squared| cap::unit_moments(axis, sin_squared, frame.normal.as_dvec3());
        let (radiance, moments) = match self.light {
            AreaLight::Rect(rect) => (rect.radiance, of(&rect.corners())),
            AreaLight::Triangle(tri, radiance) => (*radiance, of(&self.scene.triangle_positions(*tri))),
            AreaLight::Sphere(sphere) => {
                let (axis, sin_squared) = cone_of_sphere(sphere, *origin)?;
                (sphere.radiance, of_cap(axis, sin_squared))
            }
            AreaLight::Sun(sun) => {
                let (axis, sin_squared) = cone_of_sun(sun);
                (sun.radiance(), of_cap(axis, sin_squared))
            }
            _ => return None,
        };
        Some((radiance.0.as_dvec3(), moments))
    }

    fn cap_irradiance(&self) -> f64 {
        if let Density::Cap { per_radiance, .. } = self.density { per_radiance } else { 0.0 }
    }

    /// Of a light that hemisphere rays find too.
    pub(crate) fn combined(self, balance: Balance) -> Self {
        Self { balance: Some(balance), ..self }
    }

    /// Density of sampling a point of an emissive surface that lies in this direction, sr⁻¹.
    pub(crate) fn pdf(&self, at: SurfacePoint, direction: Vec3) -> f64 {
        match &self.density {
            Density::SolidAngleTriangle(triangle) => return triangle.pdf(),
            Density::SolidAngleRect(rectangle) => return rectangle.pdf(),
            Density::Cap { .. } | Density::Area => {}
        }
        let per_area = match self.light {
            AreaLight::TexturedTriangle(_, texels) => texels.pdf(at.bary) / self.scene.area(at.tri),
            AreaLight::Rect(rect) => 1.0 / rect.area(),
            _ => 1.0 / self.scene.area(at.tri),
        };
        let to_light = self.scene.position(at) - self.site.origin;
        let cos_light = -self.scene.geometric_normal(at.tri).dot(direction);
        per_solid_angle(per_area, to_light.length_squared(), cos_light)
    }

    /// The point of the light for `u` in the unit square; `None` if nothing of it arrives.
    pub(crate) fn sample(&self, u: [f32; 2]) -> Option<LightSample> {
        match self.light {
            AreaLight::Rect(rect) => match &self.density {
                Density::SolidAngleRect(rectangle) => {
                    self.in_solid_angle(rectangle.sample(u), rect.radiance, rectangle.pdf())
                }
                _ => self.on_rect(rect, u, rect.radiance, 1.0),
            },
            AreaLight::TexturedRect(rect, brightness) => {
                let (st, pdf) = brightness.sample(u);
                let texture = &self.scene.textures()[rect.texture?.index()];
                // The image's top is the end of `v`.
                let value = texture.sample(glam::Vec2::new(st[0], 1.0 - st[1]));
                self.on_rect(rect, st, Radiance(rect.radiance.0 * value), pdf)
            }
            AreaLight::Triangle(tri, _) => self.on_triangle(*tri, u, |u| (uniform_triangle(u).into(), 1.0)),
            AreaLight::TexturedTriangle(tri, texels) => self.on_triangle(*tri, u, |u| texels.sample(u)),
            AreaLight::Disk(disk) => self.on_disk(disk, u),
            AreaLight::Sphere(SphereLight { radiance, .. }) => self.in_cap(*radiance, u),
            AreaLight::Sun(sun) => self.in_cap(sun.radiance(), u),
            AreaLight::Sky(sky) => self.in_sky(sky, u),
        }
    }

    fn on_disk(&self, disk: &DiskLight, u: [f32; 2]) -> Option<LightSample> {
        let (right, up) = disk.direction.any_orthonormal_pair();
        let place = concentric_disk(u) * disk.radius;
        let target = disk.center + right * place.x + up * place.y;
        self.on_area(target, disk.direction, disk.radiance, 1.0 / disk.area())
    }

    /// Towards a sphere or a sun.
    fn in_cap(&self, radiance: Radiance, u: [f32; 2]) -> Option<LightSample> {
        let Density::Cap { cap, sphere, .. } = &self.density else { return None };
        let (direction, drop) = cap.sample(u);
        let target = match sphere {
            Some([distance, radius_squared]) => {
                // Up to its surface: the distance to the middle of the chord, less half of the chord.
                let aside = distance * distance * drop * (2.0 - drop);
                let t = distance * (1.0 - drop) - (radius_squared - aside).max(0.0).sqrt();
                self.site.origin + direction * t as f32
            }
            None => beyond(self.scene, self.site.origin, direction),
        };
        self.in_solid_angle(target, radiance, cap.pdf())
    }

    /// Towards the sky.
    fn in_sky(&self, sky: &SkyLight, u: [f32; 2]) -> Option<LightSample> {
        let sample = sky.sample(u);
        let target = beyond(self.scene, self.site.origin, sample.direction);
        self.in_solid_angle(target, sample.radiance, sample.pdf)
    }

    fn on_rect(&self, rect: &RectLight, st: [f32; 2], radiance: Radiance, pdf: f32) -> Option<LightSample> {
        self.on_area(rect.point(st), rect.normal()?, radiance, pdf / rect.area())
    }

    fn on_triangle(
        &self,
        tri: TriId,
        u: [f32; 2],
        place: impl Fn([f32; 2]) -> (Barycentrics, f32),
    ) -> Option<LightSample> {
        let corners = self.scene.triangle_positions(tri);
        if let Density::SolidAngleTriangle(triangle) = &self.density {
            let direction = triangle.sample(u);
            let (target, bary) = meet_plane(self.site.origin, direction, &corners)?;
            let radiance = emitted(self.scene, SurfacePoint { tri, bary });
            return self.in_solid_angle(target, radiance, triangle.pdf());
        }
        let (bary, pdf) = place(u);
        let at = SurfacePoint { tri, bary };
        let pdf_area = pdf / self.scene.area(tri);
        self.on_area(
            self.scene.position(at),
            self.scene.geometric_normal(tri),
            emitted(self.scene, at),
            pdf_area,
        )
    }

    /// A point chosen with a density per solid angle: `L cos θ / p`.
    fn in_solid_angle(&self, target: Vec3, radiance: Radiance, pdf_solid_angle: f64) -> Option<LightSample> {
        let cos = self.site.frame.normal.dot((target - self.site.origin).try_normalize()?);
        let pdf_solid_angle =
            self.balance.map_or(pdf_solid_angle, |balance| balance.combined_pdf(pdf_solid_angle, cos));
        let unblocked = Irradiance(radiance.0 * (cos / pdf_solid_angle as f32));
        (cos > 0.0).then_some(LightSample { target: self.front.before(target), unblocked, cos })
    }

    /// A point chosen with a density per area: `L cos θ cos θₗ / (r² p)`.
    ///
    /// Turning the hemisphere integral into one over the light brings in `cos θₗ / r²`.
    ///
    /// Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., 4.2.3.
    fn on_area(&self, target: Vec3, normal: Vec3, radiance: Radiance, pdf_area: f32) -> Option<LightSample> {
        let to_light = target - self.site.origin;
        let distance_squared = to_light.length_squared();
        let direction = to_light.try_normalize()?;
        let (cos, cos_light) = (self.site.frame.normal.dot(direction), -normal.dot(direction));
        if self.balance.is_some() {
            let pdf = per_solid_angle(pdf_area, distance_squared, cos_light);
            return (cos_light > 0.0).then(|| self.in_solid_angle(target, radiance, pdf)).flatten();
        }
        let unblocked = Irradiance(radiance.0 * (cos * cos_light / (distance_squared * pdf_area)));
        (cos > 0.0 && cos_light > 0.0).then_some(LightSample {
            target: self.front.before(target),
            unblocked,
            cos,
        })
    }
}

/// A density per area, seen from this squared distance at this cosine: sr⁻¹.
fn per_solid_angle(pdf_area: f32, distance_squared: f32, cos_light: f32) -> f64 {
    f64::from(pdf_area) * f64::from(distance_squared) / f64::from(cos_light.max(f32::MIN_POSITIVE))
}

impl Density {
    /// `None` for sites behind the light, or with all of it below the horizon.
    fn of_polygon(light: &AreaLight, corners: &[Vec3], site: &Site, sampling: LightSampling) -> Option<Self> {
        polygon::is_lit(corners, site.origin, site.frame.normal).then(|| match sampling {
            LightSampling::Area => Self::Area,
            LightSampling::Analytic => Self::by_solid_angle(light, corners, site.origin),
        })
    }

    fn of_sun(sun: &SunLight, site: &Site) -> Option<Self> {
        let (axis, sin_squared) = cone_of_sun(sun);
        let cos = site.frame.normal.as_dvec3().dot(axis);
        let cap = SphericalCap::new(axis.as_vec3(), sin_squared);
        Self::of_cap(cap, None, cap::unit_irradiance(cos, sin_squared))
    }

    fn of_sphere(sphere: &SphereLight, site: &Site) -> Option<Self> {
        let (axis, sin_squared) = cone_of_sphere(sphere, site.origin)?;
        let (distance, radius) =
            (sphere.center.as_dvec3().distance(site.origin.as_dvec3()), f64::from(sphere.radius));
        let cos = site.frame.normal.as_dvec3().dot(axis);
        let cap = SphericalCap::new(axis.as_vec3(), sin_squared);
        Self::of_cap(cap, Some([distance, radius.powi(2)]), cap::unit_irradiance(cos, sin_squared))
    }

    /// `None` if nothing of the cone is above the horizon.
    fn of_cap(cap: SphericalCap, sphere: Option<[f64; 2]>, per_radiance: f64) -> Option<Self> {
        (per_radiance > 0.0).then_some(Self::Cap { cap, sphere, per_radiance })
    }

    fn by_solid_angle(light: &AreaLight, corners: &[Vec3], from: Vec3) -> Self {
        match light {
            AreaLight::Rect(rect) => SphericalRectangle::new(rect.center, rect.u, rect.v, from)
                .map_or(Self::Area, Self::SolidAngleRect),
            // Brightness that varies matters more than the solid angle.
            AreaLight::TexturedTriangle(_, texels) if !texels.is_even() => Self::Area,
            AreaLight::Triangle(..) | AreaLight::TexturedTriangle(..) => {
                SphericalTriangle::new(corners[0], corners[1], corners[2], from)
                    .map_or(Self::Area, Self::SolidAngleTriangle)
            }
            _ => Self::Area,
        }
    }
}

/// The axis of the cone of directions to a sun, and the square of the sine of its half-angle.
fn cone_of_sun(sun: &SunLight) -> (DVec3, f64) {
    (-sun.parallel.direction.as_dvec3(), f64::from(sun.sin_half_angle).powi(2))
}

/// The same to a sphere; `None` from inside.
fn cone_of_sphere(sphere: &SphereLight, from: Vec3) -> Option<(DVec3, f64)> {
    let to_center = sphere.center.as_dvec3() - from.as_dvec3();
    let (squared, radius_squared) = (to_center.length_squared(), f64::from(sphere.radius).powi(2));
    (squared > radius_squared).then(|| (to_center / squared.sqrt(), radius_squared / squared))
}

/// The radiance that a surface sends, of which a share alone may be there.
fn emitted(scene: &Scene, at: SurfacePoint) -> Radiance {
    let emission = scene.emission(at);
    if scene.is_transparent(at.tri) { Radiance(emission.0 * scene.opacity(at)) } else { emission }
}

/// Where a direction meets the plane of a triangle, and its barycentrics, clamped to the triangle.
pub(crate) fn meet_plane(origin: Vec3, direction: Vec3, corners: &[Vec3; 3]) -> Option<(Vec3, Barycentrics)> {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3());
    let normal = (b - a).cross(c - a);
    let t = (a - origin).dot(normal) / direction.dot(normal);
    let point = origin + direction * t;
    let u = (c - b).cross(point - b).dot(normal) / normal.length_squared();
    let v = (a - c).cross(point - c).dot(normal) / normal.length_squared();
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0 - u.clamp(0.0, 1.0)));
    point.is_finite().then(|| (point.as_vec3(), Barycentrics { u: u as f32, v: v as f32 }))
}
