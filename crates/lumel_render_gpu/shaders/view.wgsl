// The camera and the exposure, shared by all that draws in the scene.
// Composed behind the constants that shaders.rs takes from lumel_scene.

struct View {
    /// World space, metres.
    eye: vec3<f32>,
    /// Distance of the near plane, metres.
    near: f32,
    /// Unit vector to the right, over half the width of the picture one metre ahead.
    right: vec3<f32>,
    /// 2^stops, or what brings the range of false colours to 0..=1.
    exposure: f32,
    /// Unit vector up, over half the height of the picture one metre ahead.
    up: vec3<f32>,
    /// What the depth of marks is multiplied by, so that they lie before the surface they are on.
    closer: f32,
    /// Unit vector into the picture.
    forward: vec3<f32>,
    /// Keeps the next one aligned.
    unused: f32,
    /// Width and height of the picture, pixels.
    size: vec2<f32>,
};

@group(0) @binding(0) var<uniform> view: View;

/// A point relative to the eye in clip space. Depth is near/z: 1 at the near plane, 0 infinitely far away, where
/// floats are densest.
fn project(from_eye: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(dot(from_eye, view.right), dot(from_eye, view.up), view.near, dot(from_eye, view.forward));
}

/// What 16 bits can hold: an infinity would make the average of its pixel's samples worthless.
fn storable(color: vec3<f32>) -> vec3<f32> {
    return clamp(color, vec3<f32>(-MAX_F16), vec3<f32>(MAX_F16));
}
