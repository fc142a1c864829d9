//! Detection and parsing of the GLB container.
//!
//! Khronos Group, *glTF 2.0 Specification*, chapter 4.

use super::fault::Fault;

const MAGIC: &[u8; 4] = b"glTF";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON_CHUNK: &[u8; 4] = b"JSON";
const BIN_CHUNK: &[u8; 4] = b"BIN\0";

/// The parts of a glTF file.
#[derive(Debug, PartialEq)]
pub(super) struct Container<'a> {
    /// The document.
    pub(super) json: &'a [u8],
    /// The binary chunk of a GLB: its first buffer.
    pub(super) bin: Option<&'a [u8]>,
}

impl<'a> Container<'a> {
    /// Parses a file. The content decides, not the extension: both kinds occur under both names.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let parts = if bytes.starts_with(MAGIC) { open_glb(bytes)? } else { Self { json: bytes, bin: None } };
        Ok(Self { json: without_padding(parts.json), ..parts })
    }
}

fn open_glb(bytes: &[u8]) -> Result<Container<'_>, Fault> {
    let (Some(version), Some(length)) = (u32_at(bytes, 4), u32_at(bytes, 8)) else {
        return Err(Fault::at("GLB header", format_args!("the file ends after {} bytes", bytes.len())));
    };
    if version != 2 {
        return Err(Fault::Unsupported(format!("GLB version {version}; lumel reads version 2")));
    }
    // What follows the stated length is not ours.
    let bytes = bytes.get(..length as usize).ok_or_else(|| {
        let problem =
            format!("the file has {} of the {length} bytes it states; it may be cut off", bytes.len());
        Fault::at("GLB header", problem)
    })?;
    let json = Chunk::split_off(bytes.get(HEADER..).unwrap_or_default(), 0)?;
    if json.kind != JSON_CHUNK {
        return Err(Fault::at("GLB chunk 0", "it must be the JSON chunk"));
    }
    // The binary chunk is the second, if there is one; others belong to extensions. A few stray bytes after the
    // last chunk are common padding.
    let second = (json.rest.len() >= CHUNK_HEADER).then(|| Chunk::split_off(json.rest, 1)).transpose()?;
    let bin = second.filter(|chunk| chunk.kind == BIN_CHUNK).map(|chunk| chunk.content);
    Ok(Container { json: json.content, bin })
}

struct Chunk<'a> {
    kind: &'a [u8],
    content: &'a [u8],
    /// What follows it.
    rest: &'a [u8],
}

impl<'a> Chunk<'a> {
    fn split_off(bytes: &'a [u8], number: usize) -> Result<Self, Fault> {
        let place = format!("GLB chunk {number}");
        let (Some(length), Some(kind)) = (u32_at(bytes, 0), bytes.get(4..CHUNK_HEADER)) else {
            return Err(Fault::at(place, "it is missing"));
        };
        match bytes[CHUNK_HEADER..].split_at_checked(length as usize) {
            Some((content, rest)) => Ok(Self { kind, content, rest }),
            None => {
                let left = bytes.len() - CHUNK_HEADER;
                Err(Fault::at(place, format_args!("it states {length} bytes where {left} are left")))
            }
        }
    }
}

/// Chunks are padded to four bytes: with blanks, or by some writers with zeros. A byte order mark may come first.
fn without_padding(json: &[u8]) -> &[u8] {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &json[..end]
}

fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    let four = bytes.get(offset..)?.first_chunk()?;
    Some(u32::from_le_bytes(*four))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = [MAGIC.as_slice(), &2_u32.to_le_bytes(), &[0; 4]].concat();
        for (kind, data) in chunks {
            bytes.extend((data.len() as u32).to_le_bytes());
            bytes.extend(*kind);
            bytes.extend(*data);
        }
        let length = bytes.len() as u32;
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        bytes
    }

    fn message(bytes: &[u8]) -> String {
        Container::open(bytes).unwrap_err().to_string()
    }

    #[test]
    fn json_and_binary_chunks_are_found_whatever_their_padding() {
        for padding in ["", " ", "  ", "\0\0\0"] {
            let json = format!("{{}}{padding}");
            let bytes = glb(&[(JSON_CHUNK, json.as_bytes()), (BIN_CHUNK, b"data"), (b"XYZW", b"")]);
            let parts = Container::open(&bytes).unwrap();
            assert_eq!(parts.json.trim_ascii(), b"{}");
            assert_eq!(parts.bin, Some(b"data".as_slice()));
        }
        let plain = Container::open(b"\xef\xbb\xbf{}").unwrap();
        assert_eq!(plain, Container { json: b"{}", bin: None });
    }

    #[test]
    fn empty_absent_and_foreign_second_chunks_are_no_binary_data_to_trip_over() {
        assert_eq!(
            Container::open(&glb(&[(JSON_CHUNK, b"{}"), (BIN_CHUNK, b"")])).unwrap().bin,
            Some(&[][..])
        );
        assert_eq!(Container::open(&glb(&[(JSON_CHUNK, b"{}")])).unwrap().bin, None);
        assert_eq!(Container::open(&glb(&[(JSON_CHUNK, b"{}"), (b"XYZW", b"1234")])).unwrap().bin, None);
        let mut trailing = glb(&[(JSON_CHUNK, b"{}")]);
        trailing.extend(b"something else");
        assert!(Container::open(&trailing).is_ok());
    }

    #[test]
    fn every_wrong_size_is_named() {
        let good = glb(&[(JSON_CHUNK, b"{  }"), (BIN_CHUNK, b"data")]);
        assert!(message(&good[..10]).contains("GLB header"));
        assert_eq!(
            message(&good[..30]),
            "GLB header: the file has 30 of the 36 bytes it states; it may be cut off"
        );
        let mut long_json = good.clone();
        long_json[12] = 200;
        assert_eq!(message(&long_json), "GLB chunk 0: it states 200 bytes where 16 are left");
        let mut long_bin = good.clone();
        long_bin[24..28].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(message(&long_bin), "GLB chunk 1: it states 4294967295 bytes where 4 are left");
        assert!(message(&glb(&[])).contains("GLB chunk 0: it is missing"));
        assert!(message(&glb(&[(BIN_CHUNK, b"data")])).contains("must be the JSON chunk"));
        let mut old = good;
        old[4] = 1;
        assert_eq!(message(&old), "GLB version 1; lumel reads version 2");
    }
}
