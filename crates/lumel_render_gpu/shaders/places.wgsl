// Where the surface of each pixel is, and which way it faces: what scattered points are read at.

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) from_eye: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
};

struct Place {
    /// World space, metres; the last is 1 where there is a surface.
    @location(0) position: vec4<f32>,
    /// Unit length.
    @location(1) normal: vec4<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) normal: vec3<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), from_eye, normal, uv);
}

@fragment
fn fragment(in: Interpolated) -> Place {
    let across = cross(dpdx(in.from_eye), dpdy(in.from_eye));
    if (is_hole(in.uv, in.clip.xy)) {
        discard;
    }
    // The triangle's normal, which faces the camera, where the interpolated one turns away from it.
    let geometric = -across * sign(dot(across, in.from_eye));
    let normal = select(geometric, in.normal, dot(in.normal, geometric) > 0.0);
    return Place(vec4<f32>(in.from_eye + view.eye, 1.0), vec4<f32>(normalize(normal), 0.0));
}
