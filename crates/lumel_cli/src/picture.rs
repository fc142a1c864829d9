//! Images as PNG files.

use anyhow::Context;
use lumel::{Camera, Lighting, RayTracer, Scene};
use lumel_export::write_png;
use lumel_render_cpu::{Display, Picture, Relief, Resolution, View, camera_for, draw};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The default size, pixels.
const DEFAULT_SIZE: [u32; 2] = [960, 720];

/// What to draw.
pub(crate) struct Subject<'a> {
    /// The surfaces.
    pub(crate) scene: &'a Scene,
    /// A tracer over them.
    pub(crate) tracer: &'a dyn RayTracer,
    /// The light on them.
    pub(crate) lighting: &'a dyn Lighting,
    /// The viewpoint.
    pub(crate) camera: &'a Camera,
    /// Which normals are shown.
    pub(crate) relief: Relief,
}

/// Draws and writes a picture.
pub(crate) fn write(
    path: &Path,
    subject: &Subject<'_>,
    resolution: &Resolution,
    display: &Display,
    cancel: &AtomicBool,
) -> anyhow::Result<Picture> {
    let view = View { relief: subject.relief, ..View::new(subject.scene, subject.tracer, subject.lighting) };
    let picture = draw(&view, subject.camera, resolution, display, cancel)
        .with_context(|| format!("cannot draw {}", path.display()))?;
    let comment = describe(subject, display, &picture);
    let texts = [
        ("Title", subject.scene.name()),
        ("Software", concat!("lumel ", env!("CARGO_PKG_VERSION"))),
        ("Comment", &comment),
    ];
    // A PNG text ends at a zero byte.
    let texts = texts.map(|(key, text)| (key, text.replace('\0', " ")));
    let texts = texts.each_ref().map(|(key, text)| (*key, text.as_str()));
    write_png(path, picture.width(), picture.height(), picture.pixels(), &texts)?;
    Ok(picture)
}

/// Draws and writes the image of a bake.
pub(crate) fn write_default(
    path: &Path,
    scene: &Scene,
    tracer: &dyn RayTracer,
    lighting: &dyn Lighting,
    cancel: &AtomicBool,
) -> anyhow::Result<()> {
    let [width, height] = DEFAULT_SIZE;
    let resolution = Resolution::new(width, height);
    let camera = camera_for(scene, tracer, resolution.aspect());
    let subject = Subject { scene, tracer, lighting, camera: &camera, relief: Relief::default() };
    write(path, &subject, &resolution, &Display::default(), cancel)?;
    Ok(())
}

fn describe(subject: &Subject<'_>, display: &Display, picture: &Picture) -> String {
    let mut text = format!("{}, camera {}", display.show, subject.camera.name);
    if let Some(stops) = picture.stops() {
        text += &format!(", exposure {stops} EV, tone {}", display.tone);
    }
    if let Some([lo, hi]) = picture.range() {
        text += &format!(", {lo} to {hi} W/m2");
    }
    text
}
