//! Where the middles of lumels lie on the surfaces.

use crate::coverage::{each_square, nearest};
use crate::{Atlas, Coverage};
use glam::DVec2;
use lumel_scene::{SurfacePoint, TriId};

/// How far beyond triangles the middles of lumels are that belong to them.
const MARGIN: f64 = 1.0;

impl Coverage {
    /// The point nearest to the middle of each lumel on triangles of the same chart; `None` where there is none within a lumel.
    ///
    /// `atlas` is the one of the coverage, and `parts` has the places of the same surfaces, in smaller triangles perhaps: see
    /// [`Atlas::refined`].
    pub fn middles(&self, atlas: &Atlas, parts: &Atlas) -> Vec<Option<SurfacePoint>> {
        let mut places = vec![usize::MAX; atlas.lumel_count()];
        self.lumels().iter().enumerate().for_each(|(place, &lumel)| places[lumel as usize] = place);
        let mut best = vec![(f64::INFINITY, None); self.len()];
        for tri in (0..parts.triangle_count() as u32).map(TriId) {
            let (page, corners) = (parts.page(tri), parts.corners(tri).map(|c| c.as_dvec2()));
            let ([width, height], first) = (atlas.pages()[page].map(i64::from), atlas.first_lumel(page));
            each_square(corners, MARGIN, |x, y| {
                let is_on_page = (0..width).contains(&x) && (0..height).contains(&y);
                let Some(place) = is_on_page.then(|| places[first + (y * width + x) as usize]) else {
                    return;
                };
                let Some(best) = best.get_mut(place) else { return };
                let (bary, distance) = nearest(corners, DVec2::new(x as f64, y as f64) + 0.5);
                if distance < best.0 && atlas.chart(self.shares(place)[0].tri) == parts.chart(tri) {
                    *best = (distance, Some(SurfacePoint { tri, bary }));
                }
            });
        }
        best.into_iter().map(|(_, middle)| middle).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{cube, face};
    use crate::{Pace, UnwrapSettings, unwrap};
    use glam::Vec3;
    use lumel_scene::{Face, Material, MaterialId, ObjectMesh, SceneBuilder};

    #[test]
    fn middles_of_small_triangles_are_where_those_of_the_whole_are() {
        let slanted = ObjectMesh {
            name: "slanted".into(),
            positions: [[3.0, 0.0, 0.0], [4.0, 0.1, 0.3], [4.2, 1.0, 0.2], [3.0, 1.3, 0.1]]
                .map(Vec3::from)
                .into(),
            faces: [[0, 1, 2], [0, 2, 3]]
                .map(|corners| Face { material: MaterialId(0), ..face(corners) })
                .into(),
            ..ObjectMesh::default()
        };
        let builder = SceneBuilder {
            materials: vec![Material::default()],
            objects: vec![cube(), slanted],
            ..SceneBuilder::default()
        };
        let mut split = builder.clone();
        split.tessellate(0.11).unwrap();
        let [whole, fine] = [builder, split].map(|builder| builder.build().unwrap().0);
        assert!(fine.triangle_count() > 10 * whole.triangle_count());
        let atlas = unwrap(&whole, &UnwrapSettings::default(), &|| Pace::Go).unwrap().atlas;
        let coverage = Coverage::new(&atlas);
        let [given, parts] =
            [&atlas, &atlas.refined(&whole, &fine)].map(|parts| coverage.middles(&atlas, parts));
        for (a, b) in given.iter().zip(&parts) {
            let (a, b) = (whole.position(a.unwrap()), fine.position(b.unwrap()));
            assert!(a.distance(b) < 1e-5, "{a} {b}");
        }
    }
}
