//! Boxes and text on pixels.

use crate::font::{self, GLYPH_HEIGHT, GLYPH_WIDTH, glyph};

/// Pixels to draw on; what lies outside is cut.
pub(crate) struct Canvas<'a> {
    pixels: &'a mut [[u8; 3]],
    width: u32,
    height: u32,
}

/// Letters.
pub(crate) const INK: [u8; 3] = [255; 3];

/// How much of the picture remains under a shade, in 1/256.
const UNDER_SHADE: u16 = 72;

/// Pictures get one more pixel per dot of a letter for every so many rows.
const ROWS_PER_DOT: u32 = 300;

impl<'a> Canvas<'a> {
    pub(crate) fn new(pixels: &'a mut [[u8; 3]], width: u32, height: u32) -> Self {
        Self { pixels, width, height }
    }

    pub(crate) fn width(&self) -> i64 {
        i64::from(self.width)
    }

    pub(crate) fn height(&self) -> i64 {
        i64::from(self.height)
    }

    /// Pixels per dot of a letter, for letters of the same size in pictures of any size.
    pub(crate) fn text_scale(&self) -> u32 {
        self.height.div_ceil(ROWS_PER_DOT)
    }

    /// Width and height of a line of text.
    pub(crate) fn text_size(text: &str, scale: u32) -> [u32; 2] {
        // Letters are one dot apart.
        let dots = (text.chars().count() as u32).saturating_mul(GLYPH_WIDTH + 1).saturating_sub(1);
        [dots.saturating_mul(scale), GLYPH_HEIGHT * scale]
    }

    pub(crate) fn fill(&mut self, at: [i64; 2], size: [i64; 2], color: [u8; 3]) {
        self.change(at, size, |pixel| *pixel = color);
    }

    /// Darkens, so that text can be read on it.
    pub(crate) fn shade(&mut self, at: [i64; 2], size: [i64; 2]) {
        self.change(at, size, |pixel| *pixel = pixel.map(|c| (u16::from(c) * UNDER_SHADE / 256) as u8));
    }

    fn change(&mut self, [x, y]: [i64; 2], [w, h]: [i64; 2], change: impl Fn(&mut [u8; 3])) {
        let clip = |from: i64, length: i64, end: u32| {
            let end = i64::from(end);
            from.clamp(0, end) as usize..(from + length).clamp(0, end) as usize
        };
        let (columns, rows) = (clip(x, w, self.width), clip(y, h, self.height));
        if columns.is_empty() {
            return;
        }
        for row in rows {
            let start = row * self.width as usize;
            self.pixels[start + columns.start..start + columns.end].iter_mut().for_each(&change);
        }
    }

    /// Draws a line of text with its top left at a pixel.
    pub(crate) fn text(&mut self, [x, y]: [i64; 2], scale: u32, text: &str) {
        let dot = i64::from(scale);
        let advance = i64::from(GLYPH_WIDTH + 1) * dot;
        for (i, letter) in text.chars().enumerate() {
            let left = x + i as i64 * advance;
            if left >= self.width() {
                break;
            }
            for (dot_x, dot_y) in font::dots(glyph(letter)) {
                let at = [left + i64::from(dot_x) * dot, y + i64::from(dot_y) * dot];
                self.fill(at, [dot, dot], INK);
            }
        }
    }
}
