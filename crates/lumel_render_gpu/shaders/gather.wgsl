// The light of scattered points at the place of each pixel: `PointCloud` of lumel_basis.

struct Node {
    position: vec3<f32>,
    /// Which of the clearances it has, or OPEN.
    clearance: u32,
    normal: vec3<f32>,
    /// Of that, a bit for each direction: `Clearance` of lumel_basis.
    outer: u32,
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
/// Sixteen for each clearance.
@group(1) @binding(4) var<storage, read> lines: array<vec2<f32>>;

/// Nothing stands around a point.
const OPEN: u32 = 0xffffffffu;

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

/// How far behind what stands around a point a place is, at an offset from it: it is hidden above 1.
fn behind(n: u32, offset: vec3<f32>) -> f32 {
    let number = nodes[n].clearance;
    if (number == OPEN) {
        return 0.0;
    }
    // The frame of `Frame::from_normal`.
    let normal = nodes[n].normal;
    let pole = select(-1.0, 1.0, normal.z >= 0.0);
    let scale = -1.0 / (pole + normal.z);
    let both = normal.x * normal.y * scale;
    let tangent = vec3<f32>(1.0 + pole * normal.x * normal.x * scale, pole * both, -pole * normal.x);
    let bitangent = vec3<f32>(both, pole + normal.y * normal.y * scale, -normal.y);
    let at = vec2<f32>(dot(tangent, offset), dot(bitangent, offset));
    let length = abs(at.x) + abs(at.y);
    if (length == 0.0) {
        return 0.0;
    }
    let share = at.y / length;
    let turn = select(2.0 - share, select(4.0 + share, share, at.y >= 0.0), at.x >= 0.0);
    let k = u32(4.0 * turn) & 15u;
    let here = dot(lines[16u * number + k], at);
    let beside = dot(lines[16u * number + ((k + 1u) & 15u)], at);
    return select(max(here, beside), min(here, beside), ((nodes[n].outer >> k) & 1u) == 1u);
}

fn light_of_level(number: u32, position: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let level = points.level[number];
    let first = vec3<i32>(floor((position - level.origin) * level.cells_per_metre - 0.5));
    var sum = vec4<f32>(0.0);
    // Where normals turn within a kernel: the point that faces most alike. Behind walls: the one it is least hidden from.
    var alike = vec4<f32>(0.0, 0.0, 0.0, -2.0);
    var hidden = vec4<f32>(0.0, 0.0, 0.0, 3.4e38);
    for (var i = 0; i < 8; i++) {
        let cell = range_of(first + vec3<i32>(i & 1, (i >> 1u) & 1, i >> 2u), number);
        for (var n = cell.x; n < cell.y; n++) {
            let away = nodes[n].position - position;
            let squared = dot(away, away) * level.per_square;
            if (squared < 1.0) {
                let cosine = dot(nodes[n].normal, normal);
                if (cosine >= LEAST_COSINE) {
                    let far = behind(n, -away);
                    if (far <= 1.0) {
                        sum += vec4<f32>(values[n].rgb, 1.0) * (kernel(squared) * cosine);
                    } else if (far < hidden.w) {
                        hidden = vec4<f32>(values[n].rgb, far);
                    }
                }
                if (cosine > alike.w) {
                    alike = vec4<f32>(values[n].rgb, cosine);
                }
            }
        }
    }
    let otherwise = select(alike.rgb, hidden.rgb, hidden.w < 3.4e38);
    return select(otherwise, sum.rgb / sum.w, sum.w > 0.0);
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
