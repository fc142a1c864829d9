//! The pages of a lightmap as images in a GLB file.

use crate::lightmap::{Curve, dithered, dithered_over, encode_rgb, shared_exponent};
use glam::Vec3;
use lumel_scene::Material;
use std::io;

/// A page as a PNG image of 8 bits.
pub(super) struct PageImage {
    pub(super) png: Vec<u8>,
    /// What the largest byte stands for.
    pub(super) scale: f32,
    /// The same in more digits, if bytes are linear: too coarse for what is dark.
    pub(super) fine: Option<FineImage>,
}

/// Rows of lumels of 32 bits, which share an exponent.
#[derive(Clone)]
pub(super) struct FineImage {
    pub(super) size: [u32; 2],
    pub(super) words: Vec<u8>,
}

/// Images that materials show.
pub(super) struct PageImages {
    images: Vec<PageImage>,
    n_pages: usize,
}

impl PageImages {
    /// Of light by lumel of each page. If there are twice as many as pages, the second half is for what emits: what is
    /// bright has an image of its own, because all that is in one image with it has few steps.
    pub(super) fn new(pages: &[[u32; 2]], light: &[Vec<Vec3>], curve: Curve) -> io::Result<Self> {
        Self::encoded(pages, light, |values, size| {
            let (scale, bytes) = dithered(values, size[0], curve);
            let fine =
                (curve == Curve::Linear).then(|| FineImage { size, words: shared_exponent(values, scale) });
            (scale, bytes, fine)
        })
    }

    /// Of shares from 0 to 1 by lumel of each page: the largest byte stands for 1.
    pub(super) fn of_shares(pages: &[[u32; 2]], shares: &[Vec<Vec3>]) -> io::Result<Self> {
        let bytes = |values: &[Vec3], [width, _]: [u32; 2]| dithered_over(1.0, values, width, Curve::Linear);
        Self::encoded(pages, shares, |values, size| (1.0, bytes(values, size), None))
    }

    fn encoded(
        pages: &[[u32; 2]],
        values: &[Vec<Vec3>],
        encoded: impl Fn(&[Vec3], [u32; 2]) -> (f32, Vec<u8>, Option<FineImage>),
    ) -> io::Result<Self> {
        let image = |(values, &size): (&Vec<Vec3>, &[u32; 2])| {
            let (scale, bytes, fine) = encoded(values, size);
            let mut png = Vec::new();
            encode_rgb(&mut png, size, ::png::BitDepth::Eight, &bytes, &[])?;
            Ok(PageImage { png, scale, fine })
        };
        let images = values.iter().zip(pages.iter().cycle()).map(image).collect::<io::Result<_>>()?;
        Ok(Self { images, n_pages: pages.len() })
    }

    /// Which image has the light of a material on a page.
    pub(super) fn place(&self, page: usize, material: &Material) -> usize {
        let apart = material.emits() && self.images.len() > self.n_pages;
        if apart { page + self.n_pages } else { page }
    }

    pub(super) fn image(&self, place: usize) -> &PageImage {
        &self.images[place]
    }
}
