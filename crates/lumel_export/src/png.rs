//! Pictures of 8 bits per channel.

use crate::{ExportError, write_atomically};
use std::io::{self, Write};
use std::path::Path;

/// The longest keyword of a text, characters; PNG specification.
const MAX_KEYWORD: usize = 79;

/// Writes a picture as PNG, atomically: sRGB, 8 bits per channel, rows from the top.
///
/// `texts` are keywords and texts to store in the file, such as `("Title", "cornell-box")`.
///
/// # Errors
/// A size that does not match the number of pixels or exceeds the limits of PNG, a keyword that is not 1 to 79 plain
/// characters, and the errors of [`write_atomically`].
pub fn write_png(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[u8; 3]],
    texts: &[(&str, &str)],
) -> Result<(), ExportError> {
    if let Some(problem) = problem(width, height, pixels.len(), texts) {
        return Err(ExportError::content(path, problem));
    }
    write_atomically(path, |out| encode_png(out, width, height, pixels, texts))
}

fn problem(width: u32, height: u32, n_pixels: usize, texts: &[(&str, &str)]) -> Option<String> {
    if width == 0 || height == 0 || width > i32::MAX as u32 || height > i32::MAX as u32 {
        return Some(format!("a picture of {width} x {height} pixels cannot be written as PNG"));
    }
    if u64::from(width) * u64::from(height) != n_pixels as u64 {
        return Some(format!("a picture of {width} x {height} pixels has {n_pixels} pixels"));
    }
    let plain = |keyword: &str| {
        (1..=MAX_KEYWORD).contains(&keyword.len())
            && keyword.bytes().all(|c| c == b' ' || c.is_ascii_graphic())
            && keyword.trim() == keyword
    };
    let bad = texts.iter().find(|(keyword, text)| !plain(keyword) || text.contains('\0'));
    bad.map(|(keyword, _)| format!("\"{keyword}\" cannot be a text of a PNG file"))
}

/// Encodes a picture whose number of pixels matches its size, with alpha if they have four channels.
pub(crate) fn encode_png<const CHANNELS: usize>(
    out: impl Write,
    width: u32,
    height: u32,
    pixels: &[[u8; CHANNELS]],
    texts: &[(&str, &str)],
) -> io::Result<()> {
    let mut encoder = ::png::Encoder::new(out, width, height);
    let with_alpha = CHANNELS == 4;
    encoder.set_color(if with_alpha { ::png::ColorType::Rgba } else { ::png::ColorType::Rgb });
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    for (keyword, text) in texts {
        // tEXt is Latin-1 and more widely supported.
        if text.is_ascii() {
            encoder.add_text_chunk((*keyword).to_owned(), (*text).to_owned())?;
        } else {
            encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned())?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels.as_flattened())?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::io::BufReader;

    #[test]
    fn a_picture_and_its_texts_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let pixels: Vec<[u8; 3]> = (0..15).map(|i| [i, 2 * i, 255 - i]).collect();
        write_png(&path, 5, 3, &pixels, &[("Title", "box"), ("Comment", "größer")]).unwrap();
        let mut reader = ::png::Decoder::new(BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let info = reader.info();
        assert_eq!((info.width, info.height), (5, 3));
        assert_eq!(info.srgb, Some(::png::SrgbRenderingIntent::Perceptual));
        assert_eq!(info.uncompressed_latin1_text[0].text, "box");
        assert_eq!(info.utf8_text[0].get_text().unwrap(), "größer");
        assert_eq!(bytes, pixels.as_flattened());
    }

    #[test]
    fn sizes_and_keywords_that_do_not_fit_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let refused = |width, height, n, texts: &[(&str, &str)]| {
            let error = write_png(&path, width, height, &vec![[0; 3]; n], texts).unwrap_err();
            assert!(matches!(error, ExportError::Content { .. }), "{error}");
            error.to_string()
        };
        assert!(refused(4, 3, 11, &[]).starts_with("a picture of 4 x 3 pixels has 11 pixels: \""));
        refused(0, 3, 0, &[]);
        refused(u32::MAX, 1, 1, &[]);
        refused(1, 1, 1, &[("", "x")]);
        refused(1, 1, 1, &[(" a", "x")]);
        refused(1, 1, 1, &[("größe", "x")]);
        refused(1, 1, 1, &[("a", "x\0y")]);
        refused(1, 1, 1, &[(&"k".repeat(80), "x")]);
        assert!(!path.exists());
    }
}
