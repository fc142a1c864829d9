//! The lights of a scene, ready to be sampled.

use crate::emitters::Emitter;
use crate::light_tree::{Extent, LightTree};
use crate::plan::EmitterSampling;
use crate::sky_light::SkyLight;
use lumel_sample::PiecewiseConstant2D;
use lumel_scene::{
    Barycentrics, DirectionalLight, DiskLight, Light, PointLight, Radiance, RectLight, Scene, SphereLight,
    SpotLight, SunLight, SurfacePoint, Texture, TriId, luminance,
};

/// Up to this many lights with an area are all sampled at every receiver; of more, some are chosen.
const MAX_LOOPED: usize = 8;

/// Emissive surfaces up to this share of the total area are worth sampling as lights.
const MAX_SAMPLED_SHARE: f64 = 0.1;

/// Share of the samples of a textured light that ignore the texture, so that bilinear fringes of black texels are
/// sampled too.
const UNIFORM_SHARE: f32 = 0.05;

/// A light with an area or a solid angle.
#[derive(Clone, Debug)]
pub(crate) enum AreaLight {
    /// A rectangle of constant radiance.
    Rect(RectLight),
    /// A rectangle with a texture, and the density of its brightness.
    TexturedRect(RectLight, PiecewiseConstant2D),
    /// A triangle of constant radiance.
    Triangle(TriId, Radiance),
    /// A triangle whose radiance is looked up.
    TexturedTriangle(TriId),
    /// A disk of constant radiance.
    Disk(DiskLight),
    /// A sphere of constant radiance.
    Sphere(SphereLight),
    /// A cone of directions of constant radiance.
    Sun(SunLight),
    /// An image of all directions.
    Sky(SkyLight),
}

/// A light without area: its radiance is a delta function of direction.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DeltaLight {
    Point(PointLight),
    Spot(SpotLight),
    Directional(DirectionalLight),
}

/// All that shines in a scene, split by how it is measured.
#[derive(Clone, Debug)]
pub(crate) struct LightSet {
    pub(crate) area: Vec<(Emitter, AreaLight)>,
    pub(crate) delta: Vec<(Emitter, DeltaLight)>,
    /// Chooses among the area lights when they are too many to loop over.
    pub(crate) tree: Option<LightTree>,
    /// Whether hemisphere rays collect the emission of the surfaces they meet.
    pub(crate) emission_by_rays: bool,
    /// Whether hemisphere rays collect the sky.
    pub(crate) sky: bool,
}

impl LightSet {
    /// The lights of a scene.
    pub(crate) fn new(scene: &Scene, emitters: EmitterSampling) -> Self {
        let mut set = Self {
            area: Vec::new(),
            delta: Vec::new(),
            tree: None,
            emission_by_rays: false,
            sky: !scene.sky().is_zero(),
        };
        for (emitter, light) in (0..).map(Emitter::Light).zip(scene.lights()) {
            match *light {
                Light::Rect(rect) => set.area.extend(rect_light(scene, rect).map(|light| (emitter, light))),
                Light::Point(point) => set.delta.push((emitter, DeltaLight::Point(point))),
                Light::Spot(spot) => set.delta.push((emitter, DeltaLight::Spot(spot))),
                Light::Directional(sun) => set.delta.push((emitter, DeltaLight::Directional(sun))),
                Light::Sun(sun) => set.area.extend(shining(AreaLight::Sun(sun), sun.radiance(), emitter)),
                Light::Disk(disk) => set.area.extend(shining(AreaLight::Disk(disk), disk.radiance, emitter)),
                Light::Sphere(sphere) => {
                    set.area.extend(shining(AreaLight::Sphere(sphere), sphere.radiance, emitter));
                }
            }
        }
        set.add_emissive_surfaces(scene, emitters);
        let sky = scene.sky().image().and_then(SkyLight::new);
        set.area.extend(sky.map(|sky| (Emitter::Sky, AreaLight::Sky(sky))));
        if set.area.iter().filter(|(_, light)| !light.is_far()).count() > MAX_LOOPED {
            let extents = set.area.iter().enumerate();
            set.tree = LightTree::new(
                extents.filter_map(|(i, (_, light))| Some((i, light.extent(scene)?))).collect(),
            );
        }
        set
    }

    /// Whether anything is sampled by shadow rays.
    pub(crate) fn has_lights(&self) -> bool {
        !self.area.is_empty() || !self.delta.is_empty()
    }

    /// The image of the sky, if it is sampled.
    pub(crate) fn sky_light(&self) -> Option<&SkyLight> {
        // It is the last of all.
        self.area.last().and_then(|(_, light)| if let AreaLight::Sky(sky) = light { Some(sky) } else { None })
    }

    /// Whether direct light needs hemisphere rays.
    pub(crate) fn needs_hemisphere(&self) -> bool {
        self.sky || self.emission_by_rays
    }

    fn add_emissive_surfaces(&mut self, scene: &Scene, emitters: EmitterSampling) {
        let all = || (0..scene.triangle_count() as u32).map(TriId);
        let emissive: Vec<TriId> = all().filter(|&tri| scene.material(tri).emits()).collect();
        let area =
            |tris: &mut dyn Iterator<Item = TriId>| tris.map(|t| f64::from(scene.area(t))).sum::<f64>();
        let as_lights = match emitters {
            _ if emissive.is_empty() => return,
            EmitterSampling::Off => return,
            EmitterSampling::Lights => true,
            EmitterSampling::Rays => false,
            EmitterSampling::Auto => {
                area(&mut emissive.iter().copied()) <= MAX_SAMPLED_SHARE * area(&mut all())
            }
        };
        if !as_lights {
            self.emission_by_rays = true;
            return;
        }
        self.area.extend(emissive.into_iter().map(|tri| {
            let material = scene.material(tri);
            // What is not there everywhere emits as unevenly as a texture.
            let light = match material.emission_texture {
                None if !scene.is_transparent(tri) => AreaLight::Triangle(tri, material.emission),
                _ => AreaLight::TexturedTriangle(tri),
            };
            (Emitter::Surfaces(scene.material_id(tri)), light)
        }));
    }
}

/// A light unless it is black.
fn shining(light: AreaLight, radiance: Radiance, emitter: Emitter) -> Option<(Emitter, AreaLight)> {
    (!radiance.is_zero()).then_some((emitter, light))
}

fn rect_light(scene: &Scene, rect: RectLight) -> Option<AreaLight> {
    if rect.radiance.is_zero() {
        return None;
    }
    let Some(texture) = rect.texture else { return Some(AreaLight::Rect(rect)) };
    let density = brightness(&scene.textures()[texture.index()])?;
    Some(AreaLight::TexturedRect(rect, density))
}

/// The density of a texture's brightness over the light's unit square; `None` for a black texture.
///
/// Texel rows run down, the light's second coordinate up.
fn brightness(texture: &Texture) -> Option<PiecewiseConstant2D> {
    let (width, height) = texture.size();
    let rows = (0..height).rev().flat_map(|y| (0..width).map(move |x| (x, y)));
    let mut weights: Vec<f32> = rows.map(|(x, y)| luminance(texture.texel(x, y))).collect();
    let mean = weights.iter().map(|&w| f64::from(w)).sum::<f64>() / weights.len() as f64;
    for weight in &mut weights {
        *weight = *weight * (1.0 - UNIFORM_SHARE) + mean as f32 * UNIFORM_SHARE;
    }
    (mean > 0.0).then(|| PiecewiseConstant2D::new(&weights, width as usize, height as usize)).flatten()
}

impl AreaLight {
    /// Whether it is infinitely far away: such lights are all sampled at every receiver.
    pub(crate) fn is_far(&self) -> bool {
        matches!(self, Self::Sun(_) | Self::Sky(_))
    }

    /// What chooses among lights knows of this one; `None` if it sends nothing or is [far](Self::is_far).
    fn extent(&self, scene: &Scene) -> Option<Extent> {
        let power = self.relative_power(scene);
        match self {
            Self::Rect(rect) | Self::TexturedRect(rect, _) => {
                Extent::flat(&rect.corners().map(|p| p.as_dvec3()), power)
            }
            Self::Triangle(tri, _) | Self::TexturedTriangle(tri) => {
                Extent::flat(&scene.triangle_positions(*tri).map(|p| p.as_dvec3()), power)
            }
            Self::Disk(disk) => {
                Extent::disk(disk.center.as_dvec3(), disk.direction.as_dvec3(), disk.radius, power)
            }
            Self::Sphere(sphere) => Extent::sphere(sphere.center.as_dvec3(), sphere.radius, power),
            Self::Sun(_) | Self::Sky(_) => None,
        }
    }

    /// Power up to a common factor, for choosing lights.
    fn relative_power(&self, scene: &Scene) -> f64 {
        let middle = |tri| SurfacePoint { tri, bary: Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 } };
        let (radiance, area) = match self {
            Self::Rect(rect) => (rect.radiance.0, rect.area()),
            Self::TexturedRect(rect, _) => (rect.radiance.0, rect.area()),
            Self::Disk(disk) => (disk.radiance.0, disk.area()),
            Self::Sphere(sphere) => (sphere.radiance.0, sphere.area()),
            Self::Sun(_) | Self::Sky(_) => return 0.0,
            Self::Triangle(tri, radiance) => (radiance.0, scene.area(*tri)),
            // Corners and middle, and a little of the brightest possible so that no light is forgotten.
            Self::TexturedTriangle(tri) => {
                let corners =
                    Barycentrics::CORNERS.map(|bary| scene.emission(SurfacePoint { tri: *tri, bary }).0);
                let seen = corners.into_iter().sum::<glam::Vec3>() + scene.emission(middle(*tri)).0;
                (seen * 0.25 + scene.material(*tri).emission.0 * 0.05, scene.area(*tri))
            }
        };
        // In f64: the area of a small light times a small radiance leaves the range of f32.
        f64::from(luminance(radiance)) * f64::from(area)
    }
}
