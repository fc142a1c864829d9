//! References to data: files beside the document, or inline data.

use super::fault::Fault;
use crate::PathError;
use crate::paths::Resolver;
use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::path::PathBuf;

/// Base64 as it is found in files: with and without padding, with stray bits in the last digit.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Whether a URI contains the data itself.
pub(super) fn is_inline(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The data of a `data:` URI; `None` when the URI is of another kind.
pub(super) fn inline_data(uri: &str, place: &str) -> Option<Result<Vec<u8>, Fault>> {
    if !is_inline(uri) {
        return None;
    }
    let Some((media_type, data)) = uri[5..].split_once(',') else {
        return Some(Err(Fault::at(place, "its data URI has no comma before the data")));
    };
    // Escapes are rare in Base64, but `+`, `/` and `=` are sometimes written so.
    let bytes: Cow<'_, [u8]> = percent_decode_str(data).into();
    if !media_type.to_ascii_lowercase().ends_with(";base64") {
        return Some(Ok(bytes.into_owned()));
    }
    Some(BASE64.decode(bytes).map_err(|error| Fault::at(place, format_args!("its data URI: {error}"))))
}

/// The file that a URI names.
///
/// URIs should be percent-encoded, but spaces, Unicode and names that contain `%` are often written literally: the
/// decoded name is tried first, then the literal one.
pub(super) fn find_file(uri: &str, resolver: &Resolver) -> Result<PathBuf, PathError> {
    let decoded = percent_decode_str(uri).decode_utf8().unwrap_or(Cow::Borrowed(uri));
    match resolver.resolve(&decoded) {
        Err(PathError::Missing { .. }) if decoded != uri => resolver.resolve(uri),
        result => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PathPolicy;
    use std::fs;

    fn data(uri: &str) -> Option<Vec<u8>> {
        inline_data(uri, "buffer 0").map(|data| data.unwrap())
    }

    #[test]
    fn data_uris_hold_base64_or_escaped_bytes() {
        for uri in [
            "data:application/octet-stream;base64,AAH/",
            "DATA:;BASE64,AAH/",
            "data:a/b;charset=x;base64,AAH%2F",
        ] {
            assert_eq!(data(uri).unwrap(), [0, 1, 255], "{uri}");
        }
        assert_eq!(data("data:;base64,AAE").unwrap(), [0, 1], "no padding");
        assert_eq!(data("data:;base64,AAE=").unwrap(), [0, 1]);
        assert_eq!(data("data:;base64,").unwrap(), [0_u8; 0]);
        assert_eq!(data("data:text/plain,a%00b").unwrap(), [b'a', 0, b'b']);
        assert_eq!(data("box.bin"), None);
        assert_eq!(data("dätä:x"), None, "no character is cut in half");
    }

    #[test]
    fn damaged_data_uris_are_refused_by_place() {
        for uri in ["data:;base64", "data:;base64,A", "data:;base64,AA*A", "data:;base64,ää"] {
            let message = inline_data(uri, "buffer 7").unwrap().unwrap_err().to_string();
            assert!(message.starts_with("buffer 7: its data URI"), "{message}");
        }
    }

    #[test]
    fn files_are_found_by_their_escaped_and_their_literal_name() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a b ♻.bin", "50%25.bin", "100%.bin"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        let resolver = Resolver::new(&folder.path().join("scene.gltf"), PathPolicy::WithinFolder).unwrap();
        let found =
            |uri| find_file(uri, &resolver).ok().and_then(|p| p.file_name()?.to_str().map(str::to_owned));
        for uri in ["a%20b%20♻.bin", "a b ♻.bin", "a%20b%20%E2%99%BB.bin"] {
            assert_eq!(found(uri).as_deref(), Some("a b ♻.bin"), "{uri}");
        }
        assert_eq!(found("50%25.bin").as_deref(), Some("50%25.bin"), "50%.bin does not exist");
        assert_eq!(found("100%25.bin").as_deref(), Some("100%.bin"));
        assert_eq!(found("http://example.org/a.bin"), None);
        let error = find_file("%2e%2e/outside.bin", &resolver).unwrap_err();
        assert!(matches!(error, PathError::Outside { .. }), "escapes do not climb the fence: {error}");
    }
}
