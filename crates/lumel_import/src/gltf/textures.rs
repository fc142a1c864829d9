//! Images and samplers.

use super::buffers::Buffers;
use super::document::Document;
use super::uri;
use crate::TextureError;
use crate::image::{Budget, TextureCache, TextureKey, decode, encoded_type};
use crate::paths::Resolver;
use crate::text::escaped;
use gltf_json::Image;
use gltf_json::texture::{MagFilter, WrappingMode};
use gltf_json::validation::Checked;
use lumel_scene::{EncodedImage, Encoding, Filter, GlossTexture, Texture, TextureId, UvTransform, Wrap};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The textures of a document, each decoded when it is first used.
pub(super) struct Textures<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    resolver: &'a Resolver,
    cache: TextureCache,
    /// Images that are kept as they are, by index in the document; `None` for those that cannot be.
    encoded: BTreeMap<usize, Option<Arc<EncodedImage>>>,
}

/// What a texture of the document is.
struct Parts<'d> {
    image: &'d Image,
    image_index: usize,
    source: Source,
    wrap: [Wrap; 2],
    filter: Filter,
}

impl<'a> Textures<'a> {
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'a>, resolver: &'a Resolver) -> Self {
        Self { document, buffers, resolver, cache: TextureCache::default(), encoded: BTreeMap::new() }
    }

    /// The scene's texture for one of the document's, or why it is unavailable.
    ///
    /// Uses of the same image with the same wrapping, filter and encoding share a texture.
    pub(super) fn get(&mut self, index: usize, encoding: Encoding) -> Result<TextureId, String> {
        let Parts { image, image_index, source, wrap: [wrap_u, wrap_v], filter } = self.parts(index)?;
        let Self { buffers, cache, .. } = self;
        // Files have absolute paths, so no file is called that.
        let inline = || PathBuf::from(format!("image {image_index}"));
        let unique = source.file.clone().unwrap_or_else(inline);
        let key = TextureKey { source: unique, encoding, wrap_u, wrap_v, filter };
        let load = |budget: &mut Budget| {
            let bytes = source.bytes(image, buffers)?;
            decode(&bytes, &source.name, source.extension(image), encoding, budget)
        };
        cache.get_or_load(key, load).map_err(|error| error.to_string())
    }

    /// One of the document's textures with its image as it is; `None` if it is no PNG or JPEG image that can be read.
    pub(super) fn encoded(&mut self, index: usize, transform: UvTransform) -> Option<GlossTexture> {
        let Parts { image, image_index, source, wrap, filter } = self.parts(index).ok()?;
        let buffers = self.buffers;
        let read = || {
            let bytes = source.bytes(image, buffers).ok()?;
            let mime_type = encoded_type(&bytes)?;
            Some(Arc::new(EncodedImage { name: source.name.clone(), mime_type, bytes: bytes.into_owned() }))
        };
        let image = self.encoded.entry(image_index).or_insert_with(read).clone()?;
        Some(GlossTexture { image, transform, wrap, filter })
    }

    fn parts(&self, index: usize) -> Result<Parts<'a>, String> {
        let document = self.document;
        let texture = document.textures.get(index).and_then(Option::as_ref);
        let texture = texture.ok_or_else(|| format!("texture {index} does not exist or cannot be read"))?;
        // A texture without an image, as those in foreign formats are, has the largest index of all here.
        let image_index = texture.source.value();
        let image = document.images.get(image_index).and_then(Option::as_ref);
        let image =
            image.ok_or_else(|| format!("texture {index} has no image in a format that lumel reads"))?;
        let sampler = texture.sampler.and_then(|sampler| document.samplers.get(sampler.value())?.as_ref());
        let wrap = sampler.map_or_else(Default::default, |s| [wrapping(s.wrap_s), wrapping(s.wrap_t)]);
        // Baked light is seen from near by: how a texture is made smaller does not matter.
        let filter = match sampler.and_then(|sampler| sampler.mag_filter) {
            Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
            _ => Filter::Linear,
        };
        let source = Source::of(image, image_index, self.resolver)?;
        Ok(Parts { image, image_index, source, wrap, filter })
    }

    /// All textures, in the order of their ids.
    pub(super) fn into_textures(self) -> Vec<Texture> {
        self.cache.into_textures()
    }
}

/// Where an image comes from.
struct Source {
    /// Its name in messages.
    name: String,
    /// Its file; `None` if it is inside the document.
    file: Option<PathBuf>,
}

impl Source {
    fn of(image: &Image, index: usize, resolver: &Resolver) -> Result<Self, String> {
        let given = image.name.clone().filter(|name| !name.is_empty());
        match &image.uri {
            Some(uri) if !uri::is_inline(uri) => {
                let file = uri::find_file(uri, resolver).map_err(|error| error.to_string())?;
                Ok(Self { name: given.unwrap_or_else(|| escaped(uri)), file: Some(file) })
            }
            _ => Ok(Self { name: given.unwrap_or_else(|| format!("image {index}")), file: None }),
        }
    }

    fn bytes<'b>(&self, image: &Image, buffers: &'b Buffers<'_>) -> Result<Cow<'b, [u8]>, TextureError> {
        let failed = |problem| TextureError::Read { name: self.name.clone(), problem };
        if let Some(file) = &self.file {
            return std::fs::read(file).map(Cow::Owned).map_err(|error| failed(error.to_string()));
        }
        let bytes =
            match (image.uri.as_deref().and_then(|uri| uri::inline_data(uri, "image")), image.buffer_view) {
                (Some(data), _) => data.map(Cow::Owned),
                (None, Some(view)) => buffers.view(view.value(), "image").map(Cow::Borrowed),
                (None, None) => return Err(failed("it has neither a URI nor a bufferView".into())),
            };
        bytes.map_err(|fault| failed(fault.to_string()))
    }

    /// The format according to the name or the MIME type; only a hint.
    fn extension<'b>(&'b self, image: &'b Image) -> Option<&'b str> {
        let of_file = self.file.as_ref().and_then(|file| file.extension()?.to_str());
        of_file.or_else(|| image.mime_type.as_ref()?.0.strip_prefix("image/"))
    }
}

fn wrapping(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}
