//! Detection of file formats.

use crate::ImportError;
use crate::error::SUPPORTED;
use crate::text::split_keyword;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// How much of a file is read to detect its format, bytes.
const SAMPLE: u64 = 4096;

/// Formats of scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Wavefront OBJ.
    Obj,
    /// glTF, as text or binary.
    Gltf,
    /// Stanford PLY.
    Ply,
}

impl Format {
    /// The format of a file by its extension, otherwise by its content.
    ///
    /// # Errors
    /// The file cannot be read or is in an unknown format.
    pub(crate) fn of(path: &Path) -> Result<Self, ImportError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("obj") => return Ok(Self::Obj),
            Some("gltf" | "glb") => return Ok(Self::Gltf),
            Some("ply") => return Ok(Self::Ply),
            _ => {}
        }
        let mut sample = Vec::new();
        let file = File::open(path).map_err(ImportError::io(path))?;
        file.take(SAMPLE).read_to_end(&mut sample).map_err(ImportError::io(path))?;
        Self::of_content(&sample)
            .ok_or_else(|| ImportError::unsupported(path, format!("unknown format; lumel reads {SUPPORTED}")))
    }

    fn of_content(sample: &[u8]) -> Option<Self> {
        let text = sample.strip_prefix(b"\xef\xbb\xbf").unwrap_or(sample).trim_ascii_start();
        if text.starts_with(b"glTF") || text.starts_with(b"{") {
            return Some(Self::Gltf);
        }
        if text.starts_with(b"ply\n") || text.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        let mut keywords = text.split(|&byte| byte == b'\n').map(|line| split_keyword(line).0);
        let first = keywords.find(|keyword| !keyword.is_empty() && !keyword.starts_with(b"#"))?;
        let known: [&[u8]; 9] = [b"v", b"vt", b"vn", b"f", b"o", b"g", b"s", b"usemtl", b"mtllib"];
        known.contains(&first).then_some(Self::Obj)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_count_whatever_their_case_and_content_where_they_say_nothing() {
        for (name, format) in [("a.OBJ", Format::Obj), ("a.b.GlTf", Format::Gltf), ("a.glb", Format::Gltf)] {
            assert_eq!(Format::of(Path::new(name)).unwrap(), format, "{name}");
        }
        assert_eq!(Format::of(Path::new("A.PLY")).unwrap(), Format::Ply);
        assert_eq!(Format::of_content(b"# made by hand\n\n  v 0 0 0\n"), Some(Format::Obj));
        assert_eq!(Format::of_content(b"\xef\xbb\xbf\n{ \"asset\""), Some(Format::Gltf));
        assert_eq!(Format::of_content(b"glTF\x02\0\0\0"), Some(Format::Gltf));
        assert_eq!(Format::of_content(b"ply\r\nformat"), Some(Format::Ply));
        for other in [b"".as_slice(), b"# only a comment", b"solid cube", b"\x89PNG\r\n", b"plywood"] {
            assert_eq!(Format::of_content(other), None, "{other:?}");
        }
    }

    #[test]
    fn unknown_formats_are_refused_with_a_list_of_known_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.stl");
        std::fs::write(&path, "solid cube").unwrap();
        let error = Format::of(&path).unwrap_err().to_string();
        assert!(error.ends_with("unknown format; lumel reads obj, gltf, glb and ply"), "{error}");
        assert!(matches!(Format::of(&folder.path().join("absent")), Err(ImportError::Io { .. })));
    }
}
