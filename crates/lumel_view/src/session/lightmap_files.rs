//! Lightmaps into files.

use super::Session;
use super::files::extension_of;
use crate::document::error_text;
use crate::prefs::ViewPrefs;
use crate::screenshot;
use lumel::{Lightmap, Scene, tracer_of};
use lumel_export::{LightmapTarget, Precision, write_lightmap_exr, write_lightmap_glb};
use lumel_render_cpu::{Display, Exposure, Resolution, Show, View, draw};
use lumel_scene::Camera;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The formats of lightmaps, by extension: pages, the mesh, a picture.
pub const LIGHTMAP_FORMATS: [&str; 3] = ["exr", "glb", "png"];

impl Session {
    /// Writes the lightmap: its pages (`.exr`), the mesh as it is in its files with its lightmap (`.glb`), or a picture of it
    /// from the camera (`.png`).
    ///
    /// # Errors
    /// When there is no finished lightmap, the name says no format, or the file is the scene itself.
    pub fn save_lightmap(&mut self, path: &Path, view: &ViewPrefs) -> Result<(), String> {
        let format = extension_of(path, &LIGHTMAP_FORMATS)?;
        self.refuse_sources(path)?;
        let light = self.lumel_light().and_then(|light| Some((light, light.lightmap()?)));
        let (Some((light, lightmap)), Some(document)) = (light, &self.document) else {
            return Err("there is no lightmap yet: choose it as the basis under Solve, and solve".to_owned());
        };
        let lightmap = Arc::clone(lightmap);
        let scene = view.relief.with_green_up(&light.layout.scene_like(document).into());
        let settings = self.computed().and_then(|computed| serde_json::to_string(computed.settings()?).ok());
        let settings = settings.unwrap_or_default();
        match format.as_str() {
            "exr" => self.write(path, "the lightmap", None, move |path| {
                write_pages(path, &lightmap, &scene, &settings)
            }),
            "glb" => self.write(path, "the mesh with its lightmap", None, move |path| {
                write_lightmap_glb(path, &scene, &lightmap, LightmapTarget::Any).map_err(|e| error_text(&e))
            }),
            _ => {
                let lit = document.relit(&self.lights)?;
                let scene = scene.relit(lit.lights().to_vec()).map_err(|e| error_text(&e))?;
                let (camera, display) = (self.camera.camera(), display(view));
                self.write(path, "a picture of the lightmap", None, move |path| {
                    write_picture(path, &lightmap, &scene, &camera, &display)
                });
            }
        }
        Ok(())
    }
}

fn write_pages(path: &Path, lightmap: &Lightmap, scene: &Scene, settings: &str) -> Result<(), String> {
    let pages = lightmap.atlas.pages().len();
    let attributes = [("scene", scene.name()), ("settings", settings)];
    let write = |page, path: &Path| write_lightmap_exr(path, lightmap, page, Precision::Float, &attributes);
    lumel_export::write_pages(path, pages, write).map_err(|e| error_text(&e))?;
    Ok(())
}

/// What a picture shows: all light, as the window shows it.
fn display(view: &ViewPrefs) -> Display {
    let exposure = if view.auto_exposure { Exposure::Auto } else { Exposure::Stops(view.stops) };
    Display { exposure, tone: view.tone(), white: view.white, ..Display::of(Show::Radiance) }
}

fn write_picture(
    path: &Path,
    lightmap: &Lightmap,
    scene: &Scene,
    camera: &Camera,
    display: &Display,
) -> Result<(), String> {
    let (tracer, lighting) = (tracer_of(scene), lightmap.lighting(0));
    let view = View::new(scene, &*tracer, &lighting);
    let picture = draw(&view, camera, &Resolution::default(), display, &AtomicBool::new(false))
        .map_err(|e| error_text(&e))?;
    let texts = [
        ("Title", scene.name().to_owned()),
        ("Software", concat!("lumel-view ", env!("CARGO_PKG_VERSION")).to_owned()),
    ];
    screenshot::save(path, &picture, &texts)
}
