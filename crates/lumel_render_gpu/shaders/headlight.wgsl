// Colours of diagnostics.

/// A colour, shaded by a headlight to reveal shapes.
fn under_headlight(color: vec3<f32>, normal: vec3<f32>, from_eye: vec3<f32>) -> vec4<f32> {
    // Too small to matter; prevents a division by zero.
    let lengths = max(length(normal) * length(from_eye), 1e-30);
    let facing = abs(dot(normal, from_eye)) / lengths;
    return vec4<f32>(storable(color * (0.35 + 0.65 * facing)), 1.0);
}
