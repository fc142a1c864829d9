//! Points of a textured triangle in proportion to the light that they send.

use crate::texel_sums::TexelSums;
use glam::DVec2;
use lumel_sample::{PiecewiseConstant2D, uniform_triangle};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TextureRef, TriId, luminance};

/// Pieces whose brightness differs by no more than this factor are taken for one: then the solid angle matters more.
const EVEN: f32 = 2.0;

/// The share of a piece's weight that is the mean of the texels around it, so that none that is lit is missed; the rest is
/// that of a few points in it.
const AROUND: f64 = 0.5;

/// The density of a triangle's emission, constant on each of `n × n` equal pieces.
///
/// The pieces of a row lie side by side along the first barycentric, those that point up and those that point down in turn.
#[derive(Clone, Debug)]
pub(crate) struct TexelDensity {
    n: usize,
    pieces: PiecewiseConstant2D,
    mean: f64,
    mean_square: f64,
}

impl TexelDensity {
    /// The same everywhere; `None` if that is nothing.
    pub(crate) fn even(luminance: f64) -> Option<Self> {
        let pieces = PiecewiseConstant2D::new(&[1.0, 0.0], 2, 1)?;
        let (mean, mean_square) = (luminance, luminance * luminance);
        (luminance > 0.0).then_some(Self { n: 1, pieces, mean, mean_square })
    }

    /// `None` where a triangle sends nothing.
    pub(crate) fn new(scene: &Scene, at: &Footprint<'_>, n: usize) -> Option<Self> {
        let weights = at.weights(scene, n);
        let pieces = || piece_indices(n).map(|i| weights[i]);
        let (low, high) = pieces().fold((f32::INFINITY, 0f32), |(low, high), w| (low.min(w), high.max(w)));
        let mean_of = |power: i32| pieces().map(|w| f64::from(w).powi(power)).sum::<f64>() / (n * n) as f64;
        let (mean, mean_square) = (mean_of(1), mean_of(2));
        if high <= EVEN * low {
            return Self::even(mean);
        }
        let pieces = PiecewiseConstant2D::new(&weights, 2 * n, n)?;
        Some(Self { n, pieces, mean, mean_square })
    }

    /// Whether all of the triangle sends about the same.
    pub(crate) fn is_even(&self) -> bool {
        self.n == 1
    }

    /// The mean luminance over the triangle, about.
    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// The mean square of the luminance, about.
    pub(crate) fn mean_square(&self) -> f64 {
        self.mean_square
    }

    /// A point and the density there, which is one on average over the triangle.
    pub(crate) fn sample(&self, u: [f32; 2]) -> (Barycentrics, f32) {
        let (place, pdf) = self.pieces.sample(u);
        let (column, x) = split(place[0], 2 * self.n);
        let (row, y) = split(place[1], self.n);
        let within = uniform_triangle([x, y]);
        let points_up = column % 2 == 0;
        let [u, v] = if points_up { within } else { within.map(|w| 1.0 - w) };
        let n = self.n as f32;
        let (u, v) = (((column / 2) as f32 + u) / n, (row as f32 + v) / n);
        (Barycentrics { u, v: v.min(1.0 - u) }, 0.5 * pdf)
    }

    /// The density at a point.
    pub(crate) fn pdf(&self, at: Barycentrics) -> f32 {
        let n = self.n;
        let (column, x) = split(at.u.clamp(0.0, 1.0), n);
        let (row, y) = split(at.v.clamp(0.0, 1.0), n);
        let column = column.min(n - 1 - row);
        // Rounding must not lead over the triangle's edge.
        let points_down = x + y >= 1.0 && column + row + 1 < n;
        let place = [2 * column + usize::from(points_down), row];
        let middle = [(place[0] as f64 + 0.5) / (2 * n) as f64, (row as f64 + 0.5) / n as f64];
        0.5 * self.pieces.pdf(middle.map(|x| x as f32))
    }
}

/// The cell of `n` that holds a coordinate, and the place within it.
fn split(x: f32, n: usize) -> (usize, f32) {
    let scaled = f64::from(x) * n as f64;
    let cell = (scaled as usize).min(n - 1);
    (cell, ((scaled - cell as f64) as f32).clamp(0.0, 1.0 - f32::EPSILON))
}

/// Where the pieces of a triangle are in rows of `2n`.
fn piece_indices(n: usize) -> impl Iterator<Item = usize> {
    (0..n).flat_map(move |row| (0..2 * (n - row) - 1).map(move |column| row * 2 * n + column))
}

/// A triangle and the part of its material's emission texture that it shows.
pub(crate) struct Footprint<'a> {
    pub(crate) tri: TriId,
    sums: &'a TexelSums,
    /// Texture coordinates of the corners.
    corners: [DVec2; 3],
}

impl<'a> Footprint<'a> {
    /// `None` if it shows black texels alone.
    pub(crate) fn new(scene: &Scene, texture: TextureRef, sums: &'a TexelSums, tri: TriId) -> Option<Self> {
        let uv = |bary| texture.transform.apply(scene.uv(SurfacePoint { tri, bary })).as_dvec2();
        let new = Self { tri, sums, corners: Barycentrics::CORNERS.map(uv) };
        let has_place = new.corners.iter().all(|corner| corner.is_finite());
        (!has_place || new.mean(new.corners) > 0.0).then_some(new)
    }

    /// Into how many pieces an edge is split, so that each is about a texel wide.
    pub(crate) fn wanted(&self, most: usize) -> usize {
        let [a, b, c] = self.corners;
        let size = self.sums.size().map(f64::from);
        let extent = a.max(b).max(c) - a.min(b).min(c);
        let texels = (extent.x * size[0]).max(extent.y * size[1]);
        if texels.is_finite() { (texels.ceil() as usize).clamp(1, most) } else { 1 }
    }

    fn mean(&self, [a, b, c]: [DVec2; 3]) -> f64 {
        self.sums.mean(a.min(b).min(c), a.max(b).max(c))
    }

    /// The brightness of each piece, in rows of `2n`.
    fn weights(&self, scene: &Scene, n: usize) -> Vec<f32> {
        let emission = |[u, v]: [f64; 2]| {
            let bary = Barycentrics { u: (u / n as f64) as f32, v: (v / n as f64) as f32 };
            f64::from(luminance(scene.emission(SurfacePoint { tri: self.tri, bary }).0))
        };
        if !self.corners.iter().all(|corner| corner.is_finite()) {
            return vec![emission([0.0; 2]) as f32; 2 * n * n];
        }
        let [a, b, c] = self.corners;
        let uv = |[u, v]: [f64; 2]| c + (a - c) * (u / n as f64) + (b - c) * (v / n as f64);
        let mut weights = vec![0.0; 2 * n * n];
        for at in piece_indices(n) {
            let (column, row) = (at % (2 * n), at / (2 * n));
            let [u, v] = [(column / 2) as f64, row as f64];
            let corners = match column % 2 {
                0 => [[u, v], [u + 1.0, v], [u, v + 1.0]],
                _ => [[u + 1.0, v + 1.0], [u + 1.0, v], [u, v + 1.0]],
            };
            let around = self.mean(corners.map(uv));
            if around > 0.0 {
                let middle = [0, 1].map(|axis| corners.map(|corner| corner[axis]).iter().sum::<f64>() / 3.0);
                let seen = (corners.map(emission).iter().sum::<f64>() + emission(middle)) / 4.0;
                weights[at] = (AROUND * around + (1.0 - AROUND) * seen) as f32;
            }
        }
        weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};
    use lumel_sample::{Dim, Sampler, StreamKey};
    use lumel_scene::{
        Face, Filter, Material, MaterialId, ObjectMesh, Radiance, SceneBuilder, Smoothing, Texture,
        TextureId, TextureRef, Wrap,
    };

    const EMISSION: Vec3 = Vec3::new(1.0, 2.0, 3.0);

    /// A triangle with a picture of 16 × 16 texels, turned and more than once across.
    fn scene(texels: Vec<[f32; 3]>, filter: Filter) -> Scene {
        let mut texture = Texture::from_floats("picture", 16, 16, texels).unwrap();
        (texture.wrap_u, texture.filter) = (Wrap::Mirror, filter);
        let mut material = Material::diffuse("panel", Vec3::ONE);
        material.emission = Radiance(EMISSION);
        material.emission_texture = Some(TextureRef::plain(TextureId(0)));
        let panel = ObjectMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: vec![Vec2::new(-0.2, 0.1), Vec2::new(1.1, 0.3), Vec2::new(0.2, 1.4)],
            faces: vec![Face {
                vertices: [0, 1, 2],
                material: MaterialId(0),
                smoothing: Smoothing::default(),
            }],
            ..ObjectMesh::default()
        };
        let (objects, materials, textures) = (vec![panel], vec![material], vec![texture]);
        SceneBuilder { objects, materials, textures, ..SceneBuilder::default() }.build().unwrap().0
    }

    fn density(scene: &Scene, n: usize) -> Option<TexelDensity> {
        let sums = TexelSums::new(&scene.textures()[0], |texel| luminance(texel * EMISSION))?;
        let footprint = Footprint::new(scene, TextureRef::plain(TextureId(0)), &sums, TriId(0))?;
        TexelDensity::new(scene, &footprint, n)
    }

    fn emission(scene: &Scene, bary: Barycentrics) -> f64 {
        f64::from(luminance(scene.emission(SurfacePoint { tri: TriId(0), bary }).0))
    }

    fn pictures() -> impl Iterator<Item = Scene> {
        let some = (0..256).map(|i| [if i % 5 == 0 { (i % 7) as f32 } else { 0.0 }; 3]).collect();
        let one = (0..256).map(|i| [if i == 116 { 1.0 } else { 0.0 }; 3]).collect();
        let pictures: [Vec<[f32; 3]>; 2] = [some, one];
        let filters = [Filter::Linear, Filter::Nearest];
        pictures.into_iter().flat_map(move |texels| filters.map(|filter| scene(texels.clone(), filter)))
    }

    /// The middles of pieces, far finer than those of densities.
    fn everywhere() -> impl Iterator<Item = Barycentrics> {
        const N: u32 = 512;
        let at = |i: u32, shift: f32| (i as f32 + shift) / N as f32;
        (0..N).flat_map(move |j| {
            (0..N - j).flat_map(move |i| {
                let up = Barycentrics { u: at(i, 1.0 / 3.0), v: at(j, 1.0 / 3.0) };
                let down = Barycentrics { u: at(i, 2.0 / 3.0), v: at(j, 2.0 / 3.0) };
                [Some(up), (i + j + 1 < N).then_some(down)].into_iter().flatten()
            })
        })
    }

    #[test]
    fn the_density_is_one_on_average_and_positive_where_the_triangle_shines() {
        for scene in pictures() {
            for n in [1, 3, 16, 64] {
                let density = density(&scene, n).unwrap();
                let (mut sum, mut points) = (0.0, 0.0);
                for bary in everywhere() {
                    let pdf = density.pdf(bary);
                    assert!(pdf > 0.0 || emission(&scene, bary) == 0.0, "n = {n}, {bary:?}");
                    sum += f64::from(pdf);
                    points += 1.0;
                }
                // A grid of 512 cells does not divide by three.
                let slack = if n == 3 { 1e-2 } else { 1e-5 };
                assert!((sum / points - 1.0).abs() < slack, "n = {n}: {}", sum / points);
            }
        }
    }

    #[test]
    fn samples_have_the_density_they_were_drawn_with_and_find_the_power() {
        for scene in pictures() {
            let n_points = everywhere().count() as f64;
            let truth = everywhere().map(|bary| emission(&scene, bary)).sum::<f64>() / n_points;
            for n in [1, 3, 16, 64] {
                let density = density(&scene, n).unwrap();
                let stream = Sampler::Sobol.stream(StreamKey::new(1), Dim::Light(0));
                const SAMPLES: u32 = 1 << 14;
                let (mut power, mut same) = (0.0, 0);
                for i in 0..SAMPLES {
                    let (bary, pdf) = density.sample(stream.sample_2d(i));
                    assert!(pdf > 0.0 && bary.weights().iter().all(|w| (0.0..=1.0).contains(w)), "{bary:?}");
                    // On the edge of a piece, rounding may find its neighbour.
                    same += i32::from(density.pdf(bary) == pdf);
                    power += emission(&scene, bary) / f64::from(pdf) / f64::from(SAMPLES);
                }
                assert!(f64::from(same) > 0.999 * f64::from(SAMPLES), "n = {n}: {same}");
                // Of one piece, 1 of 170 samples finds the one texel.
                let slack = if n < 16 { 3e-2 } else { 5e-3 };
                assert!((power / truth - 1.0).abs() < slack, "n = {n}: {power} {truth}");
            }
        }
    }

    #[test]
    fn even_pictures_are_not_cut_and_black_ones_send_nothing() {
        let even = density(&scene(vec![[0.5; 3]; 256], Filter::Linear), 16).unwrap();
        assert!(even.is_even());
        assert!((even.mean() - 0.5 * f64::from(luminance(EMISSION))).abs() < 1e-6);
        assert_eq!(even.sample([0.3, 0.6]).1, 1.0);
        assert!(density(&scene(vec![[0.0; 3]; 256], Filter::Linear), 16).is_none());
    }
}
