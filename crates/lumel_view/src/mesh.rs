//! Meshes of the open scene: as it was opened, or with edges split where light needs it.

use crate::document::{OpenRequest, error_text};
use crate::selection::VertexValues;
use glam::Vec3;
use lumel::{Baker, MaxEdge, OpenOptions, RayTracer, Scene, Settings};
use lumel_accel::{Ray, Refined};
use lumel_render_cpu::View;
use lumel_scene::{Irradiance, SurfacePoint};
use std::sync::Arc;

/// A mesh that light is, or can be, stored on.
#[derive(Clone)]
pub struct Mesh {
    /// The surfaces.
    pub scene: Arc<Scene>,
    /// Their ray tracer.
    pub tracer: Arc<dyn RayTracer>,
    /// What decided which edges were split: see [`lumel::Refining::indicator`].
    pub indicator: Option<VertexValues>,
}

impl Mesh {
    /// That of a baker.
    pub fn of(baker: &Baker) -> Self {
        Self { scene: Arc::clone(baker.scene()), tracer: Arc::clone(baker.tracer()), indicator: None }
    }

    /// That of a baker with these edges split, none of which is yet.
    ///
    /// # Errors
    /// Edges that there are none of.
    pub fn refined(given: &Baker, splits: &[[u32; 2]]) -> Result<Self, String> {
        let scene = given.scene().refined(splits).map_err(|e| error_text(&e))?;
        let tracer = Arc::new(Refined::new(Arc::clone(given.tracer()), scene.clone()));
        Ok(Self { scene: Arc::new(scene), tracer, indicator: None })
    }

    /// The point of this mesh at a point of another one of the same surfaces.
    pub fn same_place(&self, other: &Scene, at: SurfacePoint) -> Option<SurfacePoint> {
        let dark = |_: SurfacePoint, _: Vec3| Irradiance::ZERO;
        let ray = Ray::new(other.ray_origin(at), -other.geometric_normal(at.tri));
        View::new(&self.scene, &*self.tracer, &dark).surface(ray)
    }

    /// Whether it has the triangles of a scene.
    pub fn is_of(&self, scene: &Scene) -> bool {
        self.scene.geometry_hash() == scene.geometry_hash()
    }
}

/// The mesh whose edges are split where light needs it.
#[derive(Clone)]
pub enum Given {
    /// It was read.
    Known(Arc<Baker>),
    /// It is that of the files, of which the open one was split evenly.
    InFile(OpenRequest),
}

impl Given {
    /// The mesh, with the lights and materials that `open` has.
    ///
    /// # Errors
    /// A file that cannot be read, or has changed.
    pub fn read(&self, open: &Scene) -> Result<Arc<Baker>, String> {
        let request = match self {
            Self::Known(baker) => {
                let (scene, settings) = (lit_like(baker.scene(), open)?, baker.settings().clone());
                return Ok(Arc::new(baker.relit(scene, settings)));
            }
            Self::InFile(request) => request,
        };
        let options = OpenOptions { max_edge: Some(MaxEdge::Off), ..request.options.clone() };
        let opened = lumel::open(&request.name, &options).map_err(|e| error_text(&e))?;
        let scene = opened.builder.build().map_err(|e| error_text(&e))?.0;
        let same =
            scene.object_names() == open.object_names() && scene.materials().len() == open.materials().len();
        if !same {
            return Err(format!("the file has changed; reload the scene: {}", request.name));
        }
        Ok(Arc::new(Baker::new(lit_like(&scene, open)?, Settings::default())))
    }
}

/// A scene with the lights, the sky and the albedos of another one of the same materials.
///
/// # Errors
/// Lights that cannot be.
pub fn lit_like(scene: &Scene, other: &Scene) -> Result<Arc<Scene>, String> {
    let albedos: Vec<_> = other.materials().iter().map(|material| material.albedo).collect();
    scene.repainted(&albedos).lit_like(other).map(Arc::new).map_err(|e| error_text(&e))
}
