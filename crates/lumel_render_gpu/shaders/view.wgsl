// The camera and the exposure, shared by all scene shaders.
// Follows the constants that shaders.rs prepends.

struct View {
    /// World space, metres.
    eye: vec3<f32>,
    /// Distance of the near plane, metres.
    near: f32,
    /// Unit vector to the right, over half the width of the picture one metre ahead.
    right: vec3<f32>,
    /// 2^stops, or the factor that maps the range of false colours to 0..=1.
    exposure: f32,
    /// Unit vector up, over half the height of the picture one metre ahead.
    up: vec3<f32>,
    /// Factor of the depth of marks, so that they lie in front of their surface.
    closer: f32,
    /// Unit vector along the view direction.
    forward: vec3<f32>,
    /// How far the longest waves of a ripple have run, radians.
    phase: f32,
    /// Width and height of the picture, pixels.
    size: vec2<f32>,
    /// Length of the longest waves over 2π, metres, and the steepest slope.
    ripple: vec2<f32>,
};

@group(0) @binding(0) var<uniform> view: View;

/// A point relative to the camera, in clip space. Depth is near/z: 1 at the near plane, 0 infinitely far away, where
/// floats are densest.
fn project(from_eye: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(dot(from_eye, view.right), dot(from_eye, view.up), view.near, dot(from_eye, view.forward));
}

/// Clamped to the range of 16-bit floats: an infinity would spoil the mean of the pixel's samples.
fn storable(color: vec3<f32>) -> vec3<f32> {
    return clamp(color, vec3<f32>(-MAX_F16), vec3<f32>(MAX_F16));
}

/// One number as two halves that add up to it: 11 bits cannot distinguish 256 colours.
fn in_halves(number: f32) -> vec4<f32> {
    let value = storable(vec3<f32>(number)).x;
    let high = bitcast<f32>(bitcast<u32>(value) & 0xffffe000u);
    return vec4<f32>(high, value - high, 0.0, 1.0);
}
