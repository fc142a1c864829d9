//! Buffers and the parts of them that the document names.

use super::document::Document;
use super::fault::Fault;
use super::uri;
use crate::ImportError;
use crate::paths::Resolver;
use std::borrow::Cow;
use std::cell::OnceCell;
use std::fs::File;
use std::io::Read;

/// The buffers of a document, each loaded when it is first used.
///
/// What is never used may be missing.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    /// The binary chunk of a GLB.
    bin: Option<&'a [u8]>,
    resolver: &'a Resolver,
    loaded: Vec<OnceCell<Cow<'a, [u8]>>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(document: &'a Document, bin: Option<&'a [u8]>, resolver: &'a Resolver) -> Self {
        let loaded = document.buffers.iter().map(|_| OnceCell::new()).collect();
        Self { document, bin, resolver, loaded }
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize, user: &str) -> Result<&[u8], Fault> {
        let views = &self.document.views;
        let view = views.get(index).ok_or_else(|| Fault::absent(user, "bufferView", index, views.len()))?;
        let place = format!("bufferView {index}");
        let buffer = self.buffer(view.buffer.value(), &place)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let bytes = start
            .checked_add(view.byte_length.0)
            .and_then(|end| buffer.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        bytes.ok_or_else(|| {
            let (length, buffer_length) = (view.byte_length.0, buffer.len());
            let problem = format!(
                "{length} bytes from byte {start} do not fit buffer {} of {buffer_length} bytes",
                view.buffer.value()
            );
            Fault::at(place, problem)
        })
    }

    fn buffer(&self, index: usize, user: &str) -> Result<&[u8], Fault> {
        let cell =
            self.loaded.get(index).ok_or_else(|| Fault::absent(user, "buffer", index, self.loaded.len()))?;
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let bytes = self.load(index)?;
        Ok(cell.get_or_init(|| bytes))
    }

    /// At most `byteLength` bytes: GLB chunks are padded, and nobody may make us read more of a file than it says.
    ///
    /// Fewer are accepted: what does not reach the missing end can be read.
    fn load(&self, index: usize) -> Result<Cow<'a, [u8]>, Fault> {
        let buffer = &self.document.buffers[index];
        let place = format!("buffer {index}");
        let length = buffer.byte_length.0;
        let Some(uri) = &buffer.uri else {
            let bin = self.bin.filter(|_| index == 0);
            let bin = bin.ok_or_else(|| Fault::at(place, "it has neither a URI nor a binary chunk"))?;
            return Ok(Cow::Borrowed(&bin[..bin.len().min(usize::try_from(length).unwrap_or(usize::MAX))]));
        };
        if let Some(data) = uri::inline_data(uri, &place) {
            let mut data = data?;
            data.truncate(usize::try_from(length).unwrap_or(usize::MAX));
            return Ok(Cow::Owned(data));
        }
        let path = uri::find_file(uri, self.resolver).map_err(Fault::Reference)?;
        let mut bytes = Vec::new();
        File::open(&path)
            .and_then(|file| file.take(length).read_to_end(&mut bytes))
            .map_err(|source| Fault::File(ImportError::Io { path, source }))?;
        Ok(Cow::Owned(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PathPolicy;
    use lumel_scene::Warnings;
    use serde_json::json;
    use std::path::Path;

    /// The view of a buffer of six bytes, or what is wrong with it.
    fn view(offset: u64, length: u64, buffer: usize) -> Result<Vec<u8>, String> {
        let document = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": 6 }, { "byteLength": 3, "uri": "data:;base64,AAECAwQFBgc=" },
                { "byteLength": 3, "uri": "absent.bin" }, { "byteLength": 3, "uri": "../outside.bin" }],
            "bufferViews": [{ "buffer": buffer, "byteOffset": offset, "byteLength": length }],
        });
        let json = serde_json::to_vec(&document).unwrap();
        let document = Document::parse(&json, &mut Warnings::default()).unwrap();
        let resolver = Resolver::new(Path::new("scene.glb"), PathPolicy::WithinFolder).unwrap();
        let buffers = Buffers::new(&document, Some(b"abcdefPP"), &resolver);
        let bytes = buffers.view(0, "image 0").map(<[u8]>::to_vec);
        bytes.map_err(|fault| fault.in_file(Path::new("scene.glb")).to_string())
    }

    #[test]
    fn views_are_cut_out_of_their_buffer() {
        assert_eq!(view(1, 3, 0).unwrap(), b"bcd");
        assert_eq!(view(6, 0, 0).unwrap(), b"");
        assert_eq!(view(1, 2, 1).unwrap(), [1, 2]);
    }

    #[test]
    fn views_beyond_their_buffer_are_refused_without_overflow() {
        assert_eq!(
            view(1, 6, 0).unwrap_err(),
            "scene.glb: bufferView 0: 6 bytes from byte 1 do not fit buffer 0 of 6 bytes"
        );
        for (offset, length) in [(u64::MAX, 1), (1, u64::MAX), (u64::MAX, u64::MAX), (7, 0)] {
            assert!(view(offset, length, 0).unwrap_err().contains("do not fit"), "{offset} {length}");
        }
        assert!(view(0, 4, 1).is_err(), "byteLength counts, not what is there");
        assert_eq!(view(0, 1, 9).unwrap_err(), "scene.glb: bufferView 0: refers to buffer 9 of 4");
    }

    #[test]
    fn files_that_are_missing_or_outside_are_refused() {
        for buffer in [2, 3] {
            assert!(view(0, 1, buffer).unwrap_err().contains("needs a file that cannot be used"));
        }
    }
}
