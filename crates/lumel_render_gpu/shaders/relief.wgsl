// Light on surfaces whose normals are tilted.

/// See `Value` in pipelines.rs.
override VALUE: u32 = 0u;

struct Interpolated {
    @builtin(position) clip: vec4<f32>,
    @location(0) light: vec3<f32>,
    @location(1) tint: vec3<f32>,
    /// Texture coordinates and place.
    @location(2) coordinates: vec4<f32>,
    @location(3) from_eye: vec3<f32>,
    @location(4) @interpolate(flat) page: u32,
    /// As in surface.wgsl.
    @location(5) @interpolate(flat) chart: vec4<f32>,
    @location(6) normal: vec3<f32>,
    @location(7) tangent: vec4<f32>,
    @location(8) red: vec4<f32>,
    @location(9) green: vec4<f32>,
    @location(10) blue: vec4<f32>,
    @location(11) red_2: vec4<f32>,
    @location(12) green_2: vec4<f32>,
    @location(13) blue_2: vec4<f32>,
    @location(14) last_2: vec4<f32>,
};

/// Light whose bands 0 and 1 are known.
@vertex
fn vertex(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tint: vec3<f32>,
    @location(4) place: vec2<f32>,
    @location(5) page: u32,
    @location(6) chart: vec4<f32>,
    @location(7) normal: vec3<f32>,
    @location(8) tangent: vec4<f32>,
    @location(9) red: vec4<f32>,
    @location(10) green: vec4<f32>,
    @location(11) blue: vec4<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    let clip = project(from_eye);
    let coordinates = vec4<f32>(uv, place);
    let none = vec4<f32>(0.0);
    return Interpolated(
        clip, light, tint, coordinates, from_eye, page, chart, normal, tangent, red, green, blue, none, none, none, none,
    );
}

/// Light whose band 2 is known as well.
@vertex
fn vertex_of_three_bands(
    @location(0) position: vec3<f32>,
    @location(1) light: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) tint: vec3<f32>,
    @location(4) place: vec2<f32>,
    @location(5) page: u32,
    @location(6) chart: vec4<f32>,
    @location(7) normal: vec3<f32>,
    @location(8) tangent: vec4<f32>,
    @location(9) red: vec4<f32>,
    @location(10) green: vec4<f32>,
    @location(11) blue: vec4<f32>,
    @location(12) red_2: vec4<f32>,
    @location(13) green_2: vec4<f32>,
    @location(14) blue_2: vec4<f32>,
    @location(15) last_2: vec4<f32>,
) -> Interpolated {
    let from_eye = position - view.eye;
    let clip = project(from_eye);
    let coordinates = vec4<f32>(uv, place);
    return Interpolated(
        clip, light, tint, coordinates, from_eye, page, chart, normal, tangent, red, green, blue, red_2, green_2, blue_2, last_2,
    );
}

@fragment
fn fragment(in: Interpolated) -> @location(0) vec4<f32> {
    let uv = in.coordinates.xy;
    let albedo = albedo_at(uv, in.tint);
    let emission = emission_at(uv);
    let tilted = tilted_normal(uv, in.normal, in.tangent, in.from_eye + view.eye);
    if (is_hole(uv, in.clip.xy)) {
        discard;
    }
    let place = clamp(in.coordinates.zw, in.chart.xy, in.chart.zw);
    var light = value_at(place, in.page, in.light);
    if (dot(in.normal, in.normal) > 0.0 && dot(tilted, tilted) > 0.0) {
        let at_vertices = Moments(in.red, in.green, in.blue, in.red_2, in.green_2, in.blue_2, in.last_2);
        let moments = moments_at(place, in.page, at_vertices);
        light *= tilted_share(moments, normalize(in.normal), normalize(tilted));
    }
    if (VALUE == 1u) {
        return vec4<f32>(storable(light * INVERSE_PI * view.exposure), 1.0);
    }
    if (VALUE == 3u) {
        return in_halves(dot(light, LUMINANCE) * view.exposure);
    }
    return vec4<f32>(storable((emission + albedo * light * INVERSE_PI) * view.exposure), 1.0);
}
