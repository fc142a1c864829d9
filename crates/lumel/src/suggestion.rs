//! Lights that suit a scene without any.

use crate::places;
use glam::Vec3;
use lumel_accel::{Ray, RayTracer};
use lumel_sample::{Dim, Frame, Sampler, StreamKey, cosine_hemisphere, uniform_triangle};
use lumel_scene::{Scene, SurfacePoint};

/// Rays from surfaces that decide whether a scene is open.
const RAYS: u32 = 1024;
/// A scene is open if at least this share of its rays upwards escapes.
const OPEN_SHARE: f32 = 0.3;

/// Options of the command line that light a scene: a sky and a sun for an open scene, an area light below its ceiling for a
/// closed one.
pub fn suggested_light(scene: &Scene, tracer: &dyn RayTracer) -> String {
    if is_open(scene, tracer) {
        return "--sky 'gradient zenith=0.2,0.4,0.8 horizon=0.6,0.7,0.8 ground=0.1,0.1,0.1' --light 'sun \
                direction=-1,-2,-1 irradiance=5,5,4.5'"
            .to_owned();
    }
    let bounds = scene.bounds();
    let (middle, size) = (bounds.center(), bounds.max - bounds.min);
    let up = tracer.closest_hit(&Ray::new(middle, Vec3::Y)).map_or(0.5 * size.y, |hit| hit.t);
    let [x, y, z] = scene.to_world(middle.with_y(middle.y + 0.95 * up)).to_array();
    let [width, depth] = [size.x, size.z].map(|side| (0.2 * side).max(0.001));
    format!(
        "--light 'rect center={x:.3},{y:.3},{z:.3} direction=0,-1,0 size={width:.3},{depth:.3} radiance=10,10,10'"
    )
}

/// Whether much of what surfaces see above them is sky.
pub fn is_open(scene: &Scene, tracer: &dyn RayTracer) -> bool {
    let stream = Sampler::Sobol.stream(StreamKey::new(0), Dim::Area);
    let directions = Sampler::Sobol.stream(StreamKey::new(0), Dim::Hemisphere);
    let (mut upwards, mut escaped) = (0.0, 0.0);
    for (i, (tri, u)) in (0..).zip(places::by_area(scene, stream, RAYS)) {
        let normal = scene.geometric_normal(tri);
        let direction = Frame::from_normal(normal).to_world(cosine_hemisphere(directions.sample_2d(i)));
        if direction.y > 0.0 {
            let at = SurfacePoint { tri, bary: uniform_triangle(u).into() };
            let ray = Ray::new(scene.ray_origin(at), direction).skipping(tri);
            upwards += 1.0;
            escaped += f32::from(u8::from(tracer.closest_hit(&ray).is_none()));
        }
    }
    // A scene all of which faces down is lit from elsewhere.
    upwards == 0.0 || escaped >= OPEN_SHARE * upwards
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Baker, OpenOptions, Settings};
    use lumel_transport::Control;
    use std::sync::Arc;

    /// What is suggested for a built-in scene without its lights, and what then is found about it.
    fn suggestion(name: &str) -> (String, usize) {
        let mut builder = crate::open(name, &OpenOptions::default()).unwrap().builder;
        builder.clear_lights();
        builder.sky = lumel_scene::Radiance::ZERO.into();
        let scene = builder.clone().build().unwrap().0;
        let text = suggested_light(&scene, &lumel_accel::Bvh::build(&scene));
        for option in text.split("--").filter(|option| !option.is_empty()) {
            let (kind, value) = option.trim().split_once(' ').unwrap();
            let value = value.trim_matches('\'');
            match kind {
                "light" => _ = builder.add_light(crate::spec::light(value).unwrap().light().unwrap()),
                _ => {
                    let sky = crate::spec::sky(value).unwrap();
                    builder.sky = sky.load(None, &mut lumel_scene::Warnings::default()).unwrap();
                }
            }
        }
        let baker = Baker::new(Arc::new(builder.build().unwrap().0), Settings::default());
        (text, baker.light_findings(&Control::default()).unwrap().len())
    }

    #[test]
    fn rooms_get_a_light_below_the_ceiling_and_open_scenes_a_sky_and_a_sun() {
        let (room, findings) = suggestion("cornell-box");
        assert!(room.starts_with("--light 'rect center=0.278,0.535,0.280 direction=0,-1,0"), "{room}");
        assert_eq!(findings, 0);
        let (court, findings) = suggestion("atrium");
        assert!(court.starts_with("--sky 'gradient") && court.contains("--light 'sun"), "{court}");
        assert_eq!(findings, 0);
    }
}
