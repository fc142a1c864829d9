// Albedo, emission and holes of surfaces.

override HAS_ALBEDO_MAP: bool = false;
override HAS_EMISSION_MAP: bool = false;
override IS_TRANSPARENT: bool = false;

fn albedo_at(uv: vec2<f32>, tint: vec3<f32>) -> vec3<f32> {
    var albedo = material.albedo.rgb * tint;
    if (HAS_ALBEDO_MAP) {
        let at = mapped(uv, material.albedo_u, material.albedo_v);
        albedo *= textureSample(albedo_map, albedo_sampler, at).rgb;
    }
    return clamp(albedo, vec3<f32>(0.0), vec3<f32>(MAX_ALBEDO));
}

fn emission_at(uv: vec2<f32>) -> vec3<f32> {
    var emission = material.emission.rgb;
    if (HAS_EMISSION_MAP) {
        let at = mapped(uv, material.emission_u, material.emission_v);
        emission *= textureSample(emission_map, emission_sampler, at).rgb;
    }
    return emission;
}

/// Whether the surface is not there: below the least alpha of a mask, otherwise at that share of pixels.
///
/// Jimenez, *Next generation post processing in Call of Duty: Advanced Warfare*, 2014: noise that is even over
/// neighbouring pixels.
fn is_hole(uv: vec2<f32>, pixel: vec2<f32>) -> bool {
    if (!IS_TRANSPARENT) {
        return false;
    }
    let at = mapped(uv, material.alpha_u, material.alpha_v);
    let alpha = material.albedo.a * textureSample(alpha_map, alpha_sampler, at).a;
    let noise = fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715))));
    return select(alpha < material.emission.a, alpha <= noise, material.emission.a < 0.0);
}
