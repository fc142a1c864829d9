// The values of the light buffer as colours, shaded by a headlight.

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) from_eye: vec3<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) normal: vec3<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), light, normal, from_eye);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    return under_headlight(in.color, in.normal, in.from_eye);
}
