//! Reads OBJ, glTF, PLY, textures and project files into lumel scenes
