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
use lumel_lightmap::Lightmap;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::io;
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
        for (k, channel) in ["R", "G", "B"].into_iter().enumerate() {
            let values = layer.values[lumels.clone()].iter().map(|value: &Vec3| value[k]).collect();
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
