//! Rays, samples and pixels.

use crate::display::{albedo_pixel, normal_pixel};
use crate::exposure::meter;
use crate::false_color::covered;
use crate::legend::draw_legend;
use crate::rect_light::VisibleLight;
use crate::{Display, Exposure, Legend, Lens, Picture, PictureError, Resolution, Show, View};
use glam::{DVec3, Vec2, Vec3};
use lumel_basis::Moment;
use lumel_sample::{Dim, Sampler, SamplerKind, StreamKey};
use lumel_scene::{Camera, luminance};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the samples of a pixel add up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Mean {
    /// Mean of all samples; those that saw nothing count as zero.
    value: Vec3,
    /// Share of the samples that saw something.
    coverage: f32,
}

/// Draws what a camera sees, on the caller's rayon pool; the pixels do not depend on the number of threads.
///
/// Samples are averaged in linear light over the square of each pixel, with equal weights and without clipping, before
/// the display transform: see [`Show`] for the formulas.
///
/// # Errors
/// Invalid sizes and settings, a camera without a view, and [`PictureError::Cancelled`] soon after `cancel` is
/// set.
pub fn draw(
    view: &View<'_>,
    camera: &Camera,
    resolution: &Resolution,
    display: &Display,
    cancel: &AtomicBool,
) -> Result<Picture, PictureError> {
    resolution.check()?;
    display.check()?;
    let lens = Lens::new(camera, resolution.aspect())?;
    let stops = match (display.show.is_exposed(), display.exposure) {
        (false, _) => None,
        (true, Exposure::Stops(stops)) => Some(stops),
        (true, Exposure::Auto) => Some(meter(view, camera, resolution.aspect())?),
    };
    let means = trace(view, &lens, resolution, display.show, cancel)?;
    let to_pixels = |to_pixel: &(dyn Fn(&Mean) -> [u8; 3] + Sync)| means.par_iter().map(to_pixel).collect();
    let finish = |pixels| Picture::new(resolution.width, resolution.height, pixels);
    match display.show {
        Show::Radiance | Show::Irradiance => {
            let pixels = to_pixels(&|mean| display.light_pixel(stops.unwrap_or(0.0), mean.value));
            finish(pixels).map(|picture: Picture| picture.exposed(stops))
        }
        Show::Albedo => finish(to_pixels(&|mean| albedo_pixel(mean.value))),
        Show::Normals | Show::Moment(Moment::Direction) => {
            finish(to_pixels(&|mean| normal_pixel(mean.value)))
        }
        Show::FalseColor | Show::Moment(_) => {
            let settings = display.false_color;
            let covered_means = means.iter().filter(|mean| mean.coverage > 0.0);
            let luminances = covered_means.map(Mean::luminance_of_covered).collect();
            let range = match display.show {
                Show::Moment(_) => settings.signed_range_for(luminances),
                _ => settings.range_for(luminances),
            };
            let pixels = to_pixels(&|mean| {
                covered(settings.scale.position(mean.luminance_of_covered(), range), mean.coverage)
            });
            let mut picture = finish(pixels)?.ranged(range);
            if settings.legend == Legend::Drawn {
                draw_legend(&mut picture.canvas(), range, settings.scale);
            }
            Ok(picture)
        }
    }
}

impl Mean {
    fn luminance_of_covered(&self) -> f32 {
        luminance(self.value) / self.coverage
    }
}

/// The means of all pixels, row by row.
fn trace(
    view: &View<'_>,
    lens: &Lens,
    resolution: &Resolution,
    show: Show,
    cancel: &AtomicBool,
) -> Result<Vec<Mean>, PictureError> {
    let (width, height) = (resolution.width as usize, resolution.height as usize);
    let lights = VisibleLight::all_of(view.scene);
    let offsets = Offsets::new(resolution.samples_per_pixel);
    let size = Vec2::new(width as f32, height as f32);
    let mean = |pixel: usize| {
        let corner = Vec2::new((pixel % width) as f32, (pixel / width) as f32);
        let (mut sum, mut seen) = (DVec3::ZERO, 0);
        for offset in offsets.of_pixel(pixel) {
            if let Some(value) = show.sample(view, &lights, lens.ray((corner + offset) / size)) {
                sum += value.as_dvec3();
                seen += 1;
            }
        }
        let n = f64::from(resolution.samples_per_pixel);
        Mean { value: (sum / n).as_vec3(), coverage: (f64::from(seen) / n) as f32 }
    };
    let mut means = vec![Mean::default(); width * height];
    means.par_chunks_mut(width).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            if cancel.load(Ordering::Relaxed) {
                return;
            }
            *pixel = mean(row * width + column);
        }
    });
    if cancel.load(Ordering::Relaxed) { Err(PictureError::Cancelled) } else { Ok(means) }
}

/// Where in a pixel its samples lie, 0..1 from its top left.
struct Offsets {
    sampler: Sampler,
    count: u32,
}

impl Offsets {
    fn new(count: u32) -> Self {
        Self { sampler: SamplerKind::Sobol.for_count(count), count }
    }

    fn of_pixel(&self, pixel: usize) -> impl Iterator<Item = Vec2> {
        // The largest picture has fewer pixels than a key has numbers.
        let stream = self.sampler.stream(StreamKey::new(0).element(pixel as u32), Dim::Pixel);
        let count = self.count;
        let offset = move |i| if count == 1 { Vec2::splat(0.5) } else { Vec2::from(stream.sample_2d(i)) };
        (0..count).map(offset)
    }
}
