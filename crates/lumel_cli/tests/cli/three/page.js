// Draws GLB files with three.js and its own loader, and sends the pictures to browser.mjs.

import { LinearToneMapping, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { EffectComposer } from "three/addons/postprocessing/EffectComposer.js";
import { OutputPass } from "three/addons/postprocessing/OutputPass.js";
import { RenderPass } from "three/addons/postprocessing/RenderPass.js";
import { MozLightmap } from "/moz_lightmap.js";

const tell = (path, body) => fetch(path, { method: "POST", body });

async function draw(renderer, { width, height, exposure, reader }, url) {
  const loader = new GLTFLoader();
  if (reader !== "none") {
    loader.register((parser) => {
      if (reader === "bytes") parser.json.images.forEach((image) => delete image.extras);
      return new MozLightmap(parser);
    });
  }
  const { scene, cameras } = await loader.loadAsync(url);
  const [camera] = cameras;
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  renderer.setSize(width, height, false);
  // No curve: a factor.
  renderer.toneMapping = LinearToneMapping;
  renderer.toneMappingExposure = exposure;
  // Light adds up before it is shown: a canvas alone would blend what is seen through panes on the sRGB curve.
  const composer = new EffectComposer(renderer);
  composer.addPass(new RenderPass(scene, camera));
  composer.addPass(new OutputPass());
  composer.render();
  return new Promise((done) => renderer.domElement.toBlob(done, "image/png"));
}

try {
  // What three.js complains of, such as images that it cannot load.
  for (const level of ["warn", "error"]) {
    console[level] = (...words) => tell("/failed", words.join(" "));
  }
  const pictures = await (await fetch("/pictures")).json();
  const renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
  for (const [index, picture] of pictures.entries()) {
    await tell(`/png/${index}`, await draw(renderer, picture, `/glb/${index}`));
  }
  await tell("/done");
} catch (error) {
  await tell("/failed", error.stack ?? String(error));
}
