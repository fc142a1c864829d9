// Copies the picture into the window, texel by texel; one with fewer texels than it covers pixels is interpolated.
//
// egui would draw it as any of its textures, filtered and multiplied by a colour: on a software renderer that costs
// several times as much as drawing the scene.

@group(0) @binding(0) var picture: texture_2d<f32>;

/// Whether the window turns linear light into sRGB codes by itself: the picture's codes are turned back then.
override TO_LINEAR: bool = false;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
};

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    // One triangle that covers the area: (0, 0), (2, 0), (0, 2) from its top left.
    let at = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4<f32>(at.x * 2.0 - 1.0, 1.0 - at.y * 2.0, 0.0, 1.0), at);
}

fn texel(at: vec2<i32>) -> vec3<f32> {
    return textureLoad(picture, clamp(at, vec2<i32>(0), vec2<i32>(textureDimensions(picture)) - 1), 0).rgb;
}

fn between(at: vec2<f32>) -> vec3<f32> {
    let low = vec2<i32>(floor(at));
    let part = fract(at);
    let above = mix(texel(low), texel(low + vec2<i32>(1, 0)), part.x);
    let below = mix(texel(low + vec2<i32>(0, 1)), texel(low + vec2<i32>(1, 1)), part.x);
    return mix(above, below, part.y);
}

@fragment
fn fragment(in: Corner) -> @location(0) vec4<f32> {
    let place = in.at * vec2<f32>(textureDimensions(picture));
    // Texels from one pixel to the next.
    let step = abs(dpdx(place.x));
    var code: vec3<f32>;
    if (step > 0.999) {
        code = texel(vec2<i32>(place));
    } else {
        code = between(place - 0.5);
    }
    if (!TO_LINEAR) {
        return vec4<f32>(code, 1.0);
    }
    let curved = pow((code + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(curved, code / 12.92, code <= vec3<f32>(0.04045)), 1.0);
}
