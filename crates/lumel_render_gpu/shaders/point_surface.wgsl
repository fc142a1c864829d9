// Surfaces under the light of scattered points, which `gather.wgsl` has found for each pixel.

/// See `Value` in pipelines.rs.
override VALUE: u32 = 0u;

/// Whether pixels have several samples, of which some may see another surface than their centre does.
override IS_MULTISAMPLED: bool = false;

@group(3) @binding(0) var positions: texture_2d<f32>;
@group(3) @binding(1) var normals: texture_2d<f32>;
@group(3) @binding(2) var lights: texture_2d<f32>;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    /// What is added to the light of the points.
    @location(0) light: vec3<f32>,
    @location(1) tint: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) from_eye: vec3<f32>,
    @location(4) normal: vec3<f32>,
};

@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tint: vec3<f32>,
    @location(4) normal: vec3<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    return Interpolated(project(from_eye), light, tint, uv, from_eye, normal);
}

/// Of a pixel and those around it, the one whose place is the nearest of those that face the same way.
fn pixel_of(pixel: vec2<i32>, position: vec3<f32>, normal: vec3<f32>, near: f32) -> vec2<i32> {
    var best = pixel;
    var least = 3.4e38;
    let last = vec2<i32>(view.size) - 1;
    // The pixel itself comes first.
    for (var i = 4; i < 13; i++) {
        let k = i % 9;
        let at = clamp(pixel + vec2<i32>(k % 3 - 1, k / 3 - 1), vec2<i32>(0), last);
        let place = textureLoad(positions, at, 0);
        let away = place.xyz - position;
        let squared = dot(away, away);
        let is_alike = dot(textureLoad(normals, at, 0).xyz, normal) > 0.0;
        if (place.w > 0.0 && is_alike && squared < least) {
            best = at;
            least = squared;
            if (i == 4 && squared <= near) {
                break;
            }
        }
    }
    return best;
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    let albedo = albedo_at(in.uv, in.tint);
    let emission = emission_at(in.uv);
    let across = fwidth(in.from_eye);
    if (is_hole(in.uv, in.clip.xy)) {
        discard;
    }
    var pixel = vec2<i32>(in.clip.xy);
    if (IS_MULTISAMPLED) {
        // A tenth of a pixel.
        pixel = pixel_of(pixel, in.from_eye + view.eye, in.normal, 0.01 * dot(across, across));
    }
    let light = in.light + textureLoad(lights, pixel, 0).rgb;
    if (VALUE == 1u) {
        return vec4<f32>(storable(light * INVERSE_PI * view.exposure), 1.0);
    }
    if (VALUE == 3u) {
        return in_halves(dot(light, LUMINANCE) * view.exposure);
    }
    return vec4<f32>(storable((emission + albedo * light * INVERSE_PI) * view.exposure), 1.0);
}
