//! Decoding of image files into textures.

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use lumel_scene::{Encoding, Filter, Texture, TextureId, Wrap};
use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::io::Cursor;
use std::mem::discriminant;
use std::path::{Path, PathBuf};

/// The largest width and height of an image, texels.
const MAX_SIDE: u32 = 32_768;
/// The most memory an image may take while it is decoded and as a texture, bytes: 16,384² texels of RGBA.
const MAX_BYTES: u64 = 1 << 30;
/// The most memory the images of a file may take together as textures, bytes: 64 of 4096² texels of RGBA.
const MAX_TOTAL_BYTES: u64 = 4 << 30;
/// Image formats that can be read, for messages.
const FORMATS: &str = "png, jpeg, tga, bmp, hdr, exr, tiff or webp";

/// Why an image cannot be used as a texture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// The file cannot be read.
    #[error("cannot read image {name}: {problem}")]
    Read {
        /// The image.
        name: String,
        /// The error of the operating system.
        problem: String,
    },
    /// Its format is not supported.
    #[error("image {name} is in no known format; convert it to {FORMATS}")]
    UnknownFormat {
        /// The image.
        name: String,
    },
    /// It is damaged or uses an unsupported variant of its format.
    #[error("cannot decode image {name}: {problem}")]
    Decode {
        /// The image.
        name: String,
        /// The error of the decoder.
        problem: String,
    },
    /// It would take too much memory.
    #[error("image {name} has {width} x {height} texels, more than lumel reads; scale it down")]
    TooLarge {
        /// The image.
        name: String,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
    },
    /// The images of the file would take too much memory together.
    #[error(
        "image {name} with {width} x {height} texels does not fit the {limit} bytes that lumel reads of all images of \
         a file together; scale images down"
    )]
    TooLargeTogether {
        /// The image.
        name: String,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// The limit, bytes.
        limit: u64,
    },
}

/// Reads an image file.
///
/// `encoding` applies to integer images: [`Encoding::Srgb`] for colours, [`Encoding::Linear`] for normals and
/// other data. Floating-point images (HDR, EXR, float TIFF) are always linear. Channels of 16 bits are rounded to 8.
///
/// # Errors
/// See [`TextureError`].
pub fn load_texture(path: &Path, encoding: Encoding) -> Result<Texture, TextureError> {
    read_texture(path, encoding, &mut Budget::default())
}

/// As [`load_texture`], within a budget.
pub(crate) fn read_texture(
    path: &Path,
    encoding: Encoding,
    budget: &mut Budget,
) -> Result<Texture, TextureError> {
    into_texture(decode_file(path, budget)?, &path.display().to_string(), encoding)
}

/// Decodes an image file within a budget.
pub(crate) fn decode_file(path: &Path, budget: &mut Budget) -> Result<DynamicImage, TextureError> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path)
        .map_err(|error| TextureError::Read { name: name.clone(), problem: error.to_string() })?;
    decode_image(&bytes, &name, path.extension().and_then(|e| e.to_str()), budget)
}

/// The MIME type of an image that glTF files may hold as it is, if the header of these bytes is that of one.
pub(crate) fn encoded_type(bytes: &[u8]) -> Option<&'static str> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let mime_type = match reader.format()? {
        ImageFormat::Png => "image/png",
        ImageFormat::Jpeg => "image/jpeg",
        _ => return None,
    };
    reader.into_dimensions().is_ok().then_some(mime_type)
}

/// The memory that is left for the images of a file.
#[derive(Debug)]
pub(crate) struct Budget {
    limit: u64,
    left: u64,
}

impl Budget {
    /// A budget of so many bytes.
    fn of(limit: u64) -> Self {
        Self { limit, left: limit }
    }
}

impl Default for Budget {
    fn default() -> Self {
        Self::of(MAX_TOTAL_BYTES)
    }
}

/// Decodes an image in memory; `name` is for messages and becomes the texture's name, `extension` is used
/// if the content does not determine the format. What the texture takes is subtracted from the budget.
///
/// # Errors
/// See [`TextureError`].
pub(crate) fn decode(
    bytes: &[u8],
    name: &str,
    extension: Option<&str>,
    encoding: Encoding,
    budget: &mut Budget,
) -> Result<Texture, TextureError> {
    into_texture(decode_image(bytes, name, extension, budget)?, name, encoding)
}

fn decode_image(
    bytes: &[u8],
    name: &str,
    extension: Option<&str>,
    budget: &mut Budget,
) -> Result<DynamicImage, TextureError> {
    let by_extension = extension.and_then(ImageFormat::from_extension).filter(ImageFormat::reading_enabled);
    let by_content = image::guess_format(bytes).ok().filter(ImageFormat::reading_enabled);
    // TGA has no magic number, so there the extension comes first; elsewhere extensions are often wrong.
    let candidates = match by_extension {
        Some(ImageFormat::Tga) => [by_extension, by_content],
        _ => [by_content, by_extension.filter(|_| by_content.is_none())],
    };
    let mut first_error = None;
    for format in candidates.into_iter().flatten() {
        match decode_as(bytes, name, format, budget) {
            Ok(image) => return Ok(image),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    Err(first_error.unwrap_or_else(|| TextureError::UnknownFormat { name: name.to_owned() }))
}

fn decode_as(
    bytes: &[u8],
    name: &str,
    format: ImageFormat,
    budget: &mut Budget,
) -> Result<DynamicImage, TextureError> {
    let failed =
        |error: image::ImageError| TextureError::Decode { name: name.to_owned(), problem: error.to_string() };
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| match (&error, dimensions(bytes, format)) {
        (image::ImageError::Limits(_), Some((width, height))) => {
            TextureError::TooLarge { name: name.to_owned(), width, height }
        }
        _ => failed(error),
    })?;
    let (width, height) = decoder.dimensions();
    let as_texture = u64::from(width) * u64::from(height) * bytes_per_texel(decoder.color_type());
    if decoder.total_bytes().max(as_texture) > MAX_BYTES {
        return Err(TextureError::TooLarge { name: name.to_owned(), width, height });
    }
    let Some(left) = budget.left.checked_sub(as_texture) else {
        let (name, limit) = (name.to_owned(), budget.limit);
        return Err(TextureError::TooLargeTogether { name, width, height, limit });
    };
    let image = DynamicImage::from_decoder(decoder).map_err(failed)?;
    budget.left = left;
    Ok(image)
}

/// Width and height as the header of an image has them.
fn dimensions(bytes: &[u8], format: ImageFormat) -> Option<(u32, u32)> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.no_limits();
    reader.into_dimensions().ok()
}

/// Memory of a texel in a [`Texture`], bytes.
fn bytes_per_texel(color: image::ColorType) -> u64 {
    if matches!(color, image::ColorType::Rgb32F | image::ColorType::Rgba32F) { 12 } else { 4 }
}

pub(crate) fn into_texture(
    image: DynamicImage,
    name: &str,
    encoding: Encoding,
) -> Result<Texture, TextureError> {
    let (width, height) = (image.width(), image.height());
    let texture = match image {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let texels = image.into_rgb32f().pixels().map(|p| p.0).collect();
            Texture::from_floats(name, width, height, texels)
        }
        integer => {
            let texels = integer.into_rgba8().pixels().map(|p| p.0).collect();
            Texture::from_bytes(name, width, height, texels, encoding)
        }
    };
    texture.ok_or_else(|| TextureError::Decode { name: name.to_owned(), problem: "it has no texels".into() })
}

/// Two uses of an image with equal keys share a texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TextureKey {
    /// The file, in canonical form, or any name that is unique to the image.
    pub(crate) source: PathBuf,
    /// Whether the bytes are sRGB.
    pub(crate) encoding: Encoding,
    /// Behaviour beyond the left and right edge.
    pub(crate) wrap_u: Wrap,
    /// Behaviour beyond the upper and lower edge.
    pub(crate) wrap_v: Wrap,
    /// Behaviour between the centres of texels.
    pub(crate) filter: Filter,
}

impl Hash for TextureKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let Self { source, encoding, wrap_u, wrap_v, filter } = self;
        let wraps = [wrap_u, wrap_v].map(discriminant);
        (source, discriminant(encoding), wraps, discriminant(filter)).hash(state);
    }
}

/// The textures of a scene, each decoded once.
#[derive(Debug, Default)]
pub(crate) struct TextureCache {
    textures: Vec<Texture>,
    budget: Budget,
    known: HashMap<TextureKey, Result<TextureId, TextureError>>,
}

impl TextureCache {
    /// The texture for `key`; calls `load` the first time. Failures are cached as well.
    ///
    /// # Errors
    /// The error of `load`.
    pub(crate) fn get_or_load(
        &mut self,
        key: TextureKey,
        load: impl FnOnce(&mut Budget) -> Result<Texture, TextureError>,
    ) -> Result<TextureId, TextureError> {
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let textures = &mut self.textures;
        let result = load(&mut self.budget).map(|mut texture| {
            (texture.wrap_u, texture.wrap_v, texture.filter) = (key.wrap_u, key.wrap_v, key.filter);
            let id = TextureId(textures.len() as u32);
            textures.push(texture);
            id
        });
        self.known.insert(key, result.clone());
        result
    }

    /// A texture that it has handed out.
    pub(crate) fn get(&self, id: TextureId) -> &Texture {
        &self.textures[id.index()]
    }

    /// All textures, in the order of their ids.
    pub(crate) fn into_textures(self) -> Vec<Texture> {
        self.textures
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::png;
    use glam::Vec3;
    use image::{ImageBuffer, Rgb, RgbImage};

    fn decode(
        bytes: &[u8],
        name: &str,
        extension: Option<&str>,
        encoding: Encoding,
    ) -> Result<Texture, TextureError> {
        super::decode(bytes, name, extension, encoding, &mut Budget::default())
    }

    fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        image.into().write_to(&mut Cursor::new(&mut bytes), format).unwrap();
        bytes
    }

    fn two_texels() -> RgbImage {
        ImageBuffer::from_fn(2, 1, |x, _| if x == 0 { Rgb([255, 0, 0]) } else { Rgb([0, 0, 255]) })
    }

    #[test]
    fn every_byte_format_is_read_by_content_whatever_it_is_called() {
        for format in
            [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Tiff, ImageFormat::WebP, ImageFormat::Tga]
        {
            let bytes = encoded(two_texels(), format);
            let tga = format == ImageFormat::Tga;
            for extension in if tga { [Some("tga"), Some("TGA")] } else { [Some("tga"), None] } {
                let texture = decode(&bytes, "x", extension, Encoding::Srgb).unwrap();
                assert_eq!(texture.size(), (2, 1), "{format:?} {extension:?}");
                assert_eq!(texture.texel(0, 0), Vec3::X, "{format:?} {extension:?}");
                assert_eq!(texture.texel(1, 0), Vec3::Z, "{format:?} {extension:?}");
            }
        }
        let jpeg = encoded(two_texels(), ImageFormat::Jpeg);
        assert_eq!(decode(&jpeg, "x", Some("png"), Encoding::Srgb).unwrap().size(), (2, 1));
    }

    #[test]
    fn floats_are_linear_and_reach_above_one() {
        let bright = ImageBuffer::from_pixel(2, 2, Rgb([4.0_f32, 0.5, 0.0]));
        for format in [ImageFormat::Hdr, ImageFormat::Tiff] {
            let bytes = encoded(DynamicImage::ImageRgb32F(bright.clone()), format);
            let texture = decode(&bytes, "x", None, Encoding::Srgb).unwrap();
            assert_eq!(texture.texel(1, 1), Vec3::new(4.0, 0.5, 0.0), "{format:?}");
            assert!(texture.bytes().is_none());
        }
    }

    #[test]
    fn unusable_images_are_explained() {
        let error = decode(b"hello, I am text", "a.txt", Some("txt"), Encoding::Srgb).unwrap_err();
        assert_eq!(error, TextureError::UnknownFormat { name: "a.txt".into() });
        assert!(matches!(decode(b"", "x", None, Encoding::Srgb), Err(TextureError::UnknownFormat { .. })));
        assert!(matches!(decode(b"", "x", Some("tga"), Encoding::Srgb), Err(TextureError::Decode { .. })));
        let whole = png([1, 2, 3, 4]);
        let error = decode(&whole[..whole.len() / 2], "half.png", None, Encoding::Srgb).unwrap_err();
        assert!(matches!(error, TextureError::Decode { .. }), "{error}");
        let error = load_texture(Path::new("absent.png"), Encoding::Srgb).unwrap_err();
        assert!(error.to_string().starts_with("cannot read image absent.png"), "{error}");
    }

    #[test]
    fn huge_images_are_refused_before_they_are_decoded() {
        let mut bmp = encoded(two_texels(), ImageFormat::Bmp);
        let mut set_size = |width: i32, height: i32| {
            bmp[18..22].copy_from_slice(&width.to_le_bytes());
            bmp[22..26].copy_from_slice(&height.to_le_bytes());
            decode(&bmp, "big.bmp", None, Encoding::Srgb).unwrap_err()
        };
        let error = set_size(20_000, 20_000);
        assert!(matches!(error, TextureError::TooLarge { width: 20_000, .. }), "{error}");
        assert!(matches!(set_size(60_000, 1), TextureError::TooLarge { width: 60_000, .. }));
    }

    #[test]
    fn images_share_a_budget_that_is_checked_before_they_are_decoded() {
        let image = |width| encoded(RgbImage::new(width, 2), ImageFormat::Png);
        let mut budget = Budget::of(4 * 2 * 5);
        let mut read = |bytes: &[u8], name| {
            super::decode(bytes, name, None, Encoding::Srgb, &mut budget).map(|t| t.size())
        };
        assert_eq!(read(&image(3), "first"), Ok((3, 2)));
        let mut damaged = image(3);
        let end = damaged.len() - 20;
        damaged.truncate(end);
        let error = read(&damaged, "second").unwrap_err();
        assert_eq!(
            error.to_string(),
            "image second with 3 x 2 texels does not fit the 40 bytes that lumel reads of all images of a file \
             together; scale images down"
        );
        assert_eq!(read(&image(2), "third"), Ok((2, 2)), "what was refused takes nothing");
    }

    #[test]
    fn one_key_is_loaded_once_and_failures_are_remembered() {
        let mut cache = TextureCache::default();
        let key = |source: &str, wrap_u| TextureKey {
            source: source.into(),
            encoding: Encoding::Srgb,
            wrap_u,
            wrap_v: Wrap::Repeat,
            filter: Filter::Linear,
        };
        let load = |budget: &mut Budget| super::decode(&png([0; 4]), "x", None, Encoding::Srgb, budget);
        let first = cache.get_or_load(key("a", Wrap::Clamp), load).unwrap();
        assert_eq!(cache.get_or_load(key("a", Wrap::Clamp), |_| unreachable!()), Ok(first));
        assert_ne!(cache.get_or_load(key("a", Wrap::Repeat), load), Ok(first));
        let failure = TextureError::UnknownFormat { name: "b".into() };
        assert_eq!(cache.get_or_load(key("b", Wrap::Repeat), |_| Err(failure.clone())), Err(failure.clone()));
        assert_eq!(cache.get_or_load(key("b", Wrap::Repeat), |_| unreachable!()), Err(failure));
        let textures = cache.into_textures();
        assert_eq!((textures.len(), textures[0].wrap_u), (2, Wrap::Clamp));
    }
}
