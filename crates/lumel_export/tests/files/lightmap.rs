use crate::scenes::{colourful, plain};
use exr::prelude::*;
use glam::Vec3;
use lumel_export::{
    Array, ArrayData, ExportError, LightmapSolution, NpzReader, PngDepth, Precision, SolutionSelection,
    write_lightmap_exr, write_lightmap_png, write_npz,
};
use lumel_lightmap::{Lightmap, LightmapLayer};
use lumel_scene::Scene;
use lumel_uv::{Coverage, Density, Pace, UnwrapSettings, unwrap};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Three layers of numbers that differ everywhere, finished, on pages of 64 lumels.
pub(crate) fn lightmap_of(scene: &Scene) -> Lightmap {
    let settings =
        UnwrapSettings { density: Density::PerMetre(30.0), page_size: 64, ..UnwrapSettings::default() };
    let atlas = Arc::new(unwrap(scene, &settings, &|| Pace::Go).unwrap().atlas);
    let coverage = Coverage::new(&atlas);
    let mut valid = vec![false; atlas.lumel_count()];
    coverage.lumels().iter().for_each(|&lumel| valid[lumel as usize] = lumel % 11 > 0);
    let values = |scale: f32| -> Vec<Vec3> {
        let value = |lumel: usize| 0.001 + (lumel % 97) as f32 * 0.37 + (lumel / 64) as f32;
        (0..valid.len()).map(|lumel| Vec3::new(1.0, 0.8, 0.01) * value(lumel) * scale).collect()
    };
    let layer = |name: &str, scale| LightmapLayer { name: name.into(), values: values(scale) };
    let layers = vec![layer("irradiance", 1.0), layer("direct", 0.7), layer("größe 窓.001", 0.3)];
    let mut lightmap = Lightmap { atlas, valid, layers };
    lightmap.finish(scene, &coverage);
    lightmap
}

/// Size, channels by name, and the attribute with everything else.
fn read_exr(path: &Path) -> (Vec2<usize>, BTreeMap<String, FlatSamples>, serde_json::Value) {
    let image =
        read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let layer = image.from_file(path).unwrap().layer_data;
    let AttributeValue::Text(told) = &layer.attributes.other[&Text::from("lumel")] else { panic!("no text") };
    let told = serde_json::from_slice(told.as_slice()).unwrap();
    let name = |name: &Text| String::from_utf8(name.as_slice().to_vec()).unwrap();
    let channels = layer
        .channel_data
        .list
        .into_iter()
        .map(|channel| (name(&channel.name), channel.sample_data))
        .collect();
    (layer.size, channels, told)
}

#[test]
fn an_exr_image_has_every_layer_of_its_page_bit_by_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let lightmap = lightmap_of(&colourful());
    let atlas = &lightmap.atlas;
    assert!(atlas.pages().len() > 1);
    for (page, &[width, height]) in atlas.pages().iter().enumerate() {
        write_lightmap_exr(&path, &lightmap, page, Precision::Float, &[("preset", "draft")]).unwrap();
        let (size, channels, told) = read_exr(&path);
        assert_eq!(size, Vec2(width as usize, height as usize));
        assert_eq!(channels.len(), 10, "{:?}", channels.keys());
        let first = atlas.first_lumel(page);
        for (prefix, layer) in ["", "direct.", "größe 窓.001."].into_iter().zip(&lightmap.layers) {
            for (k, channel) in ["R", "G", "B"].into_iter().enumerate() {
                let FlatSamples::F32(read) = &channels[&format!("{prefix}{channel}")] else {
                    panic!("halfs")
                };
                assert!(read.iter().zip(&layer.values[first..]).all(|(read, value)| *read == value[k]));
            }
        }
        let valid = channels["valid"].values_as_f32();
        assert!(valid.zip(&lightmap.valid[first..]).all(|(read, &valid)| read == f32::from(u8::from(valid))));
        let identity = atlas.identity().to_hex();
        assert_eq!(
            told,
            json!({ "page": page, "lumels_per_metre": 30.0, "gutter": 2, "atlas": identity.as_str(), "preset": "draft" })
        );
    }
}

#[test]
fn half_precision_is_exact_to_one_part_in_2048() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let mut lightmap = lightmap_of(&plain("plain"));
    lightmap.layers[0].values[5] = Vec3::splat(1e6);
    write_lightmap_exr(&path, &lightmap, 0, Precision::Half, &[]).unwrap();
    let (_, channels, _) = read_exr(&path);
    assert!(matches!(channels["R"], FlatSamples::F16(_)));
    for (read, value) in channels["R"].values_as_f32().zip(&lightmap.layers[0].values) {
        assert!((read - value.x).abs() <= value.x / 2048.0 || value.x == 1e6 && read == 65504.0);
    }
}

#[test]
fn coefficients_of_higher_bands_are_shares_of_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let mut lightmap = lightmap_of(&plain("plain"));
    let n = lightmap.atlas.lumel_count();
    // Light of one direction, along y: as much as there can be in bands 1 and 2; in the first lumel none.
    let beam = |k: usize| [0.282_094_8, 0.488_602_5, 0.0, 0.0, 0.0, 0.0, -0.315_391_6, 0.0, -0.546_274_2][k];
    for k in 0..9 {
        let mut values = vec![Vec3::new(8.0, 4.0, 0.0) * beam(k); n];
        values[0] = Vec3::ZERO;
        lightmap.layers.push(LightmapLayer { name: LightmapLayer::of_harmonic(k), values });
    }
    write_lightmap_exr(&path, &lightmap, 0, Precision::Float, &[]).unwrap();
    let (_, channels, _) = read_exr(&path);
    let last = |channel: &str| channels[channel].values_as_f32().last().unwrap();
    let near = |channel: &str, expected: f32| {
        assert!((last(channel) - expected).abs() < 1e-5, "{channel}: {} {expected}", last(channel));
    };
    near("sh0.R", 8.0 * beam(0));
    near("sh1.R", 1.0);
    near("sh1.G", 1.0);
    near("sh1.B", 0.0);
    near("sh6.R", -0.5);
    near("sh8.G", -0.866_025_4);
    assert!(channels.keys().filter(|name| name.starts_with("sh")).count() == 27);
    assert!(channels["sh1.R"].values_as_f32().next().unwrap() == 0.0);
}

#[test]
fn equal_lightmaps_are_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let lightmap = lightmap_of(&colourful());
    let files = ["a.exr", "b.exr"].map(|name| {
        let path = folder.path().join(name);
        let attributes = [("a", "1"), ("b", "2"), ("c", "3")];
        write_lightmap_exr(&path, &lightmap, 0, Precision::Float, &attributes).unwrap();
        std::fs::read(path).unwrap()
    });
    assert!(files[0] == files[1]);
}

#[test]
fn a_png_image_of_16_bits_is_linear_and_says_its_scale() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let lightmap = lightmap_of(&colourful());
    for page in 0..lightmap.atlas.pages().len() {
        let scale = write_lightmap_png(&path, &lightmap, page, PngDepth::Sixteen).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let reader = png::Decoder::new(file).read_info().unwrap();
        let text = &reader.info().uncompressed_latin1_text[0];
        assert_eq!((&*text.keyword, text.text.parse()), ("irradiance of 65535", Ok(scale)));
        assert!(scale.log2().fract() == 0.0, "{scale}");
        let image::DynamicImage::ImageRgb16(image) = image::open(&path).unwrap() else {
            panic!("not 16 bits")
        };
        let first = lightmap.atlas.first_lumel(page);
        let values = &lightmap.layers[0].values[first..first + image.pixels().len()];
        let largest = values.iter().map(|value| value.max_element()).fold(0.0, f32::max);
        assert!(largest <= scale && 2.0 * largest > scale);
        for (pixel, value) in image.pixels().zip(values) {
            let read = Vec3::from(pixel.0.map(f32::from)) / 65535.0 * scale;
            assert!((read - value).abs().max_element() <= 0.51 * scale / 65535.0);
        }
    }
}

#[test]
fn lightmaps_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let good = lightmap_of(&plain("plain"));
    let refused = |lightmap: &Lightmap, page, problem: &str| {
        let written = write_lightmap_exr(&path, lightmap, page, Precision::Float, &[]);
        for error in
            [written.unwrap_err(), write_lightmap_png(&path, lightmap, page, PngDepth::Sixteen).unwrap_err()]
        {
            assert!(matches!(error, ExportError::Content { .. }));
            assert!(error.to_string().starts_with(problem), "{error}");
        }
    };
    refused(&good, 1, "the lightmap has no page 1");
    refused(&Lightmap { layers: Vec::new(), ..good.clone() }, 0, "the lightmap has no light");
    refused(&Lightmap { valid: vec![true; 3], ..good.clone() }, 0, "validity of 3 lumels");
    let mut bad = good.clone();
    bad.layers[1].values[2].y = f32::NAN;
    refused(&bad, 0, "\"direct\" is not finite at lumel (2, 0) of page 0");
    bad.layers[1].values.pop();
    refused(&bad, 0, "\"direct\" has ");
    let mut twice = good.clone();
    twice.layers[2].name = "direct".into();
    let error = write_lightmap_exr(&path, &twice, 0, Precision::Float, &[]).unwrap_err();
    assert!(error.to_string().starts_with("two layers are called \"direct\""), "{error}");
    assert!(!path.exists());
}

#[test]
fn a_lightmap_is_read_as_it_was_written_and_knows_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let scene = colourful();
    let saved = LightmapSolution::new(&scene, json!({ "seed": 3 }), lightmap_of(&scene));
    saved.save(&path).unwrap();
    assert!(LightmapSolution::is_file(&path));
    let loaded = LightmapSolution::load(&path).unwrap();
    assert_eq!(loaded.lightmap.atlas, saved.lightmap.atlas);
    assert_eq!(loaded.lightmap.layers, saved.lightmap.layers);
    assert_eq!(loaded.lightmap.valid, saved.lightmap.valid);
    assert!(loaded.same_lumels_as(&saved) && loaded.has_lighting_of(&scene));
    assert_eq!(loaded.meta.settings, json!({ "seed": 3 }));
    loaded.check_belongs_to(&scene).unwrap();
    assert!(loaded.check_belongs_to(&plain("other")).is_err());
    let layer = |selection| loaded.layer(&selection).map_err(|error| error.to_string());
    assert_eq!(layer(SolutionSelection::Sum), Ok(0));
    assert_eq!(layer(SolutionSelection::Bounce(0)), Ok(1));
    assert!(layer(SolutionSelection::Bounce(1)).unwrap_err().contains("no bounce 1; it has 1"));
    assert_eq!(layer(SolutionSelection::Layer("größe 窓.001".into())), Ok(2));
    assert!(layer(SolutionSelection::Layer("sun".into())).unwrap_err().contains("größe 窓.001"));
}

/// An array to be damaged.
type Damage = fn(&mut ArrayData);

#[test]
fn lightmaps_that_do_not_hold_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, bad] = ["a.npz", "b.npz"].map(|name| folder.path().join(name));
    let scene = colourful();
    LightmapSolution::new(&scene, json!({}), lightmap_of(&scene)).save(&whole).unwrap();
    let damages: [(&str, Damage, &str); 8] = [
        ("charts", |a| set(a, 0, u32::MAX), "chart 4294967295"),
        ("chart_places", |a| set(a, 1, 77), "outside of its page"),
        ("chart_places", |a| set(a, 4, u32::MAX), "outside of its page"),
        ("pages", |a| set(a, 0, 0), "no lumels"),
        ("pages", |a| set(a, 0, u32::MAX), "no lumels, or all have too many"),
        ("pages", |a| set(a, 0, 65), "an atlas of"),
        ("corners", |a| set(a, 5, f32::NAN.to_bits()), "triangle 0 lies outside"),
        ("irradiance", |a| set(a, 7, f32::INFINITY.to_bits()), "not finite"),
    ];
    for (name, damage, problem) in damages {
        let mut npz = NpzReader::open(&whole).unwrap();
        let names = npz.names();
        write_npz(&bad, |out| {
            for member in names.iter().filter(|member| *member != "meta.json") {
                let Array { shape, mut data } = npz.array(member).unwrap();
                if member == name {
                    damage(&mut data);
                }
                out.array(member, &Array { shape, data })?;
            }
            out.bytes("meta.json", &npz.bytes("meta.json").unwrap())
        })
        .unwrap();
        let error = LightmapSolution::load(&bad).unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains("b.npz"), "{name}: {error}");
    }
}

/// Replaces one number by the one with these bits.
fn set(data: &mut ArrayData, at: usize, bits: u32) {
    match data {
        ArrayData::U32(values) => values[at] = bits,
        ArrayData::F32(values) => values[at] = f32::from_bits(bits),
        _ => panic!("no such numbers"),
    }
}
