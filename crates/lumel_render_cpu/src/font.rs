//! The font of labels and legends, Noto Sans; see `fonts/README.md`.

use ab_glyph::{Font, FontRef, Glyph, OutlinedGlyph, PxScale, ScaleFont, point};
use std::sync::LazyLock;

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(include_bytes!("../fonts/NotoSans-Medium-ascii.ttf"))
        .expect("the font is part of this crate and can be read")
});

/// Height of a capital and of a digit over the size of the font.
const CAPITAL: f32 = 0.714;
/// How far letters reach below the line, over the size of the font.
const DESCENT: f32 = 0.24;

/// Height of capitals and digits, pixels.
pub(crate) fn capital_height(size: f32) -> f32 {
    CAPITAL * size
}

/// Width and height of a line of text in a font of `size` pixels: from the first letter's origin to the end of the last
/// one's advance, and from the top of capitals to the bottom of letters that hang below the line.
pub(crate) fn text_size(text: &str, size: f32) -> [f32; 2] {
    let font = FONT.as_scaled(scale(size));
    let width = text.chars().map(|letter| font.h_advance(font.glyph_id(letter))).sum();
    [width, (CAPITAL + DESCENT) * size]
}

/// The outlines of a line of text whose capitals have their top at 0, its letters from `x = 0` to the right.
///
/// Letters that the font lacks are boxes.
pub(crate) fn outlines(text: &str, size: f32) -> impl Iterator<Item = OutlinedGlyph> {
    let scale = scale(size);
    let mut x = 0.0;
    text.chars().filter_map(move |letter| {
        let id = FONT.glyph_id(letter);
        let position = point(x, capital_height(size));
        x += FONT.as_scaled(scale).h_advance(id);
        FONT.outline_glyph(Glyph { id, scale, position })
    })
}

/// The font's size in the unit of its library, which counts from the highest ascent to the lowest descent.
fn scale(size: f32) -> PxScale {
    let em = FONT.units_per_em().unwrap_or(1.0);
    PxScale::from(size * FONT.height_unscaled() / em)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printable() -> impl Iterator<Item = char> {
        ('!'..='~').chain(['²', '×'])
    }

    #[test]
    fn every_printable_letter_has_an_outline_of_its_own() {
        let missing = FONT.glyph_id('\u{df}');
        for letter in printable() {
            assert_ne!(FONT.glyph_id(letter), missing, "{letter}");
            assert_eq!(outlines(&letter.to_string(), 20.0).count(), 1, "{letter}");
        }
        assert_eq!(outlines(" ", 20.0).count(), 0);
        assert_eq!(outlines("\u{df}", 20.0).count(), 1, "a box");
    }

    #[test]
    fn capitals_and_descenders_have_the_heights_of_the_constants() {
        let bounds = |letter: &str| outlines(letter, 100.0).next().unwrap().px_bounds();
        assert_eq!((bounds("H").min.y, bounds("H").max.y), (0.0, 72.0));
        assert!((bounds("0").max.y - capital_height(100.0)).abs() < 2.0);
        let lowest = printable().map(|letter| bounds(&letter.to_string()).max.y).fold(0.0, f32::max);
        assert!((lowest - text_size("", 100.0)[1]).abs() < 2.0, "{lowest}");
    }

    #[test]
    fn digits_have_one_width_so_that_numbers_line_up() {
        let width = |text: &str| text_size(text, 12.0)[0];
        assert!(('0'..='9').all(|digit| width(&digit.to_string()) == width("0")));
        // The rounding of a sum.
        assert!((width("10.5") - (3.0 * width("0") + width("."))).abs() < 1e-4);
    }
}
