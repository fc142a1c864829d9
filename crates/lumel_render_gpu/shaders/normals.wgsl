// Shading normals, encoded as (n + 1)/2.

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) from_eye: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tangent: vec4<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tangent: vec4<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), normal, from_eye, uv, tangent);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    var normal = tilted_normal(in.uv, in.normal, in.tangent, in.from_eye + view.eye);
    if (dot(normal, normal) == 0.0) {
        // Opposite vertex normals cancel: use the triangle's normal, which faces the camera.
        let across = cross(dpdx(in.from_eye), dpdy(in.from_eye));
        normal = -across * sign(dot(across, in.from_eye));
    }
    return vec4<f32>(0.5 * normalize(normal) + 0.5, 1.0);
}
