//! A renderer for all tests, and pictures side by side.

use glam::Vec3;
use lumel::Bvh;
use lumel_basis::{Lighting, Moment, VertexLighting};
use lumel_render_cpu::{
    Display, FalseColor, Legend, Picture, Relief, Resolution, Rippled, Scale, Show, ToneMapper, View,
};
use lumel_render_gpu::{Backdrop, Frame, Gpu, LightBuffer, Lit, Look, Model, Renderer, Samples};
use lumel_scene::{Camera, Light, RectLight, Scene};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};

/// The renderer that tests share; `None`, and a word about it, where there is no adapter.
pub(crate) fn renderer() -> Option<&'static Renderer> {
    static RENDERER: LazyLock<Option<Renderer>> = LazyLock::new(another_renderer);
    RENDERER.as_ref()
}

/// A renderer on a device of its own.
pub(crate) fn another_renderer() -> Option<Renderer> {
    match Gpu::headless() {
        Ok(gpu) => Some(Renderer::new(Arc::new(gpu))),
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            println!("skipped: no adapter");
            None
        }
    }
}

/// A scene with light on it, for both renderers.
pub(crate) struct Subject {
    pub(crate) scene: Scene,
    pub(crate) light: Vec<Vec3>,
    pub(crate) camera: Camera,
}

/// The same on the device.
pub(crate) struct Uploaded<'a> {
    pub(crate) renderer: &'a Renderer,
    pub(crate) subject: &'a Subject,
    pub(crate) model: Model,
    pub(crate) light: LightBuffer,
    pub(crate) rect_lights: Vec<RectLight>,
    pub(crate) backdrop: Option<Backdrop>,
}

impl Subject {
    pub(crate) fn rect_lights(&self) -> Vec<RectLight> {
        let rect_light = |light: &Light| match light {
            Light::Rect(rect_light) => Some(*rect_light),
            _ => None,
        };
        self.scene.lights().iter().filter_map(rect_light).collect()
    }

    pub(crate) fn on<'a>(&'a self, renderer: &'a Renderer) -> Uploaded<'a> {
        let model = renderer.upload(&self.scene).unwrap();
        let light = renderer.light(&model);
        renderer.set_light(&light, &self.scene, &self.lighting()).unwrap();
        let backdrop = renderer.backdrop(self.scene.sky(), None).unwrap();
        Uploaded { renderer, subject: self, model, light, rect_lights: self.rect_lights(), backdrop }
    }

    /// The light as it lies at the vertices.
    pub(crate) fn lighting(&self) -> VertexLighting<'_> {
        VertexLighting::new(&self.scene, &self.light).unwrap()
    }

    /// What the CPU draws with one sample per pixel.
    pub(crate) fn traced(&self, size: [u32; 2], look: Look) -> Picture {
        self.traced_under(&self.lighting(), size, look)
    }

    /// The same under other light.
    pub(crate) fn traced_under(
        &self,
        lighting: &dyn Lighting,
        [width, height]: [u32; 2],
        look: Look,
    ) -> Picture {
        self.traced_with(lighting, (Relief::default(), None), [width, height], look)
    }

    /// The same with other normals.
    pub(crate) fn traced_with(
        &self,
        lighting: &dyn Lighting,
        (relief, ripple): (Relief, Option<Rippled<'_>>),
        [width, height]: [u32; 2],
        look: Look,
    ) -> Picture {
        let tracer = Bvh::build(&self.scene);
        let view = View { relief, ripple, ..View::new(&self.scene, &tracer, lighting) };
        let resolution = Resolution { width, height, samples_per_pixel: 1 };
        lumel_render_cpu::draw(&view, &self.camera, &resolution, &display(look), &AtomicBool::new(false))
            .unwrap()
    }
}

impl Uploaded<'_> {
    pub(crate) fn frame(&self, look: Look) -> Frame<'_> {
        Frame {
            model: &self.model,
            camera: &self.subject.camera,
            light: Lit::One((&self.light).into()),
            rect_lights: &self.rect_lights,
            look,
            relief: Relief::default(),
            ripple: None,
            wireframe: false,
            grid: false,
            overlay: None,
            sky: self.subject.scene.sky().mean(),
            backdrop: self.backdrop.as_ref(),
        }
    }

    pub(crate) fn draw(&self, size: [u32; 2], samples: Samples, frame: &Frame<'_>) -> Picture {
        let target = self.renderer.target(size, samples).unwrap();
        self.renderer.draw(&target, frame);
        self.renderer.read(&target).unwrap()
    }

    pub(crate) fn show(&self, size: [u32; 2], samples: Samples, look: Look) -> Picture {
        self.draw(size, samples, &self.frame(look))
    }
}

fn display(look: Look) -> Display {
    let exposed = |show, stops, tone, white| Display {
        exposure: lumel_render_cpu::Exposure::Stops(stops),
        tone,
        white,
        ..Display::of(show)
    };
    match look {
        Look::Radiance { stops, tone, white } => exposed(Show::Radiance, stops, tone, white),
        Look::Irradiance { stops, tone, white } => exposed(Show::Irradiance, stops, tone, white),
        Look::Albedo => Display::of(Show::Albedo),
        Look::Normals => Display::of(Show::Normals),
        Look::FalseColor { range, scale } => Display {
            false_color: FalseColor { range: Some(range), scale, legend: Legend::Hidden },
            ..Display::of(Show::FalseColor)
        },
        Look::Vectors => Display::of(Show::Moment(Moment::Direction)),
        Look::Plain => panic!("the CPU has no plain look"),
    }
}

pub(crate) fn radiance(stops: f32, tone: ToneMapper) -> Look {
    Look::Radiance { stops, tone, white: ToneMapper::DEFAULT_WHITE }
}

pub(crate) fn irradiance(stops: f32) -> Look {
    Look::Irradiance { stops, tone: ToneMapper::default(), white: ToneMapper::DEFAULT_WHITE }
}

/// All looks that the CPU has too, radiance with every tone mapper.
pub(crate) fn looks(stops: f32, range: [f32; 2]) -> Vec<Look> {
    let mut looks: Vec<Look> = ToneMapper::ALL.iter().map(|tone| radiance(stops, *tone)).collect();
    let false_color = |scale| Look::FalseColor { range, scale };
    looks.extend([
        irradiance(stops),
        Look::Albedo,
        Look::Normals,
        false_color(Scale::Linear),
        false_color(Scale::Log),
    ]);
    looks
}

/// The largest difference of each pixel's channels.
pub(crate) fn differences(a: &Picture, b: &Picture) -> Vec<u8> {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()));
    let pairs = a.pixels().iter().zip(b.pixels());
    pairs.map(|(a, b)| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0)).collect()
}

/// The share of pixels that differ by more than `step`.
pub(crate) fn share_beyond(a: &Picture, b: &Picture, step: u8) -> f64 {
    let differences = differences(a, b);
    differences.iter().filter(|d| **d > step).count() as f64 / differences.len() as f64
}

/// Writes a picture where a person can look at it.
pub(crate) fn keep(name: &str, picture: &Picture) {
    let path = format!("{}/{name}.png", env!("CARGO_TARGET_TMPDIR"));
    write_png(&path, picture);
    println!("see {path}");
}

pub(crate) fn write_png(path: &str, picture: &Picture) {
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(picture.pixels().as_flattened()).unwrap();
}
