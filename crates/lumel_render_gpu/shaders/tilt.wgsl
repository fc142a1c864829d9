// Normals that images and waves tilt.

override HAS_NORMAL_MAP: bool = false;
override IS_RIPPLED: bool = false;

/// The sign of green: -1 where it points down.
override GREEN: f32 = 1.0;

/// The normal that the normal map makes of interpolated vectors, none of unit length, as `Scene::mapped_normal` has it;
/// `normal` where there is no tangent.
fn mapped_normal(uv: vec2<f32>, normal: vec3<f32>, tangent: vec4<f32>) -> vec3<f32> {
    let at = mapped(uv, material.normal_u, material.normal_v);
    let texel = 2.0 * textureSample(normal_map, normal_sampler, at).xyz - 1.0;
    let tilt = material.normal_tilt.xy * texel.x + material.normal_tilt.zw * (GREEN * texel.y);
    let bitangent = sign(tangent.w) * cross(normal, tangent.xyz);
    let sum = tangent.xyz * tilt.x + bitangent * tilt.y + normal * texel.z;
    let has_frame = tangent.w != 0.0 && dot(tangent.xyz, tangent.xyz) > 0.0 && dot(sum, sum) > 0.0;
    return select(normal, sum, has_frame);
}

/// The slope of one of the waves.
fn slope_of(wave: vec4<f32>, position: vec3<f32>) -> vec3<f32> {
    let along = wave.xyz;
    let shortness = length(along);
    let phase = dot(along, position) / view.ripple.x - sqrt(shortness) * view.phase;
    return along * (view.ripple.y * wave.w / shortness * cos(phase));
}

/// The unit normal where waves tilt it: `Ripple::tilted`.
fn rippled_normal(normal: vec3<f32>, position: vec3<f32>) -> vec3<f32> {
    // Without a loop: all that depends on a wave alone is a constant then.
    let slope = slope_of(WAVES[0], position) + slope_of(WAVES[1], position)
        + slope_of(WAVES[2], position) + slope_of(WAVES[3], position);
    return normalize(normal - slope + normal * dot(slope, normal));
}

/// The normal that is shown, of any length, for interpolated vectors at a point.
fn tilted_normal(uv: vec2<f32>, normal: vec3<f32>, tangent: vec4<f32>, position: vec3<f32>) -> vec3<f32> {
    var tilted = normal;
    if (HAS_NORMAL_MAP) {
        tilted = mapped_normal(uv, normal, tangent);
    }
    if (IS_RIPPLED && dot(tilted, tilted) > 0.0) {
        tilted = rippled_normal(normalize(tilted), position);
    }
    return tilted;
}
