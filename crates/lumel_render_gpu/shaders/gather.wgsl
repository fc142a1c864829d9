// The light of scattered points at the place of each pixel: `PointCloud` of lumel_basis.

struct Node {
    position: vec3<f32>,
    normal: vec3<f32>,
};

/// A cell that has points, from the first to the last but one. Empty places of the table have none.
struct Slot {
    key: vec2<u32>,
    first: u32,
    end: u32,
};

struct Level {
    origin: vec3<f32>,
    /// Cells are twice as wide as a kernel reaches.
    cells_per_metre: f32,
    /// One over the squared radius of a kernel.
    per_square: f32,
};

struct Points {
    /// How many levels are read, from the coarsest on.
    levels: u32,
    /// Places of the table but one.
    mask: u32,
    level: array<Level, MAX_LEVELS>,
};

@group(0) @binding(0) var positions: texture_2d<f32>;
@group(0) @binding(1) var normals: texture_2d<f32>;
@group(1) @binding(0) var<uniform> points: Points;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> values: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> cells: array<Slot>;

/// Points count where the cosine between normals is at least this.
const LEAST_COSINE: f32 = 0.1;

/// Where the search for a cell begins: `hash` in points.rs.
fn slot_of(key: vec2<u32>) -> u32 {
    var mixed = (key.x * 0x9e3779b1u) ^ (key.y * 0x85ebca77u);
    mixed = (mixed ^ (mixed >> 15u)) * 0x2c1b3c6du;
    return mixed ^ (mixed >> 13u);
}

/// The points of a cell: the first and the one after the last.
fn range_of(cell: vec3<i32>, level: u32) -> vec2<u32> {
    let wrapped = vec3<u32>(cell) & vec3<u32>(0xffffu);
    let key = vec2<u32>(wrapped.x | (wrapped.y << 16u), wrapped.z | (level << 16u));
    var at = slot_of(key) & points.mask;
    var found = cells[at];
    while (found.end > 0u && any(found.key != key)) {
        at = (at + 1u) & points.mask;
        found = cells[at];
    }
    return vec2<u32>(found.first, found.end);
}

/// The cubic kernel of a squared distance in radii.
fn kernel(squared: f32) -> f32 {
    return squared * (2.0 * sqrt(squared) - 3.0) + 1.0;
}

fn light_of_level(number: u32, position: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let level = points.level[number];
    let first = vec3<i32>(floor((position - level.origin) * level.cells_per_metre - 0.5));
    var sum = vec4<f32>(0.0);
    // Where normals turn within a kernel: the point that faces most alike.
    var alike = vec4<f32>(0.0, 0.0, 0.0, -2.0);
    for (var i = 0; i < 8; i++) {
        let cell = range_of(first + vec3<i32>(i & 1, (i >> 1u) & 1, i >> 2u), number);
        for (var n = cell.x; n < cell.y; n++) {
            let away = nodes[n].position - position;
            let squared = dot(away, away) * level.per_square;
            if (squared < 1.0) {
                let cosine = dot(nodes[n].normal, normal);
                if (cosine >= LEAST_COSINE) {
                    sum += vec4<f32>(values[n].rgb, 1.0) * (kernel(squared) * cosine);
                }
                if (cosine > alike.w) {
                    alike = vec4<f32>(values[n].rgb, cosine);
                }
            }
        }
    }
    return select(alike.rgb, sum.rgb / sum.w, sum.w > 0.0);
}

@fragment
fn fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    let at = vec2<i32>(pixel.xy);
    let place = textureLoad(positions, at, 0);
    if (place.w == 0.0) {
        return vec4<f32>(0.0);
    }
    let normal = textureLoad(normals, at, 0).xyz;
    var light = vec3<f32>(0.0);
    for (var level = 0u; level < points.levels; level++) {
        light += light_of_level(level, place.xyz, normal);
    }
    return vec4<f32>(light, 1.0);
}
