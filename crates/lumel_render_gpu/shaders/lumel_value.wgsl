// Values by lumel that do not depend on materials.

/// See `Value` in pipelines.rs.
override VALUE: u32 = 1u;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) at_vertices: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) from_eye: vec3<f32>,
    /// Within the triangle, also where a sample of the pixel is and its middle is not: beyond it are lumels of others.
    @location(3) @interpolate(perspective, centroid) place: vec2<f32>,
    @location(4) @interpolate(flat) page: u32,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) normal: vec3<f32>,
    @location(3) place: vec2<f32>,
    @location(4) page: u32,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), light, normal, from_eye, place, page);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    let value = value_at(in.place, in.page, in.at_vertices);
    if (VALUE == 1u) {
        return vec4<f32>(storable(value * INVERSE_PI * view.exposure), 1.0);
    }
    if (VALUE == 3u) {
        return in_halves(dot(value, LUMINANCE) * view.exposure);
    }
    return under_headlight(value, in.normal, in.from_eye);
}
