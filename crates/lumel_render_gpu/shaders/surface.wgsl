// Radiance and albedo of surfaces with textures or tints.

/// Whether albedo is shown instead of radiance.
override SHOWS_ALBEDO: bool = false;

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

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    let albedo = albedo_at(in.uv, in.tint);
    if (is_hole(in.uv, in.clip.xy)) {
        discard;
    }
    if (SHOWS_ALBEDO) {
        return vec4<f32>(albedo, 1.0);
    }
    let light = value_at(clamp(in.place, in.chart.xy, in.chart.zw), in.page, in.light);
    return vec4<f32>(storable((emission_at(in.uv) + albedo * light * INVERSE_PI) * view.exposure), 1.0);
}
