// From exposed light to sRGB codes: the formulas of lumel_render_cpu's tone.rs, srgb.rs and false_color.rs.

/// See `Curve` in pipelines.rs.
override CURVE: u32 = 0u;

struct Tone {
    /// The luminance that Reinhard's curve maps to white.
    white: f32,
    /// Smallest and largest luminance of false colours, divided by the factor of the exposure.
    low: f32,
    high: f32,
    /// 1 if false colours are logarithmic, otherwise 0.
    logarithmic: f32,
};

@group(0) @binding(0) var exposed: texture_2d<f32>;
@group(0) @binding(1) var<uniform> tone: Tone;
@group(0) @binding(2) var false_colors: texture_2d<f32>;

fn srgb_encode(linear: vec3<f32>) -> vec3<f32> {
    let curve = 1.055 * pow(linear, vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * linear, linear <= vec3<f32>(0.0031308));
}

fn srgb_decode(code: vec3<f32>) -> vec3<f32> {
    let curve = pow((code + 0.055) / 1.055, vec3<f32>(2.4));
    return select(curve, code / 12.92, code <= vec3<f32>(0.04045));
}

fn unit(c: vec3<f32>) -> vec3<f32> {
    return clamp(c, vec3<f32>(0.0), vec3<f32>(1.0));
}

fn reinhard(c: vec3<f32>) -> vec3<f32> {
    let y = dot(c, LUMINANCE);
    return c * ((1.0 + y / (tone.white * tone.white)) / (1.0 + y));
}

const ACES_INPUT = mat3x3<f32>(
    vec3<f32>(0.59719, 0.07600, 0.02840),
    vec3<f32>(0.35458, 0.90834, 0.13383),
    vec3<f32>(0.04823, 0.01566, 0.83777),
);
const ACES_OUTPUT = mat3x3<f32>(
    vec3<f32>(1.60475, -0.10208, -0.00327),
    vec3<f32>(-0.53108, 1.10813, -0.07276),
    vec3<f32>(-0.07367, -0.00605, 1.07602),
);

fn aces(c: vec3<f32>) -> vec3<f32> {
    let x = ACES_INPUT * (c * 1.46193);
    let y = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.432951) + 0.238081);
    return ACES_OUTPUT * y;
}

const AGX_INSET = vec3<f32>(0.0425, 0.0785, 0.0785);
const AGX_KEPT: f32 = 1.0 - (0.0425 + 0.0785 + 0.0785);
const AGX_DARKEST: f32 = -12.47393;
const AGX_STOPS: f32 = 16.5;

/// Middle grey in stops above the darkest, 0..=1, and what it becomes: 0.18^(1/2.4).
const AGX_X0: f32 = (-2.4739312 - AGX_DARKEST) / AGX_STOPS;
const AGX_Y0: f32 = 0.48943709;

fn agx_curve(x: vec3<f32>) -> vec3<f32> {
    let dark = x < vec3<f32>(AGX_X0);
    let end = 2.4 * select(vec3<f32>(1.0 - AGX_X0), vec3<f32>(AGX_X0), dark);
    let height = select(vec3<f32>(1.0 - AGX_Y0), vec3<f32>(AGX_Y0), dark);
    let rise = 2.4 * (x - AGX_X0);
    let slope = end / height;
    let excess = slope * sqrt(slope) - 1.0;
    let share = abs(rise) / end;
    return AGX_Y0 + rise / pow(1.0 + excess * share * sqrt(share), vec3<f32>(1.0 / 1.5));
}

/// The sRGB code of AgX: its last power and that of the code cancel where the code's curve is not straight.
fn agx_code(c: vec3<f32>) -> vec3<f32> {
    // Zero has no logarithm; this is darker than the darkest.
    let inset = max(AGX_KEPT * c + dot(AGX_INSET, c), vec3<f32>(1e-9));
    let y = agx_curve(unit((log2(inset) - AGX_DARKEST) / AGX_STOPS));
    let outset = unit((y - dot(AGX_INSET, y)) / AGX_KEPT);
    let linear = pow(outset, vec3<f32>(2.4));
    return select(1.055 * outset - 0.055, 12.92 * linear, linear <= vec3<f32>(0.0031308));
}

/// The colour of a pixel: mean luminance in two halves, and the fraction covered by surfaces.
fn false_color(mean: vec4<f32>) -> vec3<f32> {
    if (mean.a == 0.0) {
        return vec3<f32>(0.0);
    }
    let y = (mean.r + mean.g) / mean.a;
    var t = (y - tone.low) / (tone.high - tone.low);
    if (tone.logarithmic > 0.5) {
        t = log(max(y, 1e-30) / tone.low) / log(tone.high / tone.low);
    }
    let entry = vec2<u32>(u32(255.0 * clamp(t, 0.0, 1.0) + 0.5), 0u);
    let color = textureLoad(false_colors, entry, 0).rgb;
    return select(srgb_encode(srgb_decode(color) * mean.a), color, mean.a >= 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let mean = textureLoad(exposed, vec2<i32>(position.xy), 0);
    let c = max(mean.rgb, vec3<f32>(0.0));
    var code: vec3<f32>;
    if (CURVE == 0u) {
        code = srgb_encode(unit(c));
    } else if (CURVE == 1u) {
        code = srgb_encode(unit(reinhard(c)));
    } else if (CURVE == 2u) {
        code = srgb_encode(unit(aces(c)));
    } else if (CURVE == 3u) {
        code = agx_code(c);
    } else if (CURVE == 4u) {
        code = c;
    } else {
        code = false_color(mean);
    }
    // Rounded here, so that every device rounds to nearest.
    return vec4<f32>(floor(255.0 * unit(code) + 0.5) / 255.0, 1.0);
}
