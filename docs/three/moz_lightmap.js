// A plugin for GLTFLoader of three.js that reads the lightmaps of `lumel bake --basis lightmap --target three`:
//
//     const loader = new GLTFLoader().register((parser) => new MozLightmap(parser));

import { MeshLambertMaterial } from "three";

export class MozLightmap {
  name = "MOZ_lightmap";

  constructor(parser) {
    this.parser = parser;
  }

  lightmap(materialIndex) {
    return this.parser.json.materials[materialIndex].extensions?.[this.name];
  }

  // Surfaces are diffuse. MeshStandardMaterial would keep a part of the light for reflections.
  getMaterialType(materialIndex) {
    return this.lightmap(materialIndex) ? MeshLambertMaterial : null;
  }

  async extendMaterialParams(materialIndex, params) {
    const lightmap = this.lightmap(materialIndex);
    if (!lightmap) return;
    delete params.metalness;
    delete params.roughness;
    params.lightMapIntensity = lightmap.intensity ?? 1;
    // Texels are linear, as three.js takes them unless it is told otherwise.
    await this.parser.assignTexture(params, "lightMap", { texCoord: 1, ...lightmap });
  }
}
