// Irradiance on tilted normals: `Shading` of lumel_basis.

/// In the order of `Shading::ALL`.
override SHADING: u32 = 1u;

const LINEAR: u32 = 0u;
const NON_LINEAR: u32 = 1u;
const QUADRATIC: u32 = 3u;

/// Coefficients of incident radiance: those of the bands 0 and 1 of each channel, and those of band 2, of which the last of
/// all channels come together.
struct Moments {
    red: vec4<f32>,
    green: vec4<f32>,
    blue: vec4<f32>,
    red_2: vec4<f32>,
    green_2: vec4<f32>,
    blue_2: vec4<f32>,
    last_2: vec4<f32>,
};

const BAND_0: f32 = 0.2820948;
const BAND_1: f32 = 0.48860252;
const BAND_2 = vec3<f32>(1.0925484, 0.31539157, 0.5462742);

/// See `LEAST` and `MOST` in shading.rs.
const LEAST: f32 = 0.1;
const MOST: f32 = 4.0;

fn linear_channel(m: vec4<f32>, n: vec3<f32>) -> f32 {
    return BAND_0 * m.x + (2.0 / 3.0) * BAND_1 * dot(m.yzw, n.yzx);
}

fn linear_light(m: Moments, n: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(linear_channel(m.red, n), linear_channel(m.green, n), linear_channel(m.blue, n));
}

fn quadratic_light(m: Moments, n: vec3<f32>) -> vec3<f32> {
    let first = vec4<f32>(
        BAND_2.x * n.x * n.y,
        BAND_2.x * n.y * n.z,
        BAND_2.y * (3.0 * n.z * n.z - 1.0),
        BAND_2.x * n.x * n.z,
    );
    let last = BAND_2.z * (n.x * n.x - n.y * n.y);
    let band = vec3<f32>(dot(m.red_2, first), dot(m.green_2, first), dot(m.blue_2, first)) + last * m.last_2.xyz;
    return linear_light(m, n) + 0.25 * band;
}

fn non_linear_channel(m: vec4<f32>, n: vec3<f32>) -> f32 {
    let mean = BAND_0 * m.x;
    let direction = m.wyz * (BAND_0 / sqrt(3.0));
    let long = length(direction);
    if (!(mean > 0.0 && long > 0.0)) {
        return max(mean, 0.0);
    }
    let share = min(long / mean, 1.0);
    let cosine = clamp(dot(direction, n) / long, -1.0, 1.0);
    let power = 1.0 + 2.0 * share;
    let ambient = (1.0 - share) / (1.0 + share);
    return mean * (ambient + (1.0 - ambient) * (power + 1.0) * pow(0.5 * (1.0 + cosine), power));
}

fn zonal_channel(m: vec4<f32>, axis: vec3<f32>) -> f32 {
    if (m.x <= 0.0) {
        return 0.0;
    }
    let towards = abs(dot(m.wyz, axis) / m.x);
    return m.x * (0.08 * towards + 0.6 * towards * towards);
}

fn zonal_light(m: Moments, n: vec3<f32>) -> vec3<f32> {
    let sum = linear_light(m, n);
    let brightest = LUMINANCE.x * m.red.wyz + LUMINANCE.y * m.green.wyz + LUMINANCE.z * m.blue.wyz;
    let long = length(brightest);
    if (long == 0.0) {
        return sum;
    }
    let axis = brightest / long;
    let cosine = dot(axis, n);
    let band = vec3<f32>(zonal_channel(m.red, axis), zonal_channel(m.green, axis), zonal_channel(m.blue, axis));
    return sum + 0.25 * band * (BAND_2.y * (3.0 * cosine * cosine - 1.0));
}

fn reconstructed(m: Moments, n: vec3<f32>) -> vec3<f32> {
    if (SHADING == LINEAR) {
        return linear_light(m, n);
    }
    if (SHADING == NON_LINEAR) {
        return vec3<f32>(non_linear_channel(m.red, n), non_linear_channel(m.green, n), non_linear_channel(m.blue, n));
    }
    if (SHADING == QUADRATIC) {
        return quadratic_light(m, n);
    }
    return zonal_light(m, n);
}

/// By what light on the unit normal `straight` is multiplied where it is tilted.
fn tilted_share(m: Moments, straight: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let least = LEAST * BAND_0 * vec3<f32>(m.red.x, m.green.x, m.blue.x);
    let base = max(reconstructed(m, straight), least);
    let share = clamp(reconstructed(m, normal) / base, vec3<f32>(0.0), vec3<f32>(MOST));
    return select(vec3<f32>(1.0), share, base > vec3<f32>(0.0));
}
