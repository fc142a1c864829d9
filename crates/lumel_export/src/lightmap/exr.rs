//! Pages as OpenEXR images.

use super::{check, lumels_of};
use crate::{ExportError, write_atomically};
use ::exr::error::Error;
use ::exr::image::write::WritableImage as _;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, Text, f16,
};
use glam::Vec3;
use lumel_basis::band_of;
use lumel_lightmap::Lightmap;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::io;
use std::ops::Range;
use std::path::Path;

/// How exact the numbers of an image are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits: as computed.
    #[default]
    Float,
    /// 16 bits: to one part in 2048, and 65504 at most.
    Half,
}

/// Writes a page of a lightmap as an OpenEXR image, atomically.
///
/// The first layer is in channels `R`, `G` and `B`, irradiance in W·m⁻² (lux if the lights are photometric), linear
/// Rec. 709; each other one in three channels below its name, such as `direct.R`. `valid` is 1 where light was measured, and
/// 0 where it comes from other lumels. Compressed without loss.
///
/// Light by direction is in `sh0`, the coefficient of band 0 of incident radiance, W·m⁻², and in `sh1` to `sh3`, or to `sh8`,
/// which are divided by it and by √(2l + 1): 1 at most, and −1 at least. They are those of real spherical harmonics in world space
/// in the order of [`Harmonics`](lumel_basis::Harmonics).
///
/// The attribute `lumel` is a JSON object with the page, lumels per metre, gutter and hash of the atlas, and `attributes`.
///
/// # Errors
/// A page that there is not, light that is not finite, two layers of one name, and the errors of [`write_atomically`].
pub fn write_lightmap_exr(
    path: &Path,
    lightmap: &Lightmap,
    page: usize,
    precision: Precision,
    attributes: &[(&str, &str)],
) -> Result<(), ExportError> {
    let lumels = lumels_of(path, lightmap, page)?;
    check(path, lightmap)?;
    let samples = |values: Vec<f32>| match precision {
        Precision::Float => FlatSamples::F32(values),
        Precision::Half => {
            FlatSamples::F16(values.into_iter().map(|x| f16::from_f32(x.min(f16::MAX.to_f32()))).collect())
        }
    };
    let mut channels = Vec::with_capacity(3 * lightmap.layers.len() + 1);
    let mut names = BTreeSet::new();
    for (i, layer) in lightmap.layers.iter().enumerate() {
        let prefix = if i == 0 { String::new() } else { format!("{}.", layer.name) };
        if !names.insert(prefix.clone()) {
            return Err(ExportError::content(path, format!("two layers are called \"{}\"", layer.name)));
        }
        let shares = shares(lightmap, i, lumels.clone());
        let written = shares.as_deref().unwrap_or(&layer.values[lumels.clone()]);
        for (k, channel) in ["R", "G", "B"].into_iter().enumerate() {
            let values = written.iter().map(|value: &Vec3| value[k]).collect();
            channels.push(AnyChannel::new(text(&format!("{prefix}{channel}")), samples(values)));
        }
    }
    let valid = lightmap.valid[lumels].iter().map(|&valid| if valid { 1.0 } else { 0.0 }).collect();
    channels.push(AnyChannel::new("valid", samples(valid)));
    let [width, height] = lightmap.atlas.pages()[page].map(|side| side as usize);
    let image = Image::from_layer(Layer::new(
        (width, height),
        described(lightmap, page, attributes),
        Encoding {
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        },
        AnyChannels::sort(channels.into()),
    ));
    write_atomically(path, |out| {
        image.write().non_parallel().to_buffered(out).map_err(|error| match error {
            Error::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
    })
}

/// A coefficient of a higher band as a share of that of band 0, which is at most one; `None` for all other layers.
fn shares(lightmap: &Lightmap, layer: usize, lumels: Range<usize>) -> Option<Vec<Vec3>> {
    let layers = &lightmap.layers;
    let band = band_of(layers[layer].harmonic()?);
    let base = layers.iter().find(|layer| layer.harmonic() == Some(0)).filter(|_| band > 0)?;
    let most = (2.0 * band as f32 + 1.0).sqrt();
    let share = |lumel: usize| {
        let (value, base) = (layers[layer].values[lumel], base.values[lumel]);
        let share = value / (most * base);
        Vec3::select(base.cmpgt(Vec3::ZERO), share, Vec3::ZERO).clamp(Vec3::NEG_ONE, Vec3::ONE)
    };
    Some(lumels.map(share).collect())
}

fn described(lightmap: &Lightmap, page: usize, attributes: &[(&str, &str)]) -> LayerAttributes {
    let mut told = json!({
        "page": page,
        "lumels_per_metre": lightmap.atlas.density(),
        "gutter": lightmap.atlas.gutter(),
        "atlas": lightmap.atlas.identity().to_hex().as_str(),
    });
    if let Some(told) = told.as_object_mut() {
        told.extend(
            attributes
                .iter()
                .map(|(name, value)| (name.to_string(), json!(value)))
                .collect::<Map<_, Value>>(),
        );
    }
    let mut layer = LayerAttributes {
        comments: Some(text("irradiance, W/m^2 (lux if the lights are photometric), linear Rec. 709")),
        software_name: Some(text(concat!("lumel ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    // More than one would be written in any order.
    layer.other.insert(text("lumel"), ::exr::meta::attribute::AttributeValue::Text(text(&told.to_string())));
    layer
}

/// OpenEXR takes UTF-8.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}
