//! Where the light of each triangle is stored.

use glam::Vec2;
use lumel_scene::{ObjectId, TriId};

/// Places for the light of all triangles of a scene, backs included.
///
/// Coordinates are in lumels of a page: the centre of lumel (x, y) is at (x + ½, y + ½), and y runs down. All triangles
/// of a chart have areas of one sign: positive, unless a file gives the layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas {
    pub(crate) pages: Vec<[u32; 2]>,
    /// Lumels per metre of an object whose factor is 1.
    pub(crate) density: f32,
    pub(crate) gutter: u32,
    /// By triangle.
    pub(crate) corners: Vec<[Vec2; 3]>,
    /// By triangle.
    pub(crate) charts: Vec<u32>,
    pub(crate) places: Vec<ChartPlace>,
}

/// Where a chart lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartPlace {
    /// The object whose surface it is.
    pub object: ObjectId,
    /// The page.
    pub page: u32,
    /// The first column and row of its lumels.
    pub min: [u32; 2],
    /// The column and row after its last ones.
    pub max: [u32; 2],
    /// Lumels per metre, on average where a file gives the layout.
    pub density: f32,
}

impl Atlas {
    /// Width and height of the pages, lumels.
    pub fn pages(&self) -> &[[u32; 2]] {
        &self.pages
    }

    /// Lumels per metre of an object whose factor is 1.
    pub fn density(&self) -> f32 {
        self.density
    }

    /// Lumels whose centres are nearer to a chart than half of this are its own.
    pub fn gutter(&self) -> u32 {
        self.gutter
    }

    /// Number of triangles: those of the scene.
    pub fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    /// The corners of a triangle on its page, lumels.
    #[inline]
    pub fn corners(&self, tri: TriId) -> [Vec2; 3] {
        self.corners[tri.index()]
    }

    /// The chart of a triangle: an index into [`charts`](Self::charts).
    #[inline]
    pub fn chart(&self, tri: TriId) -> usize {
        self.charts[tri.index()] as usize
    }

    /// The page of a triangle.
    #[inline]
    pub fn page(&self, tri: TriId) -> usize {
        self.places[self.chart(tri)].page as usize
    }

    /// Where the charts lie.
    pub fn charts(&self) -> &[ChartPlace] {
        &self.places
    }

    /// The corners of a triangle as texture coordinates: 0 to 1 over the page, `v` down.
    pub fn texture_coordinates(&self, tri: TriId) -> [Vec2; 3] {
        let [width, height] = self.pages[self.page(tri)];
        let size = Vec2::new(width as f32, height as f32);
        self.corners(tri).map(|corner| corner / size)
    }

    /// Number of lumels on all pages.
    pub fn lumel_count(&self) -> usize {
        self.pages.iter().map(|[width, height]| *width as usize * *height as usize).sum()
    }

    /// The index of the first lumel of a page; the others follow row by row.
    pub fn first_lumel(&self, page: usize) -> usize {
        self.pages[..page].iter().map(|[width, height]| *width as usize * *height as usize).sum()
    }

    /// The page of a lumel and its column and row there; the inverse of [`first_lumel`](Self::first_lumel).
    pub fn column_and_row(&self, lumel: usize) -> (usize, [u32; 2]) {
        let mut left = lumel;
        for (page, &[width, height]) in self.pages.iter().enumerate() {
            let (width, lumels) = (width as usize, width as usize * height as usize);
            if left < lumels {
                return (page, [(left % width) as u32, (left / width) as u32]);
            }
            left -= lumels;
        }
        (self.pages.len(), [0, 0])
    }

    /// A hash of all that decides which lumels hold the light of which surface.
    pub fn identity(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        let mut add = |words: &[u32]| {
            words.iter().for_each(|word| {
                hasher.update(&word.to_le_bytes());
            });
        };
        add(&[1, self.pages.len() as u32, self.corners.len() as u32]);
        self.pages.iter().for_each(|page| add(page));
        for (corners, &chart) in self.corners.iter().zip(&self.charts) {
            add(&[chart, self.places[chart as usize].page]);
            corners.iter().for_each(|corner| add(&corner.to_array().map(f32::to_bits)));
        }
        hasher.finalize()
    }
}
