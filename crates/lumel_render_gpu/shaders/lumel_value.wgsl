// Values by lumel that do not depend on materials.

/// See `Value` in pipelines.rs.
override VALUE: u32 = 1u;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) at_vertices: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) from_eye: vec3<f32>,
    @location(3) place: vec2<f32>,
    @location(4) @interpolate(flat) page: u32,
    /// The smallest and largest places of the chart: the middle of a pixel may lie beyond the triangle that covers a part of it.
    @location(5) @interpolate(flat) chart: vec4<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) normal: vec3<f32>,
    @location(3) place: vec2<f32>,
    @location(4) page: u32,
    @location(5) chart: vec4<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), light, normal, from_eye, place, page, chart);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    let value = value_at(clamp(in.place, in.chart.xy, in.chart.zw), in.page, in.at_vertices);
    if (VALUE == 1u) {
        return vec4<f32>(storable(value * INVERSE_PI * view.exposure), 1.0);
    }
    if (VALUE == 3u) {
        return in_halves(dot(value, LUMINANCE) * view.exposure);
    }
    if (VALUE == 5u) {
        return vec4<f32>(0.5 * value + 0.5, 1.0);
    }
    return under_headlight(value, in.normal, in.from_eye);
}
