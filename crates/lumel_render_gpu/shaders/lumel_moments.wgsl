// Coefficients of incident radiance by lumel.

/// Layers of each page; 0 where the coefficients of the vertices are read. See `layers_of` in light.rs.
override MOMENT_LAYERS: u32 = 0u;

@group(3) @binding(2) var lumel_moments: texture_2d_array<f32>;

/// A layer at a place on a page, read bilinearly, or that of the nearest lumel.
fn moment_layer(layer: u32, place: vec2<f32>, page: u32) -> vec4<f32> {
    let last = vec2<i32>(pages[page].xy) - 1;
    let start = select(place - 0.5, floor(place), READING == NEAREST);
    let low = floor(start);
    let part = start - low;
    let first = clamp(vec2<i32>(low), vec2<i32>(0), last);
    let next = clamp(vec2<i32>(low) + 1, vec2<i32>(0), last);
    let at = page * MOMENT_LAYERS + layer;
    let upper = mix(
        textureLoad(lumel_moments, first, at, 0),
        textureLoad(lumel_moments, vec2<i32>(next.x, first.y), at, 0),
        part.x,
    );
    let lower = mix(
        textureLoad(lumel_moments, vec2<i32>(first.x, next.y), at, 0),
        textureLoad(lumel_moments, next, at, 0),
        part.x,
    );
    return mix(upper, lower, part.y);
}

/// Those of the lumels where they are known, otherwise those given.
fn moments_at(place: vec2<f32>, page: u32, at_vertices: Moments) -> Moments {
    if (READING == AT_VERTICES || MOMENT_LAYERS == 0u) {
        return at_vertices;
    }
    var moments = at_vertices;
    moments.red = moment_layer(0u, place, page);
    moments.green = moment_layer(1u, place, page);
    moments.blue = moment_layer(2u, place, page);
    if (MOMENT_LAYERS > 3u) {
        moments.red_2 = moment_layer(3u, place, page);
        moments.green_2 = moment_layer(4u, place, page);
        moments.blue_2 = moment_layer(5u, place, page);
        moments.last_2 = moment_layer(6u, place, page);
    }
    return moments;
}
