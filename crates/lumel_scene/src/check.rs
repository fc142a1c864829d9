//! What a scene must meet: everything that cannot be mended is an error.

use crate::error::{MAX_TRIANGLES, SceneError};
use crate::mesh::ObjectMesh;
use crate::{DirectionalLight, Light, Material, RectLight, SceneBuilder, Sky, TextureId};
use glam::Vec3;

/// Checks all that a scene is to be built from.
pub(crate) fn builder(builder: &SceneBuilder) -> Result<(), SceneError> {
    let n_textures = builder.textures.len();
    materials(&builder.materials, n_textures)?;
    lights(&builder.lights, n_textures)?;
    sky(&builder.sky)?;
    size(&builder.name, &builder.objects)?;
    builder.objects.iter().try_for_each(|mesh| object(mesh, builder.materials.len()))
}

/// Checks the light from outside a scene.
pub(crate) fn sky(sky: &Sky) -> Result<(), SceneError> {
    if sky.is_sound() { Ok(()) } else { Err(SceneError::BadSky) }
}

/// Checks the lights of a scene with so many textures.
pub(crate) fn lights(lights: &[Light], n_textures: usize) -> Result<(), SceneError> {
    for (index, light) in lights.iter().enumerate() {
        if let Light::Rect(RectLight { texture: Some(texture), .. }) = light {
            texture_index(*texture, n_textures, || format!("light {index}"))?;
        }
        if let Some(problem) = light.problem() {
            return Err(SceneError::BadLight { index, problem });
        }
    }
    Ok(())
}

fn size(scene: &str, objects: &[ObjectMesh]) -> Result<(), SceneError> {
    let triangles = objects.iter().map(|o| o.faces.len() as u64).sum();
    let vertices: u64 = objects.iter().map(|o| o.positions.len() as u64).sum();
    if triangles > MAX_TRIANGLES as u64 || vertices > MAX_TRIANGLES as u64 {
        return Err(SceneError::TooLarge { scene: scene.to_owned(), triangles });
    }
    Ok(())
}

fn object(mesh: &ObjectMesh, n_materials: usize) -> Result<(), SceneError> {
    let vertices = mesh.positions.len();
    let counts = [
        ("normals", mesh.normals.len()),
        ("texture coordinates", mesh.uvs.len()),
        ("tangents", mesh.tangents.len()),
        ("lightmap coordinates", mesh.lightmap_uvs.len()),
        ("vertex colours", mesh.tints.len()),
        ("vertex alphas", mesh.alphas.len()),
    ];
    for (what, count) in counts {
        if count != 0 && count != vertices {
            return Err(SceneError::BadCount { object: mesh.name.clone(), what, count, vertices });
        }
    }
    for (face, f) in mesh.faces.iter().enumerate() {
        let bad =
            |what, index, count| SceneError::BadIndex { object: mesh.name.clone(), face, what, index, count };
        if let Some(&index) = f.vertices.iter().find(|&&v| v as usize >= vertices) {
            return Err(bad("vertex", index, vertices));
        }
        if f.material.index() >= n_materials {
            return Err(bad("material", f.material.0, n_materials));
        }
    }
    Ok(())
}

fn materials(materials: &[Material], n_textures: usize) -> Result<(), SceneError> {
    for material in materials {
        let alpha = material.transparency.texture;
        let normal = material.normal_texture.map(|map| map.image);
        let used = [material.albedo_texture, material.emission_texture, normal, alpha];
        for used in used.into_iter().flatten() {
            let user = || format!("material \"{}\"", material.name);
            texture_index(used.texture, n_textures, user)?;
        }
    }
    Ok(())
}

fn texture_index(texture: TextureId, count: usize, user: impl Fn() -> String) -> Result<(), SceneError> {
    if texture.index() < count {
        return Ok(());
    }
    Err(SceneError::BadTexture { user: user(), index: texture.0, count })
}

impl Light {
    /// Why no scene can have it, if it has impossible values.
    pub fn problem(&self) -> Option<&'static str> {
        light_problem(self)
    }
}

fn light_problem(light: &Light) -> Option<&'static str> {
    match light {
        Light::Rect(rect) => {
            let (lu, lv) = (rect.u.length(), rect.v.length());
            if !(rect.center.is_finite() && rect.u.is_finite() && rect.v.is_finite()) {
                Some("centre and half-edges must be finite")
            } else if lu <= 0.0 || lv <= 0.0 {
                Some("the rectangle has no area")
            } else if rect.u.dot(rect.v).abs() > 1e-3 * lu * lv {
                // 1e-3: about 0.06 degrees, more than rounding to three digits in a file can cause.
                Some("the half-edges u and v must be at a right angle")
            } else {
                bad_power(rect.radiance.0).then_some("the radiance must be finite and not negative")
            }
        }
        Light::Point(point) => point_problem(point.position, point.intensity),
        Light::Spot(spot) => point_problem(spot.point.position, spot.point.intensity)
            .or_else(|| (!spot.direction.is_normalized()).then_some("the direction must be a unit vector")),
        Light::Directional(sun) => parallel_problem(sun),
        Light::Sun(sun) => parallel_problem(&sun.parallel).or_else(|| {
            // Written so that NaN fails.
            let possible = sun.sin_half_angle > 0.0 && sun.sin_half_angle <= 1.0;
            (!possible).then_some("the angular diameter must be greater than 0 and at most 180 degrees")
        }),
        Light::Disk(disk) => {
            let direction = !disk.direction.is_normalized();
            round_problem(disk.center, disk.radius, disk.radiance.0)
                .or_else(|| direction.then_some("the direction must be a unit vector"))
        }
        Light::Sphere(sphere) => round_problem(sphere.center, sphere.radius, sphere.radiance.0),
    }
}

fn bad_power(power: Vec3) -> bool {
    !power.is_finite() || power.min_element() < 0.0
}

fn parallel_problem(sun: &DirectionalLight) -> Option<&'static str> {
    if bad_power(sun.irradiance) {
        Some("the irradiance must be finite and not negative")
    } else {
        (!sun.direction.is_normalized()).then_some("the direction must be a unit vector")
    }
}

fn round_problem(center: Vec3, radius: f32, radiance: Vec3) -> Option<&'static str> {
    if !center.is_finite() {
        Some("the centre must be finite")
    } else if !(radius > 0.0 && radius.is_finite()) {
        Some("the radius must be greater than zero")
    } else {
        bad_power(radiance).then_some("the radiance must be finite and not negative")
    }
}

fn point_problem(position: Vec3, intensity: Vec3) -> Option<&'static str> {
    if !position.is_finite() {
        Some("the position must be finite")
    } else {
        bad_power(intensity).then_some("the intensity must be finite and not negative")
    }
}
