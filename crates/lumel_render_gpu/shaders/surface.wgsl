// Radiance and albedo of surfaces with textures or tints.

/// Whether albedo is shown instead of radiance.
override SHOWS_ALBEDO: bool = false;
override HAS_ALBEDO_MAP: bool = false;
override HAS_EMISSION_MAP: bool = false;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) light: vec3<f32>,
    @location(1) tint: vec3<f32>,
    @location(2) uv: vec2<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tint: vec3<f32>,
) -> Interpolated {
    return Interpolated(project(position - view.eye), light, tint, uv);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    var albedo = material.albedo.rgb * in.tint;
    if (HAS_ALBEDO_MAP) {
        let uv = mapped(in.uv, material.albedo_u, material.albedo_v);
        albedo *= textureSample(albedo_map, albedo_sampler, uv).rgb;
    }
    albedo = clamp(albedo, vec3<f32>(0.0), vec3<f32>(MAX_ALBEDO));
    if (SHOWS_ALBEDO) {
        return vec4<f32>(albedo, 1.0);
    }
    var emission = material.emission.rgb;
    if (HAS_EMISSION_MAP) {
        let uv = mapped(in.uv, material.emission_u, material.emission_v);
        emission *= textureSample(emission_map, emission_sampler, uv).rgb;
    }
    return vec4<f32>(storable((emission + albedo * in.light * INVERSE_PI) * view.exposure), 1.0);
}
