//! Buffers and buffer views.

use super::document::Document;
use super::fault::Fault;
use super::uri;
use crate::ImportError;
use crate::paths::Resolver;
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

/// The buffers of a document, each loaded when it is first used.
///
/// Unused buffers may be missing.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    /// The binary chunk of a GLB.
    bin: Option<&'a [u8]>,
    resolver: &'a Resolver,
    loaded: Vec<OnceCell<Bytes<'a>>>,
    /// Several buffers may share a file.
    files: RefCell<BTreeMap<PathBuf, Rc<[u8]>>>,
}

enum Bytes<'a> {
    Chunk(&'a [u8]),
    Inline(Vec<u8>),
    File(Rc<[u8]>),
}

impl Bytes<'_> {
    /// At most `length` bytes: GLB chunks are padded, and bytes beyond a buffer's length do not belong to it.
    ///
    /// Fewer are accepted: data before the missing end can be read.
    fn first(&self, length: u64) -> &[u8] {
        let all = match self {
            Self::Chunk(bytes) => bytes,
            Self::Inline(bytes) => bytes.as_slice(),
            Self::File(bytes) => bytes,
        };
        &all[..usize::try_from(length).map_or(all.len(), |length| length.min(all.len()))]
    }
}

impl<'a> Buffers<'a> {
    pub(super) fn new(document: &'a Document, bin: Option<&'a [u8]>, resolver: &'a Resolver) -> Self {
        let loaded = document.buffers.iter().map(|_| OnceCell::new()).collect();
        Self { document, bin, resolver, loaded, files: RefCell::default() }
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
        let length = self.document.buffers[index].byte_length.0;
        if let Some(bytes) = cell.get() {
            return Ok(bytes.first(length));
        }
        let bytes = self.load(index)?;
        Ok(cell.get_or_init(|| bytes).first(length))
    }

    fn load(&self, index: usize) -> Result<Bytes<'a>, Fault> {
        let place = format!("buffer {index}");
        let Some(uri) = &self.document.buffers[index].uri else {
            let bin = self.bin.filter(|_| index == 0).map(Bytes::Chunk);
            return bin.ok_or_else(|| Fault::at(place, "it has neither a URI nor a binary chunk"));
        };
        if let Some(data) = uri::inline_data(uri, &place) {
            return data.map(Bytes::Inline);
        }
        let path = uri::find_file(uri, self.resolver).map_err(Fault::Reference)?;
        if let Some(bytes) = self.files.borrow().get(&path) {
            return Ok(Bytes::File(bytes.clone()));
        }
        let read = std::fs::read(&path);
        let bytes: Rc<[u8]> =
            read.map_err(|source| Fault::File(ImportError::Io { path: path.clone(), source }))?.into();
        self.files.borrow_mut().insert(path, bytes.clone());
        Ok(Bytes::File(bytes))
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
    fn a_file_is_read_once_however_it_is_spelled() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.bin"), b"abcdef").unwrap();
        let buffer = |uri| json!({ "byteLength": 4, "uri": uri });
        let view = |buffer| json!({ "buffer": buffer, "byteLength": 4 });
        let document = json!({
            "asset": { "version": "2.0" },
            "buffers": [buffer("a b.bin"), buffer("./a%20b.bin")],
            "bufferViews": [view(0), view(1)],
        });
        let json = serde_json::to_vec(&document).unwrap();
        let document = Document::parse(&json, &mut Warnings::default()).unwrap();
        let resolver = Resolver::new(&folder.path().join("scene.gltf"), PathPolicy::WithinFolder).unwrap();
        let buffers = Buffers::new(&document, None, &resolver);
        let [first, second] = [0, 1].map(|index| buffers.view(index, "test").unwrap());
        assert_eq!(first, b"abcd");
        assert!(std::ptr::eq(first, second));
    }

    #[test]
    fn files_that_are_missing_or_outside_are_refused() {
        for buffer in [2, 3] {
            assert!(view(0, 1, buffer).unwrap_err().contains("depends on a file that cannot be used"));
        }
    }
}
