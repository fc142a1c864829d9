// Rectangle lights, visible from their front: one instance each, two triangles.

@group(1) @binding(0) var light_map: texture_2d<f32>;
@group(1) @binding(1) var light_sampler: sampler;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) radiance: vec3<f32>,
    @location(1) uv: vec2<f32>,
};

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @location(0) center: vec3<f32>,
    @location(1) u: vec3<f32>,
    @location(2) v: vec3<f32>,
    @location(3) radiance: vec3<f32>,
) -> Interpolated {
    // Counter-clockwise seen from the u x v side.
    var corners = array<vec2<f32>, 6>(
        vec2<f32>(-1.0, -1.0),
        vec2<f32>(1.0, -1.0),
        vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, -1.0),
        vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, 1.0),
    );
    let at = corners[index];
    var clip = project(center + at.x * u + at.y * v - view.eye);
    // A light up to a ten-thousandth of the distance behind a surface counts as in front of it, as in lumel_render_cpu.
    clip.z /= SHADOW_END;
    return Interpolated(clip, radiance, vec2<f32>(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y));
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    let radiance = in.radiance * textureSample(light_map, light_sampler, in.uv).rgb;
    return vec4<f32>(storable(radiance * view.exposure), 1.0);
}
