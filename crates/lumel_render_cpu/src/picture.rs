//! Finished pictures.

use crate::PictureError;
use crate::canvas::Canvas;
use crate::resolution::check_size;

/// A picture of 8 bits per channel, sRGB, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
    stops: Option<f32>,
    range: Option<[f32; 2]>,
}

/// The background between and below joined pictures.
const PAPER: [u8; 3] = [255; 3];

impl Picture {
    /// A picture of these pixels, row by row from the top.
    ///
    /// # Errors
    /// [`PictureError::Size`] and [`PictureError::PixelCount`].
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 3]>) -> Result<Self, PictureError> {
        check_size(u64::from(width), u64::from(height))?;
        if u64::from(width) * u64::from(height) != pixels.len() as u64 {
            return Err(PictureError::PixelCount { width, height, count: pixels.len() });
        }
        Ok(Self { width, height, pixels, stops: None, range: None })
    }

    /// Pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The exposure it was drawn with, stops; `None` if it has none.
    pub fn stops(&self) -> Option<f32> {
        self.stops
    }

    /// The range of its false colours, W·m⁻²; `None` if it has none.
    pub fn range(&self) -> Option<[f32; 2]> {
        self.range
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The pixel at column `x` of row `y`, counted from the top left; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        let inside = x < self.width && y < self.height;
        inside.then(|| self.pixels[y as usize * self.width as usize + x as usize])
    }

    /// A label on a strip at the bottom left: printable ASCII, `²` and `×`; other letters become boxes.
    ///
    /// Text scales with the picture; a label that does not fit is clipped.
    #[must_use]
    pub fn labelled(mut self, text: &str) -> Self {
        let mut canvas = self.canvas();
        let scale = canvas.text_scale();
        let [text_width, text_height] = Canvas::text_size(text, scale);
        let (pad, bottom) = (i64::from(3 * scale), canvas.height());
        let top = bottom - text_height - 2 * pad;
        canvas.shade([0, top], [text_width + 2 * pad, bottom - top]);
        canvas.text([pad, top + pad], scale, text);
        self
    }

    /// Pictures side by side from left to right, separated by a gap and aligned at the top.
    ///
    /// # Errors
    /// [`PictureError::NoPictures`], and [`PictureError::Size`] if the result would be too large.
    pub fn beside(pictures: &[Self]) -> Result<Self, PictureError> {
        let height = pictures.iter().map(|p| p.height).max().ok_or(PictureError::NoPictures)?;
        let gap = u64::from(height.div_ceil(100));
        let widths: u64 = pictures.iter().map(|p| u64::from(p.width)).sum();
        let width = widths + gap * (pictures.len() as u64 - 1);
        check_size(width, u64::from(height))?;
        let mut pixels = Vec::with_capacity((width * u64::from(height)) as usize);
        for y in 0..height {
            for (i, picture) in pictures.iter().enumerate() {
                let gap = if i == 0 { 0 } else { gap as usize };
                pixels.extend(std::iter::repeat_n(PAPER, gap));
                match picture.row(y) {
                    Some(row) => pixels.extend_from_slice(row),
                    None => pixels.extend(std::iter::repeat_n(PAPER, picture.width as usize)),
                }
            }
        }
        Self::new(width as u32, height, pixels)
    }

    fn row(&self, y: u32) -> Option<&[[u8; 3]]> {
        self.pixels.chunks_exact(self.width as usize).nth(y as usize)
    }

    pub(crate) fn exposed(self, stops: Option<f32>) -> Self {
        Self { stops, ..self }
    }

    pub(crate) fn ranged(self, range: [f32; 2]) -> Self {
        Self { range: Some(range), ..self }
    }

    pub(crate) fn canvas(&mut self) -> Canvas<'_> {
        Canvas::new(&mut self.pixels, self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(width: u32, height: u32, color: [u8; 3]) -> Picture {
        Picture::new(width, height, vec![color; (width * height) as usize]).unwrap()
    }

    #[test]
    fn pictures_beside_each_other_keep_their_pixels() {
        let both = Picture::beside(&[plain(3, 4, [1; 3]), plain(2, 2, [2; 3])]).unwrap();
        assert_eq!((both.width(), both.height()), (3 + 1 + 2, 4));
        let row = |y| [0, 1, 2, 3, 4, 5].map(|x| both.pixel(x, y).unwrap()[0]);
        assert_eq!(row(0), [1, 1, 1, 255, 2, 2]);
        assert_eq!(row(3), [1, 1, 1, 255, 255, 255]);
        assert_eq!(both.pixel(6, 0), None);
        assert_eq!(Picture::beside(&[]), Err(PictureError::NoPictures));
        let one = plain(3, 3, [9; 3]);
        assert_eq!(Picture::beside(std::slice::from_ref(&one)), Ok(one));
    }

    #[test]
    fn pixels_must_fill_the_picture() {
        assert!(matches!(Picture::new(2, 2, vec![[0; 3]; 3]), Err(PictureError::PixelCount { .. })));
        assert!(matches!(Picture::new(0, 2, vec![]), Err(PictureError::Size { .. })));
        let wide = plain(1 << 20, 1, [0; 3]);
        let row = vec![wide; 33];
        assert!(matches!(Picture::beside(&row), Err(PictureError::Size { .. })));
    }

    #[test]
    fn labels_lie_at_the_bottom_left_and_are_cut_to_the_picture() {
        let picture = plain(200, 100, [200; 3]).labelled("ab 1.5");
        assert_eq!(picture.pixel(199, 99), Some([200; 3]));
        assert_eq!(picture.pixel(0, 80), Some([200; 3]));
        assert!(picture.pixel(0, 99).unwrap()[0] < 100);
        assert!(picture.pixels().contains(&[255; 3]));
        for (width, height) in [(1, 1), (5, 3), (30, 200)] {
            let picture = plain(width, height, [7; 3]).labelled("a long label that cannot fit\u{fc}");
            assert_eq!((picture.width(), picture.height()), (width, height));
        }
        assert_eq!(plain(9, 9, [7; 3]).labelled("").pixels().len(), 81);
    }
}
