//! What a camera can see: lit surfaces, rectangle lights and the sky.

use crate::names::named;
use crate::rect_light::VisibleLight;
use crate::relief::Relief;
use crate::ripple::Rippled;
use glam::Vec3;
use lumel_accel::{Hit, Layer, Ray, RayTracer};
use lumel_basis::Lighting;
use lumel_scene::{FaceSide, Radiance, Scene, SurfacePoint};

/// How many back faces a ray passes through before it is considered to see nothing.
const MAX_BACKS: u32 = 256;

/// How the back faces of one-sided surfaces appear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Backfaces {
    /// Invisible: the camera sees through them into a room from outside. They still block light.
    #[default]
    Through,
    /// Black: they emit and reflect nothing.
    Black,
}

named!(Backfaces, "look of back faces", Through = "through", Black = "black");

/// A lit scene, ready to be drawn.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The surfaces.
    pub scene: &'a Scene,
    /// A tracer over them.
    pub tracer: &'a dyn RayTracer,
    /// The light on them.
    pub lighting: &'a dyn Lighting,
    /// How the back faces of one-sided surfaces appear.
    pub backfaces: Backfaces,
    /// Which normals are shown, and how light on them is found.
    pub relief: Relief,
    /// Waves over some of the surfaces.
    pub ripple: Option<Rippled<'a>>,
}

/// What a camera ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sight {
    /// A side of a surface that reflects.
    Surface(SurfacePoint),
    /// A side that does not.
    Back,
    /// The sky.
    Nothing,
}

impl<'a> View<'a> {
    /// A view in which back faces of one-sided surfaces are invisible.
    pub fn new(scene: &'a Scene, tracer: &'a dyn RayTracer, lighting: &'a dyn Lighting) -> Self {
        Self {
            scene,
            tracer,
            lighting,
            backfaces: Backfaces::default(),
            relief: Relief::default(),
            ripple: None,
        }
    }

    /// The lit surface that a camera ray sees; rectangle lights are ignored.
    pub fn surface(&self, ray: Ray) -> Option<SurfacePoint> {
        match self.sight(ray).0 {
            Sight::Surface(at) => Some(at),
            Sight::Back | Sight::Nothing => None,
        }
    }

    /// What a camera ray hits, and the distance in lengths of its direction.
    pub(crate) fn sight(&self, mut ray: Ray) -> (Sight, f32) {
        let mut passed = 0.0;
        for _ in 0..MAX_BACKS {
            let Some(hit) = self.met(&ray) else { break };
            let t = passed + hit.t;
            if let Some(at) = self.scene.seen_side(hit.at, hit.side) {
                return (Sight::Surface(at), t);
            }
            if let Some(at) = self.front_beside(&hit) {
                return (Sight::Surface(at), t);
            }
            if self.backfaces == Backfaces::Black {
                return (Sight::Back, t);
            }
            passed = t;
            ray = self.beyond(&hit, &ray);
        }
        (Sight::Nothing, f32::INFINITY)
    }

    /// What a ray meets; of surfaces that light passes through, the first of which at least half is there.
    fn met(&self, ray: &Ray) -> Option<Hit> {
        if !self.tracer.is_see_through() {
            return self.tracer.closest_hit(ray);
        }
        let mut layers = Vec::new();
        self.tracer.layers(ray, &mut layers);
        layers.into_iter().find(|layer| opacity(layer) >= 0.5).map(|layer| layer.hit)
    }

    /// A ray behind the back face that it has met.
    fn beyond(&self, back: &Hit, ray: &Ray) -> Ray {
        Ray { origin: self.scene.ray_origin(back.at), ..*ray }.skipping(back.at.tri)
    }

    /// The lit surface that coincides with the back of a one-sided face: thin walls are often modelled as two
    /// coincident faces that face away from each other, and a ray may hit either first.
    fn front_beside(&self, back: &Hit) -> Option<SurfacePoint> {
        let (point, normal) = (self.scene.position(back.at), self.scene.geometric_normal(back.at.tri));
        let step = normal * self.scene.offset(back.at.tri);
        let (before, across) = (point - step, 2.0 * step);
        let segment = Ray { t_max: 1.0, ..Ray::new(before, across) }.skipping(back.at.tri);
        let hit = self.tracer.closest_hit(&segment)?;
        // Only faces that face the other way: neighbours across an edge do not hide it.
        let opposite = self.scene.geometric_normal(hit.at.tri).dot(normal) < -OPPOSITE_COS;
        (hit.side == FaceSide::Front && opposite).then_some(hit.at)
    }

    /// Radiance that arrives at the camera along a ray: `Le + ρE/π` of a surface, a rectangle light in front of it,
    /// or the sky.
    pub(crate) fn radiance(&self, lights: &[VisibleLight<'_>], ray: Ray) -> Radiance {
        if self.tracer.is_see_through() {
            return self.radiance_through_layers(lights, ray);
        }
        let (sight, t) = self.sight(ray);
        if let Some(radiance) = VisibleLight::nearest(lights, &ray, t) {
            return radiance;
        }
        match sight {
            Sight::Surface(at) => self.surface_radiance(at),
            Sight::Back => Radiance::ZERO,
            Sight::Nothing => self.scene.sky().radiance(ray.direction.normalize_or_zero()),
        }
    }

    /// The same where light passes through surfaces: each adds its share, and what is behind shines through.
    fn radiance_through_layers(&self, lights: &[VisibleLight<'_>], camera_ray: Ray) -> Radiance {
        let (mut sum, mut passed, mut layers) = (Vec3::ZERO, Vec3::ONE, Vec::new());
        let (mut ray, mut start) = (camera_ray, 0.0);
        for _ in 0..MAX_BACKS {
            self.tracer.layers(&ray, &mut layers);
            let mut blocking_back = None;
            for layer in &layers {
                let (hit, t) = (&layer.hit, start + layer.hit.t);
                if let Some(radiance) = VisibleLight::nearest(lights, &camera_ray, t) {
                    return Radiance(sum + passed * radiance.0);
                }
                let blocks = layer.transmittance == Vec3::ZERO;
                let beside = || if blocks { self.front_beside(hit) } else { None };
                if let Some(at) = self.scene.seen_side(hit.at, hit.side).or_else(beside) {
                    sum += passed * self.surface_radiance(at).0 * opacity(layer);
                } else if self.backfaces == Backfaces::Through {
                    blocking_back = blocks.then_some((*hit, t));
                    continue;
                }
                passed *= layer.transmittance;
            }
            let Some((back, t)) = blocking_back else { break };
            (ray, start) = (self.beyond(&back, &ray), t);
        }
        let behind = VisibleLight::nearest(lights, &camera_ray, f32::INFINITY);
        let sky = || self.scene.sky().radiance(camera_ray.direction.normalize_or_zero());
        Radiance(sum + passed * behind.unwrap_or_else(sky).0)
    }

    fn surface_radiance(&self, at: SurfacePoint) -> Radiance {
        self.scene.emission(at) + self.reflected(at)
    }

    /// The radiance that a surface reflects, `ρE/π`.
    pub(crate) fn reflected(&self, at: SurfacePoint) -> Radiance {
        self.irradiance(at).reflected(self.scene.albedo(at)).radiance()
    }
}

/// The share of rays that end at a layer.
fn opacity(layer: &Layer) -> f32 {
    1.0 - layer.transmittance.element_sum() / 3.0
}

/// Faces within 2.6° of opposite directions are the two sides of one wall.
const OPPOSITE_COS: f32 = 0.999;
