//! Light on the lumels of an atlas.

use crate::agreement::assert_same;
use crate::common::{Subject, Uploaded, differences, irradiance, looks, renderer, share_beyond};
use crate::scenes;
use glam::Vec3;
use lumel_basis::{Coefficients, Directional, IncidentRadiance, spherical_harmonics};
use lumel_lightmap::{Filter, Lightmap, LightmapLayer, LumelLighting};
use lumel_render_cpu::{Relief, Scale, ToneMapper};
use lumel_render_gpu::{Frame, Lit, Look, LumelBuffer, Samples, Tile, Values};
use lumel_scene::Scene;
use lumel_uv::{Atlas, Coverage, Density, Pace, UnwrapSettings, unwrap};

const SIZE: [u32; 2] = [173, 120];

/// An atlas of a subject's scene, of several pages, and light that differs from lumel to lumel.
struct Lumels {
    atlas: Atlas,
    values: Vec<Vec3>,
}

impl Lumels {
    fn new(subject: &Subject) -> Self {
        let settings = UnwrapSettings {
            density: Density::PerMetre(18.0),
            page_size: 96,
            gutter: 3,
            ..UnwrapSettings::default()
        };
        let atlas = unwrap(&subject.scene, &settings, &|| Pace::Go).unwrap().atlas;
        assert!(atlas.pages().len() > 1);
        let level = |lumel: usize, salt: usize| {
            0.3 + ((lumel.wrapping_mul(2_654_435_761) >> salt) % 1000) as f32 / 400.0
        };
        let value = |lumel: usize| Vec3::new(level(lumel, 5), level(lumel, 9), level(lumel, 13));
        let values = (0..atlas.lumel_count()).map(value).collect();
        Self { atlas, values }
    }

    fn lighting(&self, filter: Filter) -> LumelLighting<'_> {
        LumelLighting { atlas: &self.atlas, values: &self.values, filter }
    }

    /// The subject on the device, and the lumels as far as they are known.
    fn on<'a>(
        &self,
        subject: &'a Subject,
        known: impl Fn(usize) -> bool,
    ) -> Option<(Uploaded<'a>, LumelBuffer)> {
        let renderer = renderer()?;
        let model = renderer.upload_with_atlas(&subject.scene, &self.atlas).unwrap();
        let light = renderer.light(&model);
        renderer.set_light(&light, &subject.scene, &subject.lighting()).unwrap();
        let rect_lights = subject.rect_lights();
        let uploaded = Uploaded { renderer, subject, model, light, rect_lights, backdrop: None };
        let lumels = renderer.lumels(&self.atlas).unwrap();
        for (page, &size) in self.atlas.pages().iter().enumerate() {
            let first = self.atlas.first_lumel(page);
            let lumel = |i: u32| {
                let lumel = first + i as usize;
                known(lumel).then(|| self.values[lumel])
            };
            let tile = Tile { page, min: [0, 0], size };
            renderer.set_lumels(&lumels, &tile, (0..size[0] * size[1]).map(lumel));
        }
        Some((uploaded, lumels))
    }
}

/// A frame of lumels.
fn frame<'a>(uploaded: &'a Uploaded<'_>, lumels: &'a LumelBuffer, filter: Filter, look: Look) -> Frame<'a> {
    let light = Lit::One(Values::Lumels { lumels, filter, vertices: &uploaded.light });
    Frame { light, ..uploaded.frame(look) }
}

#[test]
fn light_on_lumels_looks_as_on_the_cpu() {
    let subject = scenes::everything();
    let map = Lumels::new(&subject);
    let Some((uploaded, lumels)) = map.on(&subject, |_| true) else { return };
    for filter in [Filter::Nearest, Filter::Bilinear, Filter::Bicubic] {
        let looks = match filter {
            Filter::Bilinear => looks(0.25, [0.2, 3.0]),
            _ => vec![irradiance(0.25), Look::FalseColor { range: [0.2, 3.0], scale: Scale::Linear }],
        };
        for look in looks {
            let device = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &lumels, filter, look));
            let cpu = subject.traced_under(&map.lighting(filter), SIZE, look);
            assert_same(&device, &cpu, &format!("{filter:?} {look:?}"));
        }
    }
}

#[test]
fn vertices_show_where_lumels_are_not_known() {
    let subject = scenes::everything();
    let map = Lumels::new(&subject);
    let look = irradiance(0.0);
    let Some((uploaded, none)) = map.on(&subject, |_| false) else { return };
    let at_vertices = uploaded.show(SIZE, Samples::One, look);
    assert_same(&at_vertices, &subject.traced(SIZE, look), "split vertices");
    let unknown = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &none, Filter::Bilinear, look));
    assert!(differences(&unknown, &at_vertices).iter().all(|d| *d <= 1));
    // One lumel after the other: each place shows one or the other.
    let renderer = uploaded.renderer;
    let tile = Tile { page: 0, min: [8, 0], size: [40, 60] };
    let width = map.atlas.pages()[0][0];
    let values = (0..60).flat_map(|y| (8..48).map(move |x| (y * width + x) as usize));
    renderer.set_lumels(&none, &tile, values.map(|lumel| Some(map.values[lumel])));
    let some = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &none, Filter::Nearest, look));
    let Some((_, whole)) = map.on(&subject, |_| true) else { return };
    let all = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &whole, Filter::Nearest, look));
    let pixels = some.pixels().iter().zip(all.pixels()).zip(at_vertices.pixels());
    let (mut of_lumels, mut of_vertices) = (0, 0);
    for ((some, all), at_vertices) in pixels.filter(|((_, all), at_vertices)| all != at_vertices) {
        assert!(some == all || some.iter().zip(at_vertices).all(|(a, b)| a.abs_diff(*b) <= 1));
        if some == all { of_lumels += 1 } else { of_vertices += 1 }
    }
    assert!(of_lumels > 100 && of_vertices > 100, "{of_lumels} {of_vertices}");
}

#[test]
fn tiles_that_are_not_on_a_page_change_nothing() {
    let subject = scenes::everything();
    let map = Lumels::new(&subject);
    let Some((uploaded, lumels)) = map.on(&subject, |_| true) else { return };
    let show =
        || uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &lumels, Filter::Bilinear, irradiance(0.0)));
    let before = show();
    let [width, height] = lumels.pages()[0];
    let beyond = [
        Tile { page: 0, min: [width - 1, 0], size: [2, 1] },
        Tile { page: 0, min: [0, u32::MAX], size: [1, height] },
        Tile { page: lumels.pages().len(), min: [0, 0], size: [1, 1] },
    ];
    for tile in beyond {
        let many = std::iter::repeat_n(Some(Vec3::ONE), 10_000);
        uploaded.renderer.set_lumels(&lumels, &tile, many);
    }
    let whole = Tile { page: 0, min: [0, 0], size: [width, height] };
    uploaded.renderer.set_lumels(&lumels, &whole, std::iter::once(None));
    assert!(show() == before);
}

#[test]
fn a_grid_shows_the_borders_of_lumels_and_only_where_there_is_an_atlas() {
    let subject = scenes::everything();
    let map = Lumels::new(&subject);
    let Some((uploaded, lumels)) = map.on(&subject, |_| true) else { return };
    let size = [600, 420];
    let plain = frame(&uploaded, &lumels, Filter::Nearest, irradiance(0.0));
    let without = uploaded.draw(size, Samples::Four, &plain);
    let with = uploaded.draw(size, Samples::Four, &Frame { grid: true, ..plain });
    let changed = share_beyond(&with, &without, 8);
    // Lumels are about eight pixels wide on the nearest surfaces, and much less on others.
    assert!((0.02..0.4).contains(&changed), "{changed}");
    let bare = subject.on(uploaded.renderer);
    let draw = |grid| bare.draw(SIZE, Samples::One, &Frame { grid, ..bare.frame(irradiance(0.0)) });
    assert!(draw(true) == draw(false));
}

#[test]
fn values_of_lumels_are_shown_as_colours_under_a_headlight() {
    let mut subject = scenes::everything();
    let map = Lumels::new(&subject);
    let Some((uploaded, lumels)) = map.on(&subject, |_| false) else { return };
    let by_lumels =
        uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &lumels, Filter::Nearest, Look::Plain));
    assert!(differences(&by_lumels, &uploaded.show(SIZE, Samples::One, Look::Plain)).iter().all(|d| *d <= 1));
    subject.light.fill(Vec3::ZERO);
    let Some((uploaded, lumels)) = map.on(&subject, |_| true) else { return };
    let colored = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &lumels, Filter::Nearest, Look::Plain));
    assert!(share_beyond(&colored, &by_lumels, 8) > 0.2);
}

#[test]
fn pixels_that_a_triangle_covers_in_part_read_lumels_of_its_chart() {
    let subject = scenes::everything();
    let mut map = Lumels::new(&subject);
    map.values.fill(Vec3::splat(30.0));
    let coverage = Coverage::new(&map.atlas);
    coverage.lumels().iter().for_each(|&lumel| map.values[lumel as usize] = Vec3::ONE);
    let Some((uploaded, lumels)) = map.on(&subject, |_| true) else { return };
    for filter in [Filter::Nearest, Filter::Bilinear] {
        let frame = frame(&uploaded, &lumels, filter, irradiance(0.0));
        let picture = uploaded.draw([150, 105], Samples::Four, &frame);
        let n_bright = picture.pixels().iter().filter(|pixel| pixel[1] > 160).count();
        // The ball's charts are no rectangles.
        assert!(n_bright <= 1, "{filter:?}: {n_bright} pixels");
    }
}

#[test]
fn normal_maps_are_lit_by_the_directions_of_lumels() {
    let subject = scenes::everything();
    let mut map = Lumels::new(&subject);
    map.values.fill(Vec3::ONE);
    let Some((uploaded, mut lumels)) = map.on(&subject, |_| true) else { return };
    let renderer = uploaded.renderer;
    // At the vertices it comes from everywhere, on the lumels from directions of their own.
    let even = |scene: &Scene, kind: Directional| {
        let mut of_one = vec![Vec3::ZERO; kind.harmonics()];
        of_one[0] = Vec3::ONE;
        Coefficients::new(kind, of_one.repeat(scene.vertex_count())).unwrap()
    };
    let beam = |lumel: usize| {
        let [x, y] = map.atlas.column_and_row(lumel).1.map(|place| (0.3 * place as f32).sin());
        spherical_harmonics(Vec3::new(x, y, -1.5).normalize())
    };
    let relief = Relief::default();
    for kind in [Directional::Sh1, Directional::Sh2] {
        let coefficients = even(&subject.scene, kind);
        let at_vertices = subject.lighting().with_incident(Some(&coefficients)).unwrap();
        renderer.set_light(&uploaded.light, &subject.scene, &at_vertices).unwrap();
        renderer.begin_lumel_moments(&mut lumels, kind).unwrap();
        assert!(lumels.directional() == kind && lumels.bytes_of_moments(kind) > 0);
        for (page, &size) in map.atlas.pages().iter().enumerate() {
            let first = map.atlas.first_lumel(page);
            let light = (0..(size[0] * size[1]) as usize)
                .filter_map(|i| IncidentRadiance::new(&beam(first + i).map(Vec3::splat)[..kind.harmonics()]));
            renderer.set_lumel_moments(&lumels, &Tile { page, min: [0, 0], size }, light);
        }
        let count = map.atlas.lumel_count();
        let layer = |name: String, values| LightmapLayer { name, values };
        let harmonics = (0..kind.harmonics()).map(|k| {
            let values = (0..count).map(|lumel| Vec3::splat(beam(lumel)[k])).collect();
            layer(LightmapLayer::of_harmonic(k), values)
        });
        let all = layer("irradiance".to_owned(), map.values.clone());
        let layers = std::iter::once(all).chain(harmonics).collect();
        let lightmap = Lightmap { atlas: map.atlas.clone().into(), valid: vec![true; count], layers };
        for look in [irradiance(0.0), crate::common::radiance(0.5, ToneMapper::Agx)] {
            let of_lumels = frame(&uploaded, &lumels, Filter::Bilinear, look);
            let device = uploaded.draw(SIZE, Samples::One, &of_lumels);
            let cpu = subject.traced_with(&lightmap.by_direction(0), (relief, None), SIZE, look);
            assert_same(&device, &cpu, &format!("{kind:?} {look:?}"));
            let none = renderer.lumels(&map.atlas).unwrap();
            let of_vertices = uploaded.draw(
                SIZE,
                Samples::One,
                &Frame {
                    light: Lit::One(Values::Lumels {
                        lumels: &none,
                        filter: Filter::Bilinear,
                        vertices: &uploaded.light,
                    }),
                    ..of_lumels
                },
            );
            assert!(share_beyond(&device, &of_vertices, 8) > 0.02, "{kind:?}: it is that of the lumels");
        }
    }
    renderer.begin_lumel_moments(&mut lumels, Directional::Off).unwrap();
    assert_eq!(lumels.bytes_of_moments(Directional::Off), 0);
}
