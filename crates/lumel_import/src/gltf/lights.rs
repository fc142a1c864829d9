//! Lights and cameras of nodes.

use super::document::{Document, label};
use super::fault::Fault;
use super::nodes::Placed;
use glam::{DVec3, Vec3};
use gltf_json::extensions::scene::khr_lights_punctual as khr;
use gltf_json::validation::Checked;
use lumel_scene::{Camera, DirectionalLight, Light, PointLight, SpotLight, Warnings};
use std::f32::consts::{FRAC_PI_2, PI};

/// The narrowest difference between a spot's cones, radians: less is an edge no baked light can show. Narrow spots may
/// have a narrower one, by this share of the outer angle.
const LEAST_PENUMBRA: f32 = 1e-3;
const LEAST_PENUMBRA_SHARE: f32 = 0.02;

/// The light of a node, if it has one that emits, and its name: that of the node, else its own, else none.
///
/// KHR_lights_punctual: it shines along the node's -Z, scale does not change its brightness. Intensities are used
/// unconverted: candela give lux, watts per steradian give W·m⁻².
pub(super) fn light_at(
    document: &Document,
    placed: Placed,
    warnings: &mut Warnings,
) -> Result<Option<(String, Light)>, Fault> {
    let extension = document.nodes[placed.node].extensions.as_ref();
    let Some(index) = extension.and_then(|e| e.khr_lights_punctual.as_ref()).map(|e| e.light.value()) else {
        return Ok(None);
    };
    let node = document.node_label(placed.node);
    let Some(light) = document.lights.get(index) else {
        return Err(Fault::absent(node, "light", index, document.lights.len()));
    };
    let Some(light) = light else { return Ok(None) };
    let subject = format!("{} of {node}", label("light", index, light.name.as_deref()));
    let name = first_name([&document.nodes[placed.node].name, &light.name]).unwrap_or_default();
    let converted = convert(light, placed, &subject, warnings).map(|light| (name, light));
    Ok(converted.map_err(|problem| warnings.push(subject, format!("left out: {problem}"))).ok())
}

fn convert(
    light: &khr::Light,
    placed: Placed,
    subject: &str,
    warnings: &mut Warnings,
) -> Result<Light, &'static str> {
    let Checked::Valid(kind) = light.type_ else { return Err("its type is not known") };
    let strength = Vec3::from(light.color) * light.intensity;
    if !strength.is_finite() || strength.min_element() < 0.0 {
        return Err("its intensity is negative or not a finite number");
    }
    let (position, direction) = (position(placed), axis(placed, DVec3::NEG_Z));
    if kind == khr::Type::Directional {
        let direction = direction.ok_or("its node has no direction")?;
        return Ok(Light::Directional(DirectionalLight { direction, irradiance: strength }));
    }
    let position = position.ok_or("its position is not a finite number")?;
    let range = match light.range {
        Some(range) if range > 0.0 => range,
        Some(_) => {
            warnings.push(subject, "its range is not positive and is ignored");
            f32::INFINITY
        }
        None => f32::INFINITY,
    };
    let point = PointLight { position, intensity: strength, range };
    if kind == khr::Type::Point {
        return Ok(Light::Point(point));
    }
    let direction = direction.ok_or("its node has no direction")?;
    let spot =
        light.spot.clone().unwrap_or(khr::Spot { inner_cone_angle: 0.0, outer_cone_angle: FRAC_PI_2 / 2.0 });
    if spot.outer_cone_angle < SpotLight::LEAST_OUTER {
        return Err("its outer cone angle is below 0.2°; use a directional light or a wider cone");
    }
    let outer = spot.outer_cone_angle.min(FRAC_PI_2);
    let penumbra = LEAST_PENUMBRA.min(LEAST_PENUMBRA_SHARE * outer);
    let inner = spot.inner_cone_angle.clamp(0.0, outer - penumbra);
    // The clamps above let everything pass that the extension allows, but for the sharpest of edges.
    let off = (outer - spot.outer_cone_angle).abs().max((inner - spot.inner_cone_angle).abs());
    if off > LEAST_PENUMBRA {
        warnings.push(
            subject,
            "its cone angles are not 0 <= inner < outer <= 90°; the nearest that are stand in",
        );
    }
    Ok(Light::Spot(SpotLight { point, direction, cos_inner: inner.cos(), cos_outer: outer.cos() }))
}

/// The camera at a node, if it has one with a perspective. It looks along -Z, up is +Y.
pub(super) fn camera_at(
    document: &Document,
    placed: Placed,
    warnings: &mut Warnings,
) -> Result<Option<Camera>, Fault> {
    let node = &document.nodes[placed.node];
    let Some(index) = node.camera.map(|camera| camera.value()) else { return Ok(None) };
    let Some(camera) = document.cameras.get(index) else {
        let place = document.node_label(placed.node);
        return Err(Fault::absent(place, "camera", index, document.cameras.len()));
    };
    let Some(camera) = camera else { return Ok(None) };
    let name = first_name([&node.name, &camera.name]).unwrap_or_else(|| format!("camera {index}"));
    let mut leave_out = |problem| {
        warnings.push(format!("camera \"{name}\""), format!("left out: {problem}"));
        Ok(None)
    };
    let Some(perspective) = &camera.perspective else {
        return leave_out("only perspective cameras are supported");
    };
    let fov_y = perspective.yfov;
    if !(fov_y > 0.0 && fov_y < PI) {
        return leave_out("its yfov is not between 0 and 180°");
    }
    let (Some(position), Some(forward)) = (position(placed), axis(placed, DVec3::NEG_Z)) else {
        return leave_out("its node has no position or no direction");
    };
    let up = axis(placed, DVec3::Y).unwrap_or(Vec3::Y);
    Ok(Some(Camera { name, position, forward, up, fov_y }))
}

/// The first name that there is.
fn first_name(names: [&Option<String>; 2]) -> Option<String> {
    names.into_iter().flatten().find(|name| !name.is_empty()).cloned()
}

fn position(placed: Placed) -> Option<Vec3> {
    Some(placed.world.translation.as_vec3()).filter(|position| position.is_finite())
}

/// A direction of the node in the world, unit length; `None` if its scale leaves none.
fn axis(placed: Placed, axis: DVec3) -> Option<Vec3> {
    placed.world.transform_vector3(axis).try_normalize().map(|axis| axis.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::testing::{Model, text};
    use serde_json::{Value, json};

    /// A light at (1, 2, 3) that is turned to shine along -X, far from unit scale.
    fn lit(light: Value) -> Result<(Vec<Light>, String), String> {
        let mut model = Model::empty();
        model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
        let node = json!({
            "name": "Lamp", "translation": [1, 2, 3], "scale": [5, 5, 5], "rotation": [0, 1, 0, 1],
            "extensions": { "KHR_lights_punctual": { "light": 0 } },
        });
        model.push("nodes", node);
        model.read().map(|imported| (imported.scene.lights, text(&imported.warnings)))
    }

    fn near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-6
    }

    #[test]
    fn directional_lights_travel_along_minus_z_of_their_node() {
        let (lights, warnings) =
            lit(json!({ "type": "directional", "color": [1, 0.5, 0], "intensity": 2 })).unwrap();
        let Light::Directional(sun) = lights[0] else { panic!("{lights:?}") };
        assert!(near(sun.direction, Vec3::NEG_X), "{}", sun.direction);
        assert_eq!(sun.irradiance, Vec3::new(2.0, 1.0, 0.0));
        assert_eq!(warnings, "");
    }

    #[test]
    fn lights_are_called_like_their_node() {
        let names = |name: &str| {
            let mut model = Model::empty();
            let light = json!({ "type": "point", "name": "bulb" });
            model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
            let light = json!({ "KHR_lights_punctual": { "light": 0 } });
            model.push("nodes", json!({ "name": name, "extensions": light }));
            model.read().unwrap().scene.light_names
        };
        assert_eq!((names("Lamp"), names("")), (vec!["Lamp".to_owned()], vec!["bulb".to_owned()]));
    }

    #[test]
    fn point_lights_keep_candela_and_range_whatever_the_scale() {
        let (lights, _) = lit(json!({ "type": "point", "intensity": 40, "range": 7 })).unwrap();
        let Light::Point(point) = lights[0] else { panic!("{lights:?}") };
        assert!(near(point.position, Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!((point.intensity, point.range), (Vec3::splat(40.0), 7.0));
        let (lights, warnings) = lit(json!({ "type": "point", "range": 0 })).unwrap();
        let Light::Point(point) = lights[0] else { panic!("{lights:?}") };
        assert_eq!((point.intensity, point.range), (Vec3::ONE, f32::INFINITY));
        assert!(warnings.contains("light 0 of node \"Lamp\": its range"), "{warnings}");
    }

    #[test]
    fn spot_cones_become_cosines() {
        let cones = |spot: Value| {
            let (lights, warnings) = lit(json!({ "type": "spot", "spot": spot })).unwrap();
            let Light::Spot(spot) = lights[0] else { panic!("{lights:?}") };
            assert!(near(spot.direction, Vec3::NEG_X));
            assert!(spot.cos_outer < spot.cos_inner);
            (spot.cos_inner, spot.cos_outer, warnings)
        };
        let (inner, outer, warnings) = cones(json!({ "innerConeAngle": 0.3, "outerConeAngle": 0.6 }));
        assert_eq!((inner, outer, warnings.as_str()), (0.3_f32.cos(), 0.6_f32.cos(), ""));
        let (inner, outer, warnings) = cones(json!({}));
        assert_eq!((inner, outer, warnings.as_str()), (1.0, (FRAC_PI_2 / 2.0).cos(), ""));
        let (_, outer, warnings) = cones(json!({ "outerConeAngle": FRAC_PI_2 }));
        assert!(outer.abs() < 1e-6 && warnings.is_empty());
        for bad in [
            json!({ "innerConeAngle": 0.7, "outerConeAngle": 0.6 }),
            json!({ "outerConeAngle": 3 }),
            json!({ "innerConeAngle": -1 }),
        ] {
            let (_, _, warnings) = cones(bad.clone());
            assert!(warnings.contains("cone angles"), "{bad}: {warnings}");
        }
    }

    #[test]
    fn narrow_spots_are_as_bright_on_their_axis_and_fade_where_they_should() {
        for degrees in [0.25_f32, 0.5, 1.0, 10.0] {
            let (outer, inner) = (degrees.to_radians(), 0.5 * degrees.to_radians());
            let spot = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
            let (lights, warnings) = lit(json!({ "type": "spot", "spot": spot })).unwrap();
            let Light::Spot(spot) = lights[0] else { panic!("{lights:?}") };
            assert_eq!(warnings, "");
            let at = |share: f64| {
                let angle = share * f64::from(outer);
                spot.falloff(Vec3::new(-angle.cos() as f32, angle.sin() as f32, 0.0))
            };
            assert_eq!((at(0.0), at(0.45), at(1.05)), (1.0, 1.0, 0.0), "{degrees}");
            let cosine = |share: f64| (share * f64::from(outer)).cos();
            let exact = ((cosine(0.75) - cosine(1.0)) / (cosine(0.5) - cosine(1.0))).powi(2);
            assert!((f64::from(at(0.75)) - exact).abs() < 0.02, "{degrees}: {} {exact}", at(0.75));
        }
        let narrow = json!({ "type": "spot", "spot": { "outerConeAngle": 0.003 } });
        let (lights, warnings) = lit(narrow).unwrap();
        assert!(lights.is_empty());
        assert!(warnings.contains("light 0 of node \"Lamp\": left out: its outer cone angle"), "{warnings}");
    }

    #[test]
    fn lights_that_cannot_shine_are_left_out_with_a_warning() {
        for bad in [
            json!({ "type": "point", "intensity": -1 }),
            json!({ "type": "point", "intensity": 1e300 }),
            json!({ "type": "tube" }),
            json!({ "type": 5 }),
        ] {
            let (lights, warnings) = lit(bad.clone()).unwrap();
            assert!(lights.is_empty(), "{bad}");
            assert!(warnings.contains("light 0"), "{bad}: {warnings}");
        }
        let mut model = Model::empty();
        model.push("nodes", json!({ "extensions": { "KHR_lights_punctual": { "light": 3 } } }));
        assert_eq!(model.error(), "node 0: refers to light 3 of 0");
    }

    fn seen(camera: Value) -> (Vec<Camera>, String) {
        let mut model = Model::empty();
        model.push("cameras", camera);
        let turned = json!({
            "name": "View", "camera": 0, "translation": [1, 2, 3], "rotation": [0, 1, 0, 1],
        });
        model.push("nodes", turned);
        let imported = model.read().unwrap();
        (imported.scene.cameras, text(&imported.warnings))
    }

    #[test]
    fn cameras_look_along_minus_z_and_are_called_like_their_node() {
        let (cameras, _) =
            seen(json!({ "name": "c", "type": "perspective", "perspective": { "yfov": 0.8, "znear": 1 } }));
        let camera = &cameras[0];
        assert_eq!((camera.name.as_str(), camera.fov_y), ("View", 0.8));
        assert!(near(camera.position, Vec3::new(1.0, 2.0, 3.0)));
        assert!(near(camera.forward, Vec3::NEG_X) && near(camera.up, Vec3::Y));
    }

    #[test]
    fn cameras_without_a_usable_perspective_are_left_out_with_a_warning() {
        for bad in [
            json!({ "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 1, "znear": 0 } }),
            json!({ "type": "perspective", "perspective": { "yfov": 0, "znear": 1 } }),
            json!({ "type": "perspective", "perspective": { "yfov": 4, "znear": 1 } }),
        ] {
            let (cameras, warnings) = seen(bad.clone());
            assert!(cameras.is_empty(), "{bad}");
            assert!(warnings.contains("camera \"View\": left out"), "{bad}: {warnings}");
        }
    }
}
