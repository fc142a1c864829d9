//! Units, meshes, materials, lights and the immutable scene of the lumel baker
