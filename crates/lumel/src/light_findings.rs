//! Lights that are lost: they reach nothing, or the backs of surfaces.

use crate::{Baker, places};
use glam::Vec3;
use lumel_accel::Ray;
use lumel_basis::PointReceivers;
use lumel_sample::{
    Dim, Frame, Sampler, Stream, StreamKey, concentric_disk, uniform_sphere, uniform_triangle,
};
use lumel_scene::{Bounds, Light, Scene, SpotLight, SurfacePoint, TriId, luminance};
use lumel_transport::{
    Control, CpuTransport, Emitter, EmitterMask, Job, LightSampling, Plan, Source, TransportError, accumulate,
};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// Places on surfaces where light is looked for.
const PLACES: u32 = 1024;
/// The same for a light that none of them sees.
const MANY_PLACES: u32 = 1 << 16;
/// How far places are drawn to the middle of their face: light leaks through the edges of closed geometry.
const INSET: f32 = 0.01;
/// Rays from a light that look for a surface.
const RAYS: u32 = 256;
/// Places that tell whether a closed shell is lit, and shells that are looked at.
const PLACES_ON_SHELL: usize = 4;
const MAX_SHELLS: usize = 512;
/// How many times as much light back faces must get as surfaces do for it to be said.
const MOSTLY: f64 = 2.0;

/// Something about the lights of a scene that is probably not meant.
#[derive(Clone, Debug, PartialEq)]
pub enum LightFinding {
    /// A light that reaches no surface.
    Unreached {
        /// Its name.
        light: String,
    },
    /// Most light arrives at back faces, which are black.
    BackFaces {
        /// The share of all light that does, 0 to 1.
        share: f64,
        /// The material or object that most of it arrives at.
        name: String,
    },
    /// Closed objects that emit into their empty inside alone.
    EmitsInside {
        /// Their names, each once; at least one.
        objects: Vec<String>,
    },
    /// Closed objects that get light at their backs and none at their faces.
    InsideOut {
        /// Their names, each once; at least one.
        objects: Vec<String>,
    },
}

impl fmt::Display for LightFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreached { light } => write!(
                f,
                "light \"{light}\" reaches no surface: it is turned away from all of them, or enclosed by opaque \
                 geometry"
            ),
            Self::BackFaces { share, name } => write!(
                f,
                "{:.0} % of all direct light arrives at back faces, which are black, most of it at those of \
                 \"{name}\": its faces may be wound the wrong way round",
                100.0 * share
            ),
            Self::EmitsInside { objects } => write!(
                f,
                "object {} emits only into its own inside, where nothing is: its faces are wound the wrong way round",
                first_of(objects)
            ),
            Self::InsideOut { objects } => write!(
                f,
                "all light on object {} arrives at the backs of faces, which are black: they may be wound \
                 the wrong way round",
                first_of(objects)
            ),
        }
    }
}

/// The first of some names, and how many more there are.
fn first_of(names: &[String]) -> String {
    let more = match names.len() - 1 {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    format!("\"{}\"{more}", names[0])
}

impl LightFinding {
    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Unreached { .. } => "move or turn the light, or remove what encloses it".to_owned(),
            Self::EmitsInside { objects } => {
                format!(
                    "turn its faces round, or let both sides emit with --two-sided '{}' (in project files two_sided)",
                    objects[0]
                )
            }
            Self::InsideOut { objects } => {
                format!("light both sides with --two-sided '{}' (in project files two_sided)", objects[0])
            }
            Self::BackFaces { name, .. } => {
                format!(
                    "light both sides with --two-sided '{name}' or --two-sided all (in project files two_sided)"
                )
            }
        }
    }
}

/// A place on a surface.
#[derive(Clone, Copy)]
struct Place {
    at: Vec3,
    /// On the side that light is looked for on.
    normal: Vec3,
    tri: TriId,
    /// Whether that side is the back of a one-sided face.
    is_black: bool,
}

impl Baker {
    /// What is probably wrong with the lights, by a few thousand rays. The same on every machine.
    ///
    /// # Errors
    /// When `control` asks to stop.
    pub fn light_findings(&self, control: &Control) -> Result<Vec<LightFinding>, TransportError> {
        let scene = self.scene();
        let mut findings = Vec::new();
        for (i, (light, name)) in scene.lights().iter().zip(scene.light_names()).enumerate() {
            let mask = EmitterMask::only(scene, &[Emitter::Light(i as u32)]);
            if light.strength() != Vec3::ZERO
                && !self.meets_surface(light)
                && !self.sees_any(&mask, PLACES, control)?
                && !self.sees_any(&mask, MANY_PLACES, control)?
            {
                findings.push(LightFinding::Unreached { light: name.clone() });
            }
        }
        findings.extend(self.emits_inside());
        let at_backs = self.light_at_back_faces(control)?;
        let is_told = at_backs.is_some();
        findings.extend(at_backs);
        if !is_told {
            findings.extend(self.inside_out(control)?);
        }
        Ok(findings)
    }

    /// Whether a ray from a light meets the lit side of a surface that it may shine on.
    fn meets_surface(&self, light: &Light) -> bool {
        let Some(origin) = light.position() else { return false };
        let shines_towards = |direction: Vec3| match light {
            Light::Rect(rect) => rect.normal().is_some_and(|normal| normal.dot(direction) > 0.0),
            Light::Disk(disk) => disk.direction.dot(direction) > 0.0,
            Light::Spot(spot) => spot.falloff(direction) > 0.0,
            _ => true,
        };
        let reach = match light {
            Light::Point(point) => point.range,
            Light::Spot(spot) => spot.point.range,
            _ => f32::INFINITY,
        };
        let stream = stream(0);
        let towards = |i: u32| match light {
            Light::Spot(spot) if spot.cos_outer > 0.0 => within_cone(spot, stream.sample_2d(i)),
            _ => uniform_sphere(stream.sample_2d(i)),
        };
        (0..RAYS).map(towards).filter(|d| shines_towards(*d)).any(|direction| {
            let hit = self.tracer().closest_hit(&Ray { t_max: reach, ..Ray::new(origin, direction) });
            hit.is_some_and(|hit| self.scene().seen_side(hit.at, hit.side).is_some())
        })
    }

    /// Whether any of some places on lit sides gets light.
    fn sees_any(&self, mask: &EmitterMask, n: u32, control: &Control) -> Result<bool, TransportError> {
        let places: Vec<Place> = self.places(n).into_iter().filter(|place| !place.is_black).collect();
        Ok(self.light_at(&places, Some(mask), control)?.into_iter().any(|light| light > 0.0))
    }

    fn light_at_back_faces(&self, control: &Control) -> Result<Option<LightFinding>, TransportError> {
        let scene = self.scene();
        let places = self.places(PLACES);
        if !places.iter().any(|place| place.is_black) {
            return Ok(None);
        }
        let light = self.light_at(&places, None, control)?;
        let (mut lit, mut lost) = (0.0, 0.0);
        let mut lost_by_material = vec![0.0; scene.materials().len()];
        for (place, light) in places.iter().zip(light) {
            if place.is_black {
                lost += light;
                lost_by_material[scene.material_id(place.tri).index()] += light;
            } else {
                lit += light;
            }
        }
        if lost <= MOSTLY * lit {
            return Ok(None);
        }
        let most = (0..).zip(&lost_by_material).max_by(|a, b| f64::total_cmp(a.1, b.1)).map_or(0, |(i, _)| i);
        let of_material = |place: &&Place| place.is_black && scene.material_id(place.tri).index() == most;
        let object = places.iter().find(of_material).map(|place| scene.object_id(place.tri));
        let object = object.and_then(|id| scene.object_names().get(id.index())).cloned().unwrap_or_default();
        let material = &scene.materials()[most].name;
        let name = if material.is_empty() { object } else { material.clone() };
        Ok(Some(LightFinding::BackFaces { share: lost / (lost + lit), name }))
    }

    /// Closed shells that emit all over, inwards, and have nothing inside. A room of lamps has, or is all that there is.
    fn emits_inside(&self) -> Option<LightFinding> {
        let scene = self.scene();
        let traced = || (0..scene.traced_count() as u32).map(TriId).filter(|&tri| scene.traced(tri) == tri);
        let emits = |tri: TriId| scene.material(tri).emits();
        if !traced().any(emits) {
            return None;
        }
        let mut shells: BTreeMap<TriId, Vec<TriId>> = BTreeMap::new();
        for tri in traced().filter(|&tri| scene.bounds_solid(tri)) {
            shells.entry(scene.shell(tri)).or_default().push(tri);
        }
        shells.retain(|_, tris| tris.iter().all(|&tri| emits(tri)) && enclosed_volume(scene, tris) < 0.0);
        let mut objects: Vec<String> = Vec::new();
        for (shell, tris) in shells.iter().take(MAX_SHELLS) {
            let bounds = Bounds::around(tris.iter().flat_map(|&tri| scene.triangle_positions(tri)));
            let others = || traced().filter(|&tri| scene.shell(tri) != *shell);
            let is_inside = |p: Vec3| p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
            let is_empty = !others().any(|tri| scene.triangle_positions(tri).into_iter().any(is_inside));
            let name = &scene.object_names()[scene.object_id(tris[0]).index()];
            if is_empty && others().next().is_some() && !objects.contains(name) {
                objects.push(name.clone());
            }
        }
        (!objects.is_empty()).then_some(LightFinding::EmitsInside { objects })
    }

    /// Closed shells whose faces get no light while their backs do.
    fn inside_out(&self, control: &Control) -> Result<Option<LightFinding>, TransportError> {
        let scene = self.scene();
        let mut shells: BTreeMap<TriId, Vec<TriId>> = BTreeMap::new();
        for tri in (0..scene.traced_count() as u32).map(TriId).filter(|tri| scene.bounds_solid(*tri)) {
            shells.entry(scene.shell(tri)).or_default().push(tri);
        }
        let stream = stream(2);
        let place = |shell: &Vec<TriId>, i: usize| {
            let (tri, n) = (shell[i * shell.len() / PLACES_ON_SHELL], PLACES_ON_SHELL as u32);
            self.both_sides(tri, stream.sample_2d((i as u32) % n))
        };
        let mut objects = Vec::new();
        // Those with most triangles, in a scene of very many.
        let mut shells: Vec<Vec<TriId>> = shells.into_values().collect();
        shells.sort_by_key(|shell| std::cmp::Reverse(shell.len()));
        shells.truncate(MAX_SHELLS);
        let places: Vec<Place> =
            shells.iter().flat_map(|shell| (0..PLACES_ON_SHELL).flat_map(move |i| place(shell, i))).collect();
        let light = self.light_at(&places, None, control)?;
        for (shell, light) in shells.iter().zip(light.chunks(2 * PLACES_ON_SHELL)) {
            let sum = |first: usize| light.iter().skip(first).step_by(2).sum::<f64>();
            let (lit, lost) = (sum(0), sum(1));
            let name = &scene.object_names()[scene.object_id(shell[0]).index()];
            if lost > 0.0 && lit == 0.0 && !objects.contains(name) {
                objects.push(name.clone());
            }
        }
        Ok((!objects.is_empty()).then_some(LightFinding::InsideOut { objects }))
    }

    /// Places on both sides of faces, evenly by area; at least one on each face while there are fewer faces than places.
    fn places(&self, n: u32) -> Vec<Place> {
        let scene: &Scene = self.scene();
        let each = (0..scene.traced_count().min(n as usize) as u32).map(|tri| (TriId(tri), [0.5, 0.5]));
        let each = each.filter(|_| n == MANY_PLACES);
        places::by_area(scene, stream(1), n)
            .chain(each)
            .flat_map(|(tri, u)| self.both_sides(tri, u))
            .collect()
    }

    /// The place of a triangle that `u` in the unit square chooses, on its front and on its back.
    fn both_sides(&self, tri: TriId, u: [f32; 2]) -> [Place; 2] {
        let scene = self.scene();
        let [a, b] = uniform_triangle(u).map(|weight| weight + INSET * (1.0 / 3.0 - weight));
        let at = scene.position(SurfacePoint { tri, bary: [a, b].into() });
        let normal = scene.geometric_normal(tri);
        let is_black = !scene.is_two_sided(tri);
        [Place { at, normal, tri, is_black: false }, Place { at, normal: -normal, tri, is_black }]
    }

    /// Luminance of the direct light at places.
    fn light_at(
        &self,
        places: &[Place],
        mask: Option<&EmitterMask>,
        control: &Control,
    ) -> Result<Vec<f64>, TransportError> {
        let points = places.iter().map(|place| (self.scene().to_world(place.at), place.normal));
        let Ok(receivers) = PointReceivers::new(self.scene(), points) else {
            return Ok(vec![0.0; places.len()]);
        };
        // Without closed forms, so that what is hidden gets exactly nothing however few rays there are.
        let light_sampling = LightSampling::Area;
        let plan = Plan { direct_samples: 4, indirect_samples: 8, light_sampling, ..self.settings().plan() };
        let (scene, tracer, basis) = (self.scene().clone(), self.tracer().clone(), self.basis().clone());
        let transport = CpuTransport::new(scene, tracer, basis, Arc::new(receivers), plan);
        let job = Job { source: Source::Emitters(mask), bounce: 0, pass: 0, active: None };
        let measured = accumulate(&transport, &job, control, None)?;
        Ok(measured.field.values().iter().map(|e| f64::from(luminance(*e))).collect())
    }
}

/// The volume within a closed shell, m³; negative if its faces face inwards.
fn enclosed_volume(scene: &Scene, tris: &[TriId]) -> f64 {
    let from = scene.triangle_positions(tris[0])[0].as_dvec3();
    let of = |&tri: &TriId| {
        let [a, b, c] = scene.triangle_positions(tri).map(|corner| corner.as_dvec3() - from);
        a.dot(b.cross(c)) / 6.0
    };
    tris.iter().map(of).sum()
}

/// A direction within the cone of a spot that is narrower than a hemisphere.
fn within_cone(spot: &SpotLight, u: [f32; 2]) -> Vec3 {
    // Without the digits that a cosine near 1 loses.
    let less = 1.0 - spot.cos_outer;
    let tangent = (less * (2.0 - less)).sqrt() / spot.cos_outer;
    let across = concentric_disk(u) * tangent;
    Frame::from_normal(spot.direction).to_world(across.extend(1.0).normalize())
}

fn stream(purpose: u32) -> Stream {
    Sampler::Sobol.stream(StreamKey::new(0).element(purpose), Dim::Validity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Settings, spec};
    use lumel_scene::{Material, Radiance, SceneBuilder};

    /// A box whose faces face inwards, or outwards.
    fn room(inwards: bool, material: Material) -> SceneBuilder {
        let corner = |i: usize| [0, 1, 2].map(|axis| if (i >> axis) & 1 == 1 { 1.0 } else { 0.0 });
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let outwards = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let mut scene = SceneBuilder::new("room");
        let material = scene.add_material(material);
        let triangles = outwards.map(|[a, b, c]| if inwards { [a, c, b] } else { [a, b, c] });
        scene.add_mesh("walls", (0..8).map(corner), triangles, material);
        scene
    }

    fn findings(scene: &SceneBuilder) -> Vec<LightFinding> {
        let scene = Arc::new(scene.clone().build().unwrap().0);
        Baker::new(scene, Settings::default()).light_findings(&Control::default()).unwrap()
    }

    fn with(mut scene: SceneBuilder, lights: &[&str]) -> SceneBuilder {
        for light in lights {
            let spec = spec::light(light).unwrap();
            let light = spec.light().unwrap();
            scene.add_named_light(spec.name.unwrap_or_default(), light);
        }
        scene
    }

    fn unreached(scene: &SceneBuilder) -> Vec<String> {
        let names = findings(scene).into_iter().filter_map(|finding| match finding {
            LightFinding::Unreached { light } => Some(light),
            _ => None,
        });
        names.collect()
    }

    const WHITE: [f32; 3] = [0.8; 3];

    #[test]
    fn lights_that_shine_into_a_room_are_fine() {
        let inside = with(
            room(true, Material::diffuse("white", WHITE)),
            &[
                "rect center=0.5,0.9,0.5 direction=0,-1,0 size=0.1,0.1 radiance=1,1,1",
                "disk center=0.5,0.5,0.5 toward=0,0,0 radius=0.1 radiance=1,1,1",
                "point position=0.5,0.5,0.5 intensity=1,1,1",
                "point position=0.5,0.5,0.5 radius=0.1 intensity=1,1,1",
                "spot position=0.5,0.5,0.5 direction=0,1,0 outer=2 intensity=1,1,1",
            ],
        );
        assert_eq!(findings(&inside), []);
        let outside = with(
            room(false, Material::diffuse("white", WHITE)),
            &["sun direction=-1,-2,-1 irradiance=1,1,1", "point position=0.5,3,0.5 intensity=1,1,1"],
        );
        assert_eq!(findings(&outside), []);
    }

    #[test]
    fn lights_that_reach_nothing_are_named() {
        let lights = [
            "rect center=0.5,3,0.5 direction=0,1,0 size=0.1,0.1 radiance=1,1,1 name=away",
            "point position=0.5,3,0.5 intensity=1,1,1 range=0.5 name=short",
            "spot position=0.5,3,0.5 direction=0,1,0 intensity=1,1,1 name=up",
            "point position=0.5,3,0.5 intensity=1,1,1 name=fine",
            "point position=0.5,3,0.5 intensity=0,0,0 name=off",
            "point position=0.5,0.5,0.5 intensity=1,1,1 name=enclosed",
        ];
        let scene = with(room(false, Material::diffuse("white", WHITE)), &lights);
        assert_eq!(unreached(&scene), ["away", "short", "up", "enclosed"]);
        let sun =
            with(room(true, Material::diffuse("white", WHITE)), &["sun direction=0,-1,0 irradiance=1,1,1"]);
        assert_eq!(unreached(&sun), ["light 1"]);
        let text = LightFinding::Unreached { light: "bulb".into() }.to_string();
        assert!(text.starts_with("light \"bulb\" reaches no surface"), "{text}");
    }

    #[test]
    fn rooms_that_are_inside_out_are_told_by_the_light_on_their_backs() {
        let lamp = ["point position=0.5,0.5,0.5 intensity=1,1,1"];
        let found = findings(&with(room(false, Material::diffuse("plaster", WHITE)), &lamp));
        let [LightFinding::Unreached { .. }, LightFinding::BackFaces { share, name }] = &found[..] else {
            panic!("{found:?}")
        };
        assert_eq!((*share, name.as_str()), (1.0, "plaster"));
        assert!(found[1].to_string().starts_with("100 % of all direct light arrives at back faces"));
        assert!(found[1].remedy().contains("--two-sided 'plaster' or --two-sided all"));
        // Without a name of its own, the object stands for the material.
        let found = findings(&with(room(false, Material::diffuse("", WHITE)), &lamp));
        assert!(matches!(&found[1], LightFinding::BackFaces { name, .. } if name == "walls"), "{found:?}");
        assert_eq!(findings(&with(room(false, Material::diffuse("a", WHITE).two_sided()), &lamp)), []);
    }

    #[test]
    fn a_closed_object_that_is_inside_out_is_named() {
        let found = |inwards: bool, light: &str| {
            let mut scene = room(inwards, Material::diffuse("white", WHITE));
            let material = lumel_scene::MaterialId(0);
            let ground = [[-9.0, 0.0, -9.0], [-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, -9.0]];
            scene.add_mesh("ground", ground, [[0, 1, 2], [0, 2, 3]], material);
            findings(&with(scene, &[light]))
        };
        let sun = "sun direction=-1,-2,-1 irradiance=1,1,1";
        assert_eq!(found(true, sun), [LightFinding::InsideOut { objects: vec!["walls".into()] }]);
        assert_eq!(found(false, sun), []);
        // A room with a lamp of its own is one.
        assert_eq!(found(true, "point position=0.5,0.5,0.5 intensity=1,1,1"), []);
        let text = found(true, sun)[0].to_string();
        assert!(text.starts_with("all light on object \"walls\" arrives at the backs of faces"), "{text}");
        assert!(found(true, sun)[0].remedy().contains("--two-sided 'walls'"));
    }

    #[test]
    fn a_closed_lamp_whose_faces_face_inwards_is_named() {
        let found = |inwards: bool, sides: Material, more: [f32; 3]| {
            let mut scene = room(inwards, sides);
            let grey = scene.add_material(Material::diffuse("grey", WHITE));
            let [x, y, z] = more;
            let corners = [[x, y, z], [x, y, z + 0.1], [x + 0.1, y, z + 0.1]];
            scene.add_mesh("table", corners, [[0, 1, 2]], grey);
            findings(&scene)
        };
        let lamp = Material { emission: Radiance::splat(3.0), ..Material::diffuse("lamp", WHITE) };
        let below = [0.4, -1.0, 0.4];
        assert_eq!(
            found(true, lamp.clone(), below)[..1],
            [LightFinding::EmitsInside { objects: vec!["walls".into()] }]
        );
        assert_eq!(found(false, lamp.clone(), below), []);
        assert_eq!(found(true, lamp.clone().two_sided(), below), []);
        assert_eq!(found(true, lamp.clone(), [0.4; 3]), [], "a room of lamps with a table");
        assert_eq!(findings(&room(true, lamp.clone())), [], "a furnace");
        let finding = &found(true, lamp, below)[0];
        assert!(
            finding.to_string().starts_with("object \"walls\" emits only into its own inside"),
            "{finding}"
        );
        assert!(finding.remedy().contains("--two-sided 'walls'"), "{}", finding.remedy());
    }

    #[test]
    fn narrow_spots_are_found_where_they_shine() {
        for (outer, towards, is_lost) in
            [(0.21, "0,1,0", false), (0.3, "0.03,1,0.02", false), (0.3, "0,-1,0", true)]
        {
            let spot =
                format!("spot position=0.5,-3,0.5 direction={towards} outer={outer} intensity=1,1,1 name=s");
            let scene = with(room(false, Material::diffuse("white", WHITE)), &[&spot]);
            assert_eq!(!unreached(&scene).is_empty(), is_lost, "{spot}");
        }
    }

    #[test]
    fn a_plane_between_two_halves_of_a_sky_is_fine() {
        let mut scene = SceneBuilder::new("plane");
        let material = scene.add_material(Material::diffuse("grey", WHITE));
        scene.add_mesh("a", [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], [[0, 1, 2]], material);
        scene.sky = Radiance::splat(1.0).into();
        assert_eq!(findings(&scene), []);
    }

    #[test]
    fn a_light_in_a_closet_of_a_large_scene_is_found() {
        let mut scene = room(true, Material::diffuse("white", WHITE));
        let material = lumel_scene::MaterialId(0);
        let far = [[-1e3, -9.0, -1e3], [-1e3, -9.0, 1e3], [1e3, -9.0, 1e3], [1e3, -9.0, -1e3]];
        scene.add_mesh("ground", far, [[0, 1, 2], [0, 2, 3]], material);
        let scene = with(scene, &["point position=0.5,0.5,0.5 intensity=1,1,1"]);
        assert_eq!(unreached(&scene), Vec::<String>::new());
    }
}
