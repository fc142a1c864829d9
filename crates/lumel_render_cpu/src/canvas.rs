//! Boxes and text on pixels.

use crate::font;

/// Pixels to draw on; everything is clipped to them.
pub(crate) struct Canvas<'a> {
    pixels: &'a mut [[u8; 3]],
    width: u32,
    height: u32,
}

/// The colour of text and lines.
pub(crate) const INK: [u8; 3] = [255; 3];

/// The fraction of the picture that remains under a shade, in 1/256.
const UNDER_SHADE: u16 = 72;

/// Text and lines get one more pixel per unit for every so many rows.
const ROWS_PER_UNIT: u32 = 300;

/// The size of the font, units.
const FONT_SIZE: f32 = 11.0;

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

    /// Pixels per unit, for text and lines of the same size in pictures of any size.
    pub(crate) fn text_scale(&self) -> u32 {
        self.height.div_ceil(ROWS_PER_UNIT)
    }

    /// Width and height of a line of text, pixels; from the top of capitals to the bottom of what hangs below the line.
    pub(crate) fn text_size(text: &str, scale: u32) -> [i64; 2] {
        font::text_size(text, FONT_SIZE * scale as f32).map(|length| length.ceil() as i64)
    }

    /// Height of digits, pixels.
    pub(crate) fn digit_height(scale: u32) -> i64 {
        font::capital_height(FONT_SIZE * scale as f32).round() as i64
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

    /// Draws a line of text; the top of its capitals is at `y`.
    pub(crate) fn text(&mut self, [x, y]: [i64; 2], scale: u32, text: &str) {
        for outline in font::outlines(text, FONT_SIZE * scale as f32) {
            let bounds = outline.px_bounds();
            let [left, top] = [x + bounds.min.x as i64, y + bounds.min.y as i64];
            if left >= self.width() {
                break;
            }
            outline.draw(|column, row, coverage| {
                self.change([left + i64::from(column), top + i64::from(row)], [1, 1], |pixel| {
                    *pixel = mixed(*pixel, coverage);
                });
            });
        }
    }
}

/// A pixel of which ink covers a part.
fn mixed(under: [u8; 3], coverage: f32) -> [u8; 3] {
    let mix = |under: u8, ink: u8| {
        let (under, ink) = (f32::from(under), f32::from(ink));
        (under + (ink - under) * coverage.clamp(0.0, 1.0)).round() as u8
    };
    [0, 1, 2].map(|channel| mix(under[channel], INK[channel]))
}
