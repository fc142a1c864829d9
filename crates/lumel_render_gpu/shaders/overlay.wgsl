// Dots, lines and triangle edges over the picture, in sRGB codes. Colours are multiplied by their opacity.

/// 1 for visible marks, less for those behind surfaces.
override OPACITY: f32 = 1.0;

/// Of dots, pixels.
const RADIUS: f32 = 2.5;

/// Half of the width of lines, pixels.
const HALF_WIDTH: f32 = 0.75;

/// Triangle edges: a blue that is visible on black and on white.
const EDGE = vec4<f32>(0.25, 0.55, 1.0, 0.4);

/// Borders of lumels: an orange that is visible on black and on white.
const GRID = vec4<f32>(1.0, 0.45, 0.1, 0.5);

/// Borders closer than this vanish, pixels, as they would cover everything; from the second on they are drawn in full.
const GRID_FADES = vec2<f32>(3.0, 8.0);

struct Dot {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    /// From the centre, pixels.
    @location(1) offset: vec2<f32>,
};

/// A corner of the square, or of the strip, that an instance is drawn as: -1 or 1.
fn corner(index: u32) -> vec2<f32> {
    return vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
}

fn marked(clip: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(clip.xy, clip.z * view.closer, clip.w);
}

fn painted(color: vec4<f32>, coverage: f32) -> vec4<f32> {
    let alpha = color.a * OPACITY * clamp(coverage, 0.0, 1.0);
    return vec4<f32>(color.rgb * alpha, alpha);
}

@vertex
fn dot_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    @location(1) color: vec4<f32>,
) -> Dot {
    // Half a pixel more, for the soft edge.
    let offset = corner(index) * (RADIUS + 0.5);
    let center = marked(project(position - view.eye));
    let moved = center.xy + 2.0 * offset / view.size * center.w;
    return Dot(vec4<f32>(moved, center.zw), color, offset);
}

@fragment
fn dot_fragment(in: Dot) -> @location(0) vec4<f32> {
    return painted(in.color, RADIUS + 0.5 - length(in.offset));
}

struct Line {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    /// Distance from the middle, pixels.
    @location(1) across: f32,
};

/// The start of the part of a segment in front of the near plane.
fn cut(start: vec4<f32>, end: vec4<f32>) -> vec4<f32> {
    if (start.w >= view.near || end.w <= view.near) {
        return start;
    }
    return mix(start, end, (view.near - start.w) / (end.w - start.w));
}

@vertex
fn line_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) start: vec3<f32>,
    @location(1) start_color: vec4<f32>,
    @location(2) end: vec3<f32>,
    @location(3) end_color: vec4<f32>,
) -> Line {
    let whole_a = project(start - view.eye);
    let whole_b = project(end - view.eye);
    let a = cut(whole_a, whole_b);
    let b = cut(whole_b, whole_a);
    let along = (b.xy / b.w - a.xy / a.w) * view.size;
    let length_squared = dot(along, along);
    let direction = select(vec2<f32>(1.0, 0.0), along * inverseSqrt(length_squared), length_squared > 0.0);
    let at = corner(index);
    let across = at.y * (HALF_WIDTH + 0.5);
    let offset = vec2<f32>(-direction.y, direction.x) * across;
    let center = marked(select(a, b, at.x > 0.0));
    let moved = center.xy + 2.0 * offset / view.size * center.w;
    return Line(vec4<f32>(moved, center.zw), select(start_color, end_color, at.x > 0.0), across);
}

@fragment
fn line_fragment(in: Line) -> @location(0) vec4<f32> {
    return painted(in.color, HALF_WIDTH + 0.5 - abs(in.across));
}

@vertex
fn edge_vertex(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return marked(project(position - view.eye));
}

@fragment
fn edge_fragment() -> @location(0) vec4<f32> {
    return painted(EDGE, 1.0);
}

struct Grid {
    @builtin(position) clip: vec4<f32>,
    /// Lumels.
    @location(0) place: vec2<f32>,
};

@vertex
fn grid_vertex(
    @location(0) position: vec3<f32>,
    @location(1) place: vec2<f32>,
    @location(2) page: u32,
) -> Grid {
    return Grid(marked(project(position - view.eye)), place);
}

@fragment
fn grid_fragment(in: Grid) -> @location(0) vec4<f32> {
    let lumels_per_pixel = max(fwidth(in.place), vec2<f32>(1e-6));
    let to_border = abs(fract(in.place + 0.5) - 0.5) / lumels_per_pixel;
    let is_wide = smoothstep(vec2<f32>(GRID_FADES.x), vec2<f32>(GRID_FADES.y), 1.0 / lumels_per_pixel);
    let covered = clamp(HALF_WIDTH + 0.5 - to_border, vec2<f32>(0.0), vec2<f32>(1.0)) * is_wide;
    return painted(GRID, max(covered.x, covered.y));
}
