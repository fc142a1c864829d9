//! The lights of a scene, ready to be sampled.

use crate::emissive::{EmissiveTriangle, emissive_triangles, even_share};
use crate::emissive_rects::{EmissiveRect, rectangles};
use crate::emitters::Emitter;
use crate::light_tree::{Extent, LightTree};
use crate::light_view::{Front, LightView};
use crate::plan::{EmitterSampling, LightSampling, Plan};
use crate::sky_light::SkyLight;
use crate::texel_density::TexelDensity;
use lumel_basis::Site;
use lumel_sample::PiecewiseConstant2D;
use lumel_scene::{
    DirectionalLight, DiskLight, Light, PointLight, Radiance, RectLight, Scene, SphereLight, SpotLight,
    SunLight, Texture, TriId, luminance,
};
use std::ops::Range;

/// Up to this many lights with an area are all sampled at every receiver; of more, some are chosen.
const MAX_LOOPED: usize = 8;

/// Emission that is spread over this share of all surface or more is what most hemisphere rays meet: shadow rays would add
/// noise alone.
const MIN_EVEN_SHARE: f64 = 0.9;

/// Share of the samples of a textured light that ignore the texture, so that bilinear fringes of black texels are
/// sampled too.
const UNIFORM_SHARE: f32 = 0.05;

/// A light with an area or a solid angle.
#[derive(Clone, Debug)]
pub(crate) enum AreaLight {
    /// A rectangle of constant radiance: a light of the scene, or emissive triangles.
    Rect(RectLight),
    /// A rectangle with a texture, and the density of its brightness.
    TexturedRect(RectLight, PiecewiseConstant2D),
    /// A triangle of constant radiance.
    Triangle(TriId, Radiance),
    /// A triangle whose radiance is looked up, and the density of its brightness.
    TexturedTriangle(TriId, TexelDensity),
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
    /// Where shadow rays to each of them end.
    fronts: Vec<Front>,
    pub(crate) delta: Vec<(Emitter, DeltaLight)>,
    /// Chooses among the area lights when they are too many to loop over.
    pub(crate) tree: Option<LightTree>,
    /// Whether hemisphere rays collect the emission of the surfaces they meet, which nothing else does.
    pub(crate) emission_by_rays: bool,
    /// Where emissive surfaces are among the area lights.
    emissive: Range<usize>,
    /// Which of them each emissive triangle belongs to, in the order of triangles.
    light_of: Vec<(TriId, u32)>,
    /// Which of them are sampled by shadow rays and hemisphere rays together.
    combined: Combined,
    /// Whether hemisphere rays collect the sky.
    pub(crate) sky: bool,
}

/// Which emissive triangles are sampled by shadow rays and hemisphere rays [together](crate::balance).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Combined {
    None,
    /// Textured ones: others have a closed form, which has less noise than both.
    Textured,
    All,
}

impl LightSet {
    /// The lights of a scene.
    pub(crate) fn new(scene: &Scene, plan: &Plan) -> Self {
        let mut set = Self {
            area: Vec::new(),
            fronts: Vec::new(),
            delta: Vec::new(),
            tree: None,
            emission_by_rays: false,
            emissive: 0..0,
            light_of: Vec::new(),
            combined: Combined::None,
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
        set.add_emissive_surfaces(scene, plan.emitters);
        let sky = scene.sky().image().and_then(SkyLight::new);
        set.area.extend(sky.map(|sky| (Emitter::Sky, AreaLight::Sky(sky))));
        set.fronts = set.area.iter().map(|(_, light)| Front::new(scene, light)).collect();
        if set.area.iter().filter(|(_, light)| !light.is_far()).count() > MAX_LOOPED {
            let extents = set.area.iter().enumerate();
            set.tree = LightTree::new(
                extents.filter_map(|(i, (_, light))| Some((i, light.extent(scene)?))).collect(),
            );
        }
        if plan.emitters == EmitterSampling::Auto {
            let has_closed_form = set.tree.is_none() && plan.light_sampling == LightSampling::Analytic;
            set.combined = if has_closed_form { Combined::Textured } else { Combined::All };
        }
        set
    }

    /// An area light as a site sees it; `None` if no light of it can reach the site.
    pub(crate) fn view<'a>(
        &'a self,
        scene: &'a Scene,
        l: usize,
        site: &'a Site,
        sampling: LightSampling,
    ) -> Option<LightView<'a>> {
        LightView::new(scene, (&self.area[l].1, &self.fronts[l]), site, sampling)
    }

    /// Whether an area light has closed forms for [all moments](LightView::unblocked_moments).
    pub(crate) fn has_unblocked_moments(&self, l: usize) -> bool {
        let light = &self.area[l].1;
        matches!(
            light,
            AreaLight::Rect(_) | AreaLight::Triangle(..) | AreaLight::Sphere(_) | AreaLight::Sun(_)
        )
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
        self.sky || self.emission_by_rays || self.combines()
    }

    /// Whether any light is sampled by shadow rays and hemisphere rays together, beside the sky.
    pub(crate) fn combines(&self) -> bool {
        self.combined != Combined::None && self.emissive.clone().any(|l| self.is_combined(l))
    }

    /// Whether an area light is sampled by shadow rays and hemisphere rays together.
    pub(crate) fn is_combined(&self, l: usize) -> bool {
        match self.combined {
            _ if matches!(self.area[l].1, AreaLight::Sky(_)) => true,
            Combined::None => false,
            Combined::Textured => matches!(self.area[l].1, AreaLight::TexturedTriangle(..)),
            Combined::All => self.emissive.contains(&l),
        }
    }

    /// The place of an emissive triangle among the area lights.
    pub(crate) fn emissive_light(&self, tri: TriId) -> Option<usize> {
        let place = self.light_of.binary_search_by_key(&tri, |(tri, _)| *tri).ok()?;
        Some(self.light_of[place].1 as usize)
    }

    /// How likely it is that a shadow ray of a site chooses an area light; 1 where all are sampled.
    pub(crate) fn probability(&self, l: usize, site: &Site) -> f64 {
        let (origin, normal) = (site.origin.as_dvec3(), site.frame.normal.as_dvec3());
        self.tree.as_ref().map_or(1.0, |tree| tree.probability(l, origin, normal))
    }

    fn add_emissive_surfaces(&mut self, scene: &Scene, emitters: EmitterSampling) {
        if emitters == EmitterSampling::Off || !scene.materials().iter().any(|material| material.emits()) {
            return;
        }
        let shining = match emitters {
            EmitterSampling::Rays => Vec::new(),
            _ => emissive_triangles(scene),
        };
        let is_even = || even_share(scene, &shining) >= MIN_EVEN_SHARE;
        if emitters == EmitterSampling::Rays || emitters == EmitterSampling::Auto && is_even() {
            self.emission_by_rays = true;
            return;
        }
        let begin = self.area.len();
        let plain: Vec<TriId> = shining
            .iter()
            .filter(|triangle| triangle.density.is_none())
            .map(|triangle| triangle.tri)
            .collect();
        let (rects, plain) = rectangles(scene, &plain);
        for EmissiveRect { rect, material, tris } in rects {
            let l = self.area.len() as u32;
            self.light_of.extend(tris.into_iter().map(|tri| (tri, l)));
            self.area.push((Emitter::Surfaces(material), AreaLight::Rect(rect)));
        }
        let plain =
            plain.into_iter().map(|tri| (tri, AreaLight::Triangle(tri, scene.material(tri).emission)));
        let textured = shining.into_iter().filter_map(|EmissiveTriangle { tri, density }| {
            Some((tri, AreaLight::TexturedTriangle(tri, density?)))
        });
        for (tri, light) in plain.chain(textured) {
            self.light_of.push((tri, self.area.len() as u32));
            self.area.push((Emitter::Surfaces(scene.material_id(tri)), light));
        }
        self.light_of.sort_unstable();
        self.emissive = begin..self.area.len();
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
            Self::Triangle(tri, _) | Self::TexturedTriangle(tri, _) => {
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
        let (radiance, area) = match self {
            Self::Rect(rect) => (rect.radiance.0, rect.area()),
            Self::TexturedRect(rect, _) => (rect.radiance.0, rect.area()),
            Self::Disk(disk) => (disk.radiance.0, disk.area()),
            Self::Sphere(sphere) => (sphere.radiance.0, sphere.area()),
            Self::Sun(_) | Self::Sky(_) => return 0.0,
            Self::Triangle(tri, radiance) => (radiance.0, scene.area(*tri)),
            Self::TexturedTriangle(tri, density) => return density.mean() * f64::from(scene.area(*tri)),
        };
        // In f64: the area of a small light times a small radiance leaves the range of f32.
        f64::from(luminance(radiance)) * f64::from(area)
    }
}
