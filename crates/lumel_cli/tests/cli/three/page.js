// Draws GLB files with three.js and its own loader, and sends the pictures to browser.mjs.

import { LinearToneMapping, PerspectiveCamera, Vector3, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MozLightmap } from "/moz_lightmap.js";

const tell = (path, body) => fetch(path, { method: "POST", body });

async function draw(renderer, { width, height, stops, fov_deg, position, target, reader }, url) {
  const loader = new GLTFLoader();
  if (reader !== "none") {
    loader.register((parser) => {
      if (reader === "bytes") parser.json.images.forEach((image) => delete image.extras);
      return new MozLightmap(parser);
    });
  }
  const { scene } = await loader.loadAsync(url);
  const camera = new PerspectiveCamera(fov_deg, width / height, 0.01, 100);
  camera.position.fromArray(position);
  camera.lookAt(new Vector3().fromArray(target));
  renderer.setSize(width, height, false);
  // No curve: a factor.
  renderer.toneMapping = LinearToneMapping;
  renderer.toneMappingExposure = 2 ** stops;
  renderer.render(scene, camera);
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
