// The sky behind all surfaces: a gradient, or an image of all directions.

/// Whether it is an image.
override IS_IMAGE: bool = false;

struct Backdrop {
    /// Radiance from straight above.
    zenith: vec3<f32>,
    /// How far the image is turned about +Y, as a part of a whole turn.
    turns: f32,
    horizon: vec3<f32>,
    /// What multiplies the image.
    strength: f32,
    /// Radiance from straight below.
    ground: vec3<f32>,
    unused: f32,
};

@group(1) @binding(0) var<uniform> backdrop: Backdrop;
@group(1) @binding(1) var image: texture_2d<f32>;

/// `SkyGradient::radiance`.
fn of_gradient(direction: vec3<f32>) -> vec3<f32> {
    let end = select(backdrop.ground, backdrop.zenith, direction.y > 0.0);
    return mix(backdrop.horizon, end, abs(direction.y));
}

/// The texel that `Equirectangular::texel` finds.
fn of_image(direction: vec3<f32>) -> vec3<f32> {
    let longitude = 0.5 * INVERSE_PI * atan2(direction.x, -direction.z) + backdrop.turns + 0.5;
    let latitude = INVERSE_PI * atan2(length(direction.xz), direction.y);
    let size = textureDimensions(image);
    let texel = vec2<u32>(vec2<f32>(fract(longitude), latitude) * vec2<f32>(size));
    return textureLoad(image, min(texel, size - 1u), 0).rgb * backdrop.strength;
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = 2.0 * position.xy / view.size - 1.0;
    let across = view.right * (at.x / dot(view.right, view.right));
    let upward = view.up * (-at.y / dot(view.up, view.up));
    let direction = normalize(view.forward + across + upward);
    var radiance = vec3<f32>(0.0);
    if (IS_IMAGE) {
        radiance = of_image(direction);
    } else {
        radiance = of_gradient(direction);
    }
    return vec4<f32>(storable(radiance * view.exposure), 0.0);
}
