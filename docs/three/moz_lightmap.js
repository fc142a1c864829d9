// A plugin for GLTFLoader of three.js that reads the lightmaps of `lumel bake --basis lightmap --target three`:
//
//     const loader = new GLTFLoader().register((parser) => new MozLightmap(parser));

import { DataTexture, LinearFilter, MeshLambertMaterial, RGBFormat, UnsignedInt5999Type } from "three";

export class MozLightmap {
  name = "MOZ_lightmap";
  fine = new Map();

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
    const { textures, images } = this.parser.json;
    const rgb9e5 = images[textures[lightmap.index].source].extras?.rgb9e5;
    // Either is linear, as three.js takes textures unless it is told otherwise.
    if (rgb9e5) params.lightMap = await this.fineTexture(rgb9e5);
    else await this.parser.assignTexture(params, "lightMap", { texCoord: 1, ...lightmap });
  }

  // Images have 8 bits, which are coarse where it is dark. Beside them lumel puts the same light in 32 bits.
  fineTexture({ bufferView, size }) {
    const load = async () => {
      const words = new Uint32Array(await this.parser.getDependency("bufferView", bufferView));
      const texture = new DataTexture(words, ...size, RGBFormat, UnsignedInt5999Type);
      texture.magFilter = texture.minFilter = LinearFilter;
      texture.channel = 1;
      texture.needsUpdate = true;
      return texture;
    };
    if (!this.fine.has(bufferView)) this.fine.set(bufferView, load());
    return this.fine.get(bufferView);
  }
}
