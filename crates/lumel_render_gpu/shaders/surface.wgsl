// Radiance and albedo of surfaces with textures or tints.

/// Whether albedo is shown instead of radiance.
override SHOWS_ALBEDO: bool = false;
override HAS_ALBEDO_MAP: bool = false;
override HAS_EMISSION_MAP: bool = false;
override IS_TRANSPARENT: bool = false;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) light: vec3<f32>,
    @location(1) tint: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) place: vec2<f32>,
    @location(4) @interpolate(flat) page: u32,
    /// The smallest and largest places of the chart: the middle of a pixel may lie beyond the triangle that covers a part of it.
    @location(5) @interpolate(flat) chart: vec4<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tint: vec3<f32>,
    @location(4) place: vec2<f32>,
    @location(5) page: u32,
    @location(6) chart: vec4<f32>,
) -> Interpolated {
    return Interpolated(project(position - view.eye), light, tint, uv, place, page, chart);
}

/// Whether the surface is not there: below the least alpha of a mask, otherwise at that share of pixels.
///
/// Jimenez, *Next generation post processing in Call of Duty: Advanced Warfare*, 2014: noise that is even over
/// neighbouring pixels.
fn is_hole(in: Interpolated) -> bool {
    let uv = mapped(in.uv, material.alpha_u, material.alpha_v);
    let alpha = material.albedo.a * textureSample(alpha_map, alpha_sampler, uv).a;
    let noise = fract(52.9829189 * fract(dot(in.clip.xy, vec2<f32>(0.06711056, 0.00583715))));
    return select(alpha < material.emission.a, alpha <= noise, material.emission.a < 0.0);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    var albedo = material.albedo.rgb * in.tint;
    if (HAS_ALBEDO_MAP) {
        let uv = mapped(in.uv, material.albedo_u, material.albedo_v);
        albedo *= textureSample(albedo_map, albedo_sampler, uv).rgb;
    }
    albedo = clamp(albedo, vec3<f32>(0.0), vec3<f32>(MAX_ALBEDO));
    if (IS_TRANSPARENT && is_hole(in)) {
        discard;
    }
    if (SHOWS_ALBEDO) {
        return vec4<f32>(albedo, 1.0);
    }
    var emission = material.emission.rgb;
    if (HAS_EMISSION_MAP) {
        let uv = mapped(in.uv, material.emission_u, material.emission_v);
        emission *= textureSample(emission_map, emission_sampler, uv).rgb;
    }
    let light = value_at(clamp(in.place, in.chart.xy, in.chart.zw), in.page, in.light);
    return vec4<f32>(storable((emission + albedo * light * INVERSE_PI) * view.exposure), 1.0);
}
