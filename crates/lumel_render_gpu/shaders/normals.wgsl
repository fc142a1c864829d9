// Shading normals, encoded as (n + 1)/2.

override HAS_NORMAL_MAP: bool = false;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) from_eye: vec3<f32>,
    @location(2) uv: vec2<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), normal, from_eye, mapped(uv, material.normal_u, material.normal_v));
}

/// The shading normal on the front of a face, perturbed by its normal map, as in lumel_render_cpu's normal_map.rs.
///
/// Position and texture coordinates are linear over a triangle, so their screen-space derivatives span it as its edges
/// do.
fn turned(in: Interpolated, normal: vec3<f32>) -> vec3<f32> {
    let e1 = dpdx(in.from_eye);
    let e2 = dpdy(in.from_eye);
    let d1 = dpdx(in.uv);
    let d2 = dpdy(in.uv);
    let texel = 2.0 * textureSample(normal_map, normal_sampler, in.uv).xyz - 1.0;
    let area = d1.x * d2.y - d1.y * d2.x;
    let along_u = (e1 * d2.y - e2 * d1.y) * sign(area);
    let along_v = (e2 * d1.x - e1 * d2.x) * sign(area);
    let in_plane = along_u - normal * dot(along_u, normal);
    let length_squared = dot(in_plane, in_plane);
    if (area == 0.0 || length_squared == 0.0) {
        return normal;
    }
    let tangent = in_plane * inverseSqrt(length_squared);
    var bitangent = cross(normal, tangent);
    // The image's top is where v decreases.
    if (dot(bitangent, along_v) > 0.0) {
        bitangent = -bitangent;
    }
    let sum = tangent * texel.x + bitangent * texel.y + normal * texel.z;
    return select(normal, normalize(sum), dot(sum, sum) > 0.0);
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    var normal = in.normal;
    if (dot(normal, normal) == 0.0) {
        // Opposite vertex normals cancel: use the triangle's normal, which faces the camera.
        let across = cross(dpdx(in.from_eye), dpdy(in.from_eye));
        normal = -across * sign(dot(across, in.from_eye));
    }
    normal = normalize(normal);
    if (HAS_NORMAL_MAP) {
        let side = material.normal_u.w;
        normal = side * turned(in, side * normal);
    }
    return vec4<f32>(0.5 * normal + 0.5, 1.0);
}
