//! Light that is kept to compare with.

use super::Session;
use crate::mesh::Mesh;
use crate::notice::Level;
use crate::selection::{Illumination, Layer, VertexValues};
use glam::Vec3;
use lumel::Scene;
use lumel_basis::{Coefficients, HARMONICS, VertexLighting};
use lumel_scene::{Barycentrics, SurfacePoint, TriId};
use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

/// Light that is kept to compare with.
pub struct Kept {
    /// What it is: sampler, rays and bounces, or a file.
    pub name: String,
    /// The light.
    pub light: Illumination,
    /// Tells it from others that had its place in the list.
    pub id: u64,
    /// The triangles that it is stored on.
    mesh: Mesh,
    /// The same light on other triangles, those that were asked for last.
    elsewhere: Mutex<Option<(Arc<Scene>, Illumination)>>,
}

/// How far the places at which light is read for vertices lie inside their triangles, as a share of the way to the middle.
const INSET: f32 = 1e-3;

impl Kept {
    /// The light at the vertices of a scene: as it is, or read from its own triangles where those are others.
    pub fn light_on(&self, scene: &Arc<Scene>) -> Cow<'_, Illumination> {
        if self.mesh.is_of(scene) {
            return Cow::Borrowed(&self.light);
        }
        let mut known = self.elsewhere.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.as_ref().filter(|(of, _)| of.geometry_hash() == scene.geometry_hash());
        let light = found.map_or_else(|| self.read_on(scene), |(_, light)| light.clone());
        *known = Some((Arc::clone(scene), light.clone()));
        Cow::Owned(light)
    }

    fn read_on(&self, scene: &Scene) -> Illumination {
        let mut corner_of = vec![None; scene.vertex_count()];
        for (tri, corners) in (0..).map(TriId).zip(scene.triangles()) {
            for (k, vertex) in corners.iter().enumerate() {
                corner_of[*vertex as usize].get_or_insert((tri, k));
            }
        }
        // Where each vertex lies on the triangles that have the light.
        let places: Vec<Option<SurfacePoint>> = corner_of
            .into_iter()
            .map(|corner| {
                let (tri, k) = corner?;
                let mut weights = [INSET / 3.0; 3];
                weights[k] += 1.0 - INSET;
                let bary = Barycentrics { u: weights[0], v: weights[1] };
                self.mesh.same_place(scene, SurfacePoint { tri, bary })
            })
            .collect();
        let own = &*self.mesh.scene;
        let read = |values: &VertexValues| -> VertexValues {
            let light = VertexLighting::new(own, values).ok();
            let at = |place: &Option<SurfacePoint>| light.zip(*place).map(|(light, at)| light.at(at).0);
            Arc::new(places.iter().map(|place| at(place).unwrap_or_default()).collect())
        };
        let read_directional = |light: &Arc<Coefficients>| {
            let n = light.kind().harmonics();
            let at = |place: &Option<SurfacePoint>| {
                let incident = place.and_then(|at| light.at(own, at));
                incident.map_or([Vec3::ZERO; HARMONICS], |incident| *incident.coefficients())
            };
            let values = places.iter().flat_map(|place| at(place).into_iter().take(n)).collect();
            Coefficients::new(light.kind(), values).map(Arc::new)
        };
        let is_valid = |place: &Option<SurfacePoint>| {
            let corners = place.map(|at| own.triangle(at.tri));
            corners.is_some_and(|corners| corners.iter().any(|&v| self.light.valid[v as usize]))
        };
        let valid =
            if self.light.valid.is_empty() { Vec::new() } else { places.iter().map(is_valid).collect() };
        Illumination {
            id: self.light.id,
            bounces: self.light.bounces.iter().map(read).collect(),
            current: None,
            tail: self.light.tail.as_ref().map(read),
            sum_only: self.light.sum_only.as_ref().map(read),
            valid: Arc::new(valid),
            standard_error: self.light.standard_error.as_ref().map(read),
            layers: self
                .light
                .layers
                .iter()
                .map(|layer| Layer {
                    values: read(&layer.values),
                    directional: layer.directional.as_ref().and_then(read_directional),
                    ..layer.clone()
                })
                .collect(),
            directional: self.light.directional.as_ref().and_then(read_directional),
            directional_before: None,
            points: None,
        }
    }
}

impl Session {
    /// Keeps the light to compare with.
    pub fn keep_light(&mut self) {
        if self.light.is_empty() {
            self.notices.push(Level::Warning, "There is no solution to keep yet: solve first");
            return;
        }
        let name = self.computed.as_ref().map_or_else(|| "unfinished".to_owned(), |c| c.label(&self.light));
        let Some(mesh) = self.document.as_ref().map(|document| document.mesh()) else { return };
        self.keep(name, self.light.clone(), mesh);
    }

    pub(super) fn keep(&mut self, name: String, light: Illumination, mesh: Mesh) {
        self.notices.push(Level::Info, format!("Kept for comparison: {name}"));
        self.kept.push(Kept { name, light, id: self.next_kept, mesh, elsewhere: Mutex::default() });
        self.next_kept += 1;
    }
}
