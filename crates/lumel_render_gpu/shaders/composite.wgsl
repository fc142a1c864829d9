// Composites the overlay over the finished picture.

@group(0) @binding(0) var overlay: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(overlay, vec2<i32>(position.xy), 0);
}
