//! A picture that is kept.

use crate::common::{differences, radiance, renderer, write_png};
use crate::scenes;
use lumel_render_cpu::{Picture, ToneMapper};
use lumel_render_gpu::Samples;

const SIZE: [u32; 2] = [64, 48];

/// Drivers round differently.
const TOLERANCE: u8 = 2;

/// To look at the difference, or to accept the new picture, see the files that a failure writes beside the old one.
#[test]
fn all_that_a_scene_can_have_looks_as_it_did() {
    let Some(renderer) = renderer() else { return };
    let drawn = scenes::everything().on(renderer).show(SIZE, Samples::Four, radiance(0.25, ToneMapper::Agx));
    let path = |suffix: &str| format!("{}/tests/golden/everything{suffix}.png", env!("CARGO_MANIFEST_DIR"));
    let kept = read_png(&path(""));
    let differences = differences(&drawn, &kept);
    if differences.iter().any(|d| *d > TOLERANCE) {
        let visible = differences.iter().map(|d| [d.saturating_mul(32); 3]).collect();
        write_png(&path(".difference"), &Picture::new(SIZE[0], SIZE[1], visible).unwrap());
        write_png(&path(".new"), &drawn);
        let n = differences.iter().filter(|d| **d > TOLERANCE).count();
        panic!("{n} pixels differ by more than {TOLERANCE}: {}", path(".difference"));
    }
}

fn read_png(path: &str) -> Picture {
    let Ok(file) = std::fs::File::open(path) else {
        return Picture::new(SIZE[0], SIZE[1], vec![[0; 3]; (SIZE[0] * SIZE[1]) as usize]).unwrap();
    };
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels = bytes.as_chunks::<3>().0.to_vec();
    Picture::new(info.width, info.height, pixels).unwrap()
}
