// Values that are linear over a triangle: computed at the vertices and only stored by fragments.

/// See `Value` in pipelines.rs.
override VALUE: u32 = 0u;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) value: vec3<f32>,
};

@vertex
fn vertex(@location(0) position: vec3<f32>, @location(1) light: vec3<f32>) -> Interpolated {
    var out: Interpolated;
    out.clip = project(position - view.eye);
    let albedo = clamp(material.albedo.rgb, vec3<f32>(0.0), vec3<f32>(MAX_ALBEDO));
    if (VALUE == 0u) {
        out.value = material.emission.rgb + albedo * light * INVERSE_PI;
    } else if (VALUE == 1u) {
        out.value = light * INVERSE_PI;
    } else if (VALUE == 2u) {
        out.value = albedo;
    } else if (VALUE == 5u) {
        out.value = 0.5 * light + 0.5;
    } else {
        out.value = vec3<f32>(dot(light, LUMINANCE));
    }
    return out;
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    if (VALUE == 3u) {
        return in_halves(in.value.x * view.exposure);
    }
    return vec4<f32>(storable(in.value * view.exposure), 1.0);
}
