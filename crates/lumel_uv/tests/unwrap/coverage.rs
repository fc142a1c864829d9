//! What lies in each lumel.

use crate::meshes::all;
use crate::{built, settings, unwrapped};
use lumel_scene::TriId;
use lumel_uv::{Coverage, Piece};

#[test]
fn the_shares_of_a_triangle_add_up_to_its_area() {
    for (name, builder) in all() {
        let scene = built(builder);
        let atlas = unwrapped(&scene, &settings()).atlas;
        let coverage = Coverage::new(&atlas);
        let mut sums = vec![0.0; scene.triangle_count()];
        for place in 0..coverage.len() {
            coverage.shares(place).iter().for_each(|share| sums[share.tri.index()] += f64::from(share.area));
        }
        for (tri, sum) in sums.into_iter().enumerate() {
            let [a, b, c] = atlas.corners(TriId(tri as u32)).map(|corner| corner.as_dvec2());
            let area = 0.5 * (b - a).perp_dot(c - a);
            assert!((sum - area).abs() < 1e-4 * area + 2e-5, "{name}: {sum} of {area}");
        }
    }
}

#[test]
fn all_four_lumels_that_are_read_at_a_point_belong_to_its_chart() {
    for (name, builder) in all() {
        let scene = built(builder);
        let atlas = unwrapped(&scene, &settings()).atlas;
        let coverage = Coverage::new(&atlas);
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            let [a, b, c] = atlas.corners(tri).map(|corner| corner.as_dvec2());
            let first = atlas.first_lumel(atlas.page(tri));
            let width = atlas.pages()[atlas.page(tri)][0] as usize;
            for [u, v] in [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.3, 0.3], [0.5, 0.5], [0.9, 0.05]] {
                let at = a * u + b * v + c * (1.0 - u - v) - 0.5;
                let (low, part) = (at.floor(), at - at.floor());
                let mut weight = 0.0;
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let lumel = first + (low.y as usize + dy) * width + low.x as usize + dx;
                    let of = |part: f64, d: usize| if d == 1 { part } else { 1.0 - part };
                    let Ok(place) = coverage.lumels().binary_search(&(lumel as u32)) else { continue };
                    let of_chart =
                        coverage.shares(place).iter().all(|share| atlas.chart(share.tri) == atlas.chart(tri));
                    assert!(of_chart, "{name}");
                    weight += of(part.x, dx) * of(part.y, dy);
                }
                assert!(weight > 0.999, "{name}: {weight}");
            }
        }
    }
}

#[test]
fn pieces_lie_in_their_lumel_and_points_are_spread_over_them_by_area() {
    let scene = built(all().remove(1).1);
    let atlas = unwrapped(&scene, &settings()).atlas;
    let coverage = Coverage::new(&atlas);
    let mut n_pieces = 0;
    for place in (0..coverage.len()).step_by(7) {
        for share in coverage.shares(place) {
            let page = atlas.page(share.tri);
            let width = atlas.pages()[page][0] as usize;
            let lumel = coverage.lumels()[place] as usize - atlas.first_lumel(page);
            let [x, y] = [lumel % width, lumel / width];
            let piece = Piece::new(&atlas, share.tri, [x as u32, y as u32]).unwrap();
            assert!((piece.area() - share.area).abs() < 2e-6);
            let corners = atlas.corners(share.tri).map(|corner| corner.as_dvec2());
            let page_of = |at: lumel_scene::SurfacePoint| {
                let [u, v, w] = at.bary.weights().map(f64::from);
                corners[0] * u + corners[1] * v + corners[2] * w
            };
            let reach = if share.area > 0.0 { 1e-3 } else { 0.92 };
            let mut mean = glam::DVec2::ZERO;
            for i in 0..16 {
                let at = page_of(piece.point([(i % 4) as f32 / 4.0 + 0.125, (i / 4) as f32 / 4.0 + 0.125]));
                assert!(at.x > x as f64 - reach && at.x < (x + 1) as f64 + reach, "{at} {x}");
                assert!(at.y > y as f64 - reach && at.y < (y + 1) as f64 + reach, "{at} {y}");
                mean += at / 16.0;
            }
            if piece.area() == 1.0 {
                let center = glam::DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                assert!(mean.distance(center) < 0.05, "{mean} {center}");
                assert_eq!(piece.corners().len(), 4);
            }
            n_pieces += 1;
        }
    }
    assert!(n_pieces > 5000, "{n_pieces}");
}
