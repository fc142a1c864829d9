//! Inspecting the light where the user clicks.

use crate::mesh::Mesh;
use crate::selection::Illumination;
use crate::solver::Solved;
use crate::task::Background;
use crate::wake::Wake;
use glam::{Vec2, Vec3};
use lumel::{Camera, Control, PointMeasurement, RayTracer, Scene, measure_points};
use lumel_accel::Ray;
use lumel_basis::PointReceivers;
use lumel_render_cpu::{Lens, View};
use lumel_scene::{Irradiance, SurfacePoint, TriId};
use std::sync::Arc;

/// A place on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// The place.
    pub at: SurfacePoint,
    /// Position, metres.
    pub position: Vec3,
    /// Unit normal on the lit side.
    pub normal: Vec3,
    /// The nearest vertex of the triangle.
    pub vertex: usize,
    /// Name of the object.
    pub object: String,
    /// Name of the material.
    pub material: String,
    /// Albedo.
    pub albedo: Vec3,
    /// Emitted radiance, W·m⁻²·sr⁻¹.
    pub emission: Vec3,
}

/// A spot with what is measured there.
pub struct Pick {
    /// The spot.
    pub spot: Spot,
    /// A fresh measurement at the spot, when there is one.
    pub measured: Option<PointMeasurement>,
    measuring: Option<Background<PointMeasurement>>,
    /// The solve that the measurement gathers.
    of: Option<Arc<Solved>>,
}

/// The lit surface that is seen at a point of the picture, 0..=1 from its top left.
pub fn spot(scene: &Scene, tracer: &dyn RayTracer, camera: &Camera, aspect: f32, at: Vec2) -> Option<Spot> {
    let ray = Lens::new(camera, aspect).ok()?.ray(at);
    // As in the picture, one looks through back faces.
    let dark = |_: SurfacePoint, _: Vec3| Irradiance::ZERO;
    View::new(scene, tracer, &dark).surface(ray).map(|at| spot_at(scene, at))
}

fn spot_at(scene: &Scene, at: SurfacePoint) -> Spot {
    let weights = at.bary.weights();
    let nearest = (0..3).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
    Spot {
        at,
        position: scene.position(at),
        normal: scene.shading_normal(at),
        vertex: scene.triangle(at.tri)[nearest] as usize,
        object: scene.object_names().get(scene.object_id(at.tri).0 as usize).cloned().unwrap_or_default(),
        material: scene.material(at.tri).name.clone(),
        albedo: scene.albedo(at).0,
        emission: scene.emission(at).0,
    }
}

impl Spot {
    /// The same place on the triangles that are shown now, if it is still there.
    pub fn on(&self, mesh: &Mesh) -> Option<Self> {
        let (along, tiny) = (self.normal, 1e-4 * mesh.scene.bounds().diagonal());
        let dark = |_: SurfacePoint, _: Vec3| Irradiance::ZERO;
        let ray = Ray::new(self.position + tiny * along, -along);
        View::new(&mesh.scene, &*mesh.tracer, &dark).surface(ray).map(|at| spot_at(&mesh.scene, at))
    }

    /// The stored light at the spot: each bounce that is known, W·m⁻².
    pub fn bounces(&self, scene: &Scene, light: &Illumination) -> Vec<Vec3> {
        light.bounces.iter().chain(&light.current).map(|values| self.value(scene, values)).collect()
    }

    /// A quantity of the vertices at the spot, linear over its triangle.
    pub fn value(&self, scene: &Scene, values: &[Vec3]) -> Vec3 {
        let corners = scene.triangle(self.at.tri);
        let weighted = corners.into_iter().zip(self.at.bary.weights());
        weighted.map(|(v, weight)| values.get(v as usize).copied().unwrap_or_default() * weight).sum()
    }

    /// The triangle.
    pub fn triangle(&self) -> TriId {
        self.at.tri
    }
}

impl Pick {
    /// A spot of which nothing is measured yet.
    pub fn new(spot: Spot) -> Self {
        Self { spot, measured: None, measuring: None, of: None }
    }

    /// Measures the light at the spot again, with its standard error, on a background thread; once per solve.
    ///
    /// Drops a measurement of a different solve.
    pub fn measure(&mut self, solved: Option<&Arc<Solved>>, wake: &Wake) {
        let same = match (&self.of, solved) {
            (Some(of), Some(solved)) => Arc::ptr_eq(of, solved),
            (None, None) => true,
            _ => false,
        };
        if same {
            return;
        }
        (self.of, self.measured, self.measuring) = (solved.cloned(), None, None);
        let (Some(solved), spot) = (solved.cloned(), self.spot.clone()) else { return };
        self.measuring = Some(Background::start("measuring", Arc::clone(wake), move || {
            let points = PointReceivers::on_surfaces(solved.baker.scene(), [(spot.at, spot.normal)])
                .map_err(|_| "the surface has no direction here".to_owned())?;
            measure_points(&solved.baker, &solved.state, &points, &Control::default())
                .map_err(|e| e.to_string())
        }));
    }

    /// Takes in a measurement that is done.
    pub fn poll(&mut self) {
        if let Some(result) = self.measuring.as_ref().and_then(Background::poll) {
            self.measuring = None;
            self.measured = result.ok();
        }
    }

    /// Whether a measurement is under way.
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_some()
    }
}
