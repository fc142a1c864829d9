// The material of a draw call. The offset into the buffer of all materials is that of its batch.

struct Material {
    /// Albedo that multiplies the texture; the last is opacity, which multiplies the alpha texture.
    albedo: vec4<f32>,
    /// Emitted radiance that multiplies the texture; the last is the least alpha of a mask, or negative.
    emission: vec4<f32>,
    /// Rows of the map from the mesh's texture coordinates to those of the albedo texture: linear part, offset.
    albedo_u: vec4<f32>,
    albedo_v: vec4<f32>,
    /// The same for emission.
    emission_u: vec4<f32>,
    emission_v: vec4<f32>,
    /// The same for the normal map.
    normal_u: vec4<f32>,
    normal_v: vec4<f32>,
    /// What red and green of the normal map are along the tangent and the bitangent: two columns.
    normal_tilt: vec4<f32>,
    /// The same for alpha.
    alpha_u: vec4<f32>,
    alpha_v: vec4<f32>,
};

@group(1) @binding(0) var<uniform> material: Material;

fn mapped(uv: vec2<f32>, row_u: vec4<f32>, row_v: vec4<f32>) -> vec2<f32> {
    let position = vec3<f32>(uv, 1.0);
    return vec2<f32>(dot(position, row_u.xyz), dot(position, row_v.xyz));
}
