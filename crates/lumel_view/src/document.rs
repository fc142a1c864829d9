//! The open scene, with everything that is made from it once.

use crate::camera::FlyCamera;
use crate::emissive::{EmissiveMaterial, emissive_materials};
use crate::lights::{EditLight, default_name, shining};
use crate::mesh::{Given, Mesh};
use crate::selection::VertexValues;
use crate::sky::EditSky;
use crate::slots::Slots;
use glam::Vec3;
use lumel::{
    Baker, MaterialEntry, OpenOptions, Project, RayTracer, Scene, Settings, SettingsPatch, is_open, tracer_of,
};
use lumel_basis::Basis as _;
use lumel_render_cpu::camera_for;
use lumel_scene::{Light, TextureId};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Width over height of the view that a new scene is framed for; windows of other shapes show more of it or less.
const VIEWPORT_ASPECT: f32 = 4.0 / 3.0;

/// A scene to open.
#[derive(Clone, Debug, Default)]
pub struct OpenRequest {
    /// A file or a built-in scene.
    pub name: String,
    /// How to read it.
    pub options: OpenOptions,
}

impl OpenRequest {
    /// A scene with the default options.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), options: OpenOptions::default() }
    }

    /// What to call it in a title: the file's name.
    pub fn title(&self) -> String {
        let name = Path::new(&self.name).file_name();
        name.map_or_else(|| self.name.clone(), |name| name.to_string_lossy().into_owned())
    }
}

/// An open scene.
pub struct Document {
    /// How it was opened.
    pub request: OpenRequest,
    /// The project file that it comes from.
    pub project: Option<(PathBuf, Project)>,
    /// Its surfaces in the triangles that are shown, with the lights that it came with and the albedos that they have now.
    pub scene: Arc<Scene>,
    /// The albedo that each material came with.
    pub albedos: Vec<Vec3>,
    /// The sky that it came with.
    pub sky: EditSky,
    /// Its surfaces that emit light, by material, the strongest first.
    pub emissive: Vec<EmissiveMaterial>,
    /// Whether much of what its surfaces see above them is sky.
    pub is_outdoors: bool,
    /// The ray tracer of those triangles.
    pub tracer: Arc<dyn RayTracer>,
    /// What solves on them are made from; holds everything that depends only on the surfaces. While edges are split, and
    /// when that was stopped, it is still that of other triangles.
    pub baker: Arc<Baker>,
    /// The same for the triangles that the scene was opened with.
    pub opened: Arc<Baker>,
    /// What is refined where light needs it.
    pub given: Given,
    /// What decided which edges of the triangles that are shown were split.
    pub indicator: Option<VertexValues>,
    /// The view it opens with.
    pub home: FlyCamera,
    /// Warnings from reading it.
    pub warnings: Vec<String>,
    /// The longest edge that suited it, if edges were split without a length, metres.
    pub auto_edge: Option<f32>,
}

/// What a scene file says of the things that one edits.
pub struct Contents {
    /// Lights.
    pub lights: Vec<EditLight>,
    /// Settings of the bake; `None` unless it is a project that has some.
    pub settings: Option<Settings>,
    /// Numbered states.
    pub slots: Slots,
}

/// Opens a scene and builds what is needed to show it; takes seconds for large ones.
///
/// # Errors
/// What is wrong with it, with the name of the file.
pub fn open(request: &OpenRequest) -> Result<(Document, Contents), String> {
    let named = |error: &dyn std::error::Error| {
        let text = error_text(error);
        if text.contains(&request.name) { text } else { format!("{text}: {}", request.name) }
    };
    // Also where a project has its mesh follow light: what it then splits is read again when it is solved.
    let options = OpenOptions { adaptive: Some(false), ..request.options.clone() };
    let opened = lumel::open(&request.name, &options).map_err(|e| named(&e))?;
    let (scene, more) = opened.builder.build().map_err(|e| named(&e))?;
    let mut warnings = opened.warnings;
    warnings.append(more);
    let scene = Arc::new(scene);
    let tracer = tracer_of(&scene);
    let camera = camera_for(&scene, &*tracer, VIEWPORT_ASPECT);
    let baker = Baker::with_tracer(Arc::clone(&scene), Arc::clone(&tracer), Settings::default());
    // Found when it is first asked for; while nobody waits for light is the time for it.
    baker.basis().adjacency();
    let project = opened.project;
    let contents = Contents {
        lights: editable_lights(&scene, project.as_ref()),
        settings: project
            .as_ref()
            .map(Project::settings)
            .filter(|p| *p != SettingsPatch::default())
            .map(|p| p.settings()),
        slots: project.as_ref().map(|p| Slots::from_entries(&p.slots)).unwrap_or_default(),
    };
    let baker = Arc::new(baker);
    let asks_for_edges =
        request.options.max_edge.is_some() || project.as_ref().is_some_and(|p| p.max_edge.is_some());
    let is_split = opened.auto_edge.is_some_and(|auto| auto.length.is_some());
    let given = match is_split && !asks_for_edges {
        true => Given::InFile(request.clone()),
        false => Given::Known(Arc::clone(&baker)),
    };
    let document = Document {
        opened: Arc::clone(&baker),
        given,
        indicator: None,
        home: FlyCamera::from_camera(&camera).unwrap_or_default(),
        warnings: warnings.iter().map(ToString::to_string).collect(),
        auto_edge: opened.auto_edge.and_then(|auto| auto.length),
        sky: EditSky::of(scene.sky(), project.as_ref().map(|project| (Path::new(&request.name), project))),
        project: project.map(|project| (PathBuf::from(&request.name), project)),
        request: request.clone(),
        baker,
        albedos: albedos_of(&scene).collect(),
        emissive: emissive_materials(&scene),
        is_outdoors: is_open(&scene, &*tracer),
        scene,
        tracer,
    };
    Ok((document, contents))
}

/// The lights of a scene. Those of a project keep their names, and those that are off.
fn editable_lights(scene: &Scene, project: Option<&Project>) -> Vec<EditLight> {
    let mut shining = scene.lights().iter();
    let entries = project.map(|p| p.lights.as_slice()).unwrap_or_default();
    if entries.is_empty() {
        let given = |i: usize| scene.light_names()[i].clone();
        let unnamed = |i: usize| given(i) == format!("light {}", i + 1);
        let name = |i: usize| if unnamed(i) { default_name(i) } else { given(i) };
        return shining.enumerate().map(|(i, light)| EditLight::from_light(name(i), light)).collect();
    }
    let light = |(i, entry): (usize, &lumel::LightEntry)| {
        let texture = if entry.off { None } else { shining.next().and_then(texture_of) };
        EditLight::from_entry(i, entry, texture)
    };
    entries.iter().enumerate().map(light).collect()
}

fn texture_of(light: &Light) -> Option<TextureId> {
    if let Light::Rect(rect) = light { rect.texture } else { None }
}

/// The albedo of each material of a scene.
pub fn albedos_of(scene: &Scene) -> impl Iterator<Item = Vec3> + '_ {
    scene.materials().iter().map(|material| material.albedo)
}

/// An error and its causes in one line, without what the text before says already.
pub fn error_text(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    text
}

impl Document {
    /// The albedos that differ from those that the scene came with, as entries of a project.
    pub fn repainted_materials(&self) -> Vec<MaterialEntry> {
        let materials = self.scene.materials().iter().zip(&self.albedos);
        let changed = materials.filter(|(material, albedo)| material.albedo != **albedo);
        changed.map(|(m, _)| MaterialEntry { name: m.name.clone(), albedo: m.albedo }).collect()
    }

    /// Shows other triangles of the same surfaces.
    pub fn show(&mut self, mesh: &Mesh) {
        // Lights of the solve that it comes from are not those that the scene came with.
        self.scene = mesh.scene.lit_like(&self.scene).map_or_else(|_| Arc::clone(&mesh.scene), Arc::new);
        self.tracer = Arc::clone(&mesh.tracer);
        self.indicator.clone_from(&mesh.indicator);
    }

    /// The triangles that are shown.
    pub fn mesh(&self) -> Mesh {
        let (scene, tracer) = (Arc::clone(&self.scene), Arc::clone(&self.tracer));
        Mesh { scene, tracer, indicator: self.indicator.clone() }
    }

    /// Whether the baker is that of the triangles that are shown.
    pub fn has_baker(&self) -> bool {
        self.baker.scene().geometry_hash() == self.scene.geometry_hash()
    }

    /// The scene under these lights.
    ///
    /// # Errors
    /// A light that cannot be, such as one without area; says which.
    pub fn relit(&self, lights: &[EditLight]) -> Result<Arc<Scene>, String> {
        let scene = self.scene.relit(shining(lights)).map_err(|e| error_text(&e))?;
        let on = lights.iter().filter(|light| light.on).map(|light| light.name.clone());
        Ok(Arc::new(scene.with_light_names(on.collect())))
    }

    /// Whether the scene has any light source with these lights, emissive surfaces included.
    pub fn shines(&self, lights: &[EditLight]) -> bool {
        lights.iter().any(|light| light.on && light.brightness() > 0.0)
            || !self.scene.sky().is_zero()
            || !self.emissive.is_empty()
    }

    /// Length from corner to corner, metres: the scale of speeds and sizes.
    pub fn diagonal(&self) -> f32 {
        self.scene.bounds().diagonal().max(1e-6)
    }
}
