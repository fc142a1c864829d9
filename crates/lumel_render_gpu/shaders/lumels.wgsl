// Values by lumel, and how they are read: `Filter` of lumel_lightmap.

/// See `Reading` in pipelines.rs.
override READING: u32 = 0u;

const AT_VERTICES: u32 = 0u;
const NEAREST: u32 = 1u;
const BILINEAR: u32 = 2u;

/// A layer for each page. The last channel is 1 where a value is known and 0 elsewhere; values are multiplied by it.
@group(3) @binding(0) var lumels: texture_2d_array<f32>;

/// Width and height of each page.
@group(3) @binding(1) var<uniform> pages: array<vec4<u32>, MAX_PAGES>;

/// A lumel, or the nearest on the page.
fn lumel(at: vec2<i32>, page: u32) -> vec4<f32> {
    let last = vec2<i32>(pages[page].xy) - 1;
    return textureLoad(lumels, clamp(at, vec2<i32>(0), last), page, 0);
}

/// The weights of the two lumels before and the two after a place between the middle ones.
fn spline(t: f32) -> vec4<f32> {
    let rest = 1.0 - t;
    let middle = vec2<f32>(t, rest);
    let weights = (middle * middle * (3.0 * middle - 6.0) + 4.0) / 6.0;
    return vec4<f32>(rest * rest * rest / 6.0, weights, t * t * t / 6.0);
}

fn bilinear(low: vec2<i32>, part: vec2<f32>, page: u32) -> vec4<f32> {
    let upper = mix(lumel(low, page), lumel(low + vec2<i32>(1, 0), page), part.x);
    let lower = mix(lumel(low + vec2<i32>(0, 1), page), lumel(low + vec2<i32>(1, 1), page), part.x);
    return mix(upper, lower, part.y);
}

fn bicubic(low: vec2<i32>, part: vec2<f32>, page: u32) -> vec4<f32> {
    var across = spline(part.x);
    var down = spline(part.y);
    var sum = vec4<f32>(0.0);
    for (var y = 0; y < 4; y++) {
        for (var x = 0; x < 4; x++) {
            sum += across[x] * down[y] * lumel(low + vec2<i32>(x - 1, y - 1), page);
        }
    }
    return sum;
}

/// The value at a place on a page, lumels; where it is not known, that of the vertices.
fn value_at(place: vec2<f32>, page: u32, at_vertices: vec3<f32>) -> vec3<f32> {
    if (READING == AT_VERTICES) {
        return at_vertices;
    }
    // The centre of lumel (x, y) is at (x + 1/2, y + 1/2).
    let low = floor(place - 0.5);
    let part = place - 0.5 - low;
    var read: vec4<f32>;
    if (READING == NEAREST) {
        read = lumel(vec2<i32>(floor(place)), page);
    } else if (READING == BILINEAR) {
        read = bilinear(vec2<i32>(low), part, page);
    } else {
        read = bicubic(vec2<i32>(low), part, page);
    }
    return read.rgb + (1.0 - read.a) * at_vertices;
}
