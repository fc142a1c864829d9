// The textures of a draw call; missing ones are white.

@group(2) @binding(0) var albedo_map: texture_2d<f32>;
@group(2) @binding(1) var albedo_sampler: sampler;
@group(2) @binding(2) var emission_map: texture_2d<f32>;
@group(2) @binding(3) var emission_sampler: sampler;
@group(2) @binding(4) var normal_map: texture_2d<f32>;
@group(2) @binding(5) var normal_sampler: sampler;
@group(2) @binding(6) var alpha_map: texture_2d<f32>;
@group(2) @binding(7) var alpha_sampler: sampler;
