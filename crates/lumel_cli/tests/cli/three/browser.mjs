// node browser.mjs PICTURES.json: draws GLB files with three.js in a headless browser and writes PNG files.
//
// PICTURES.json is a list of { glb, png, reader, width, height, exposure }; the reader is "none", "plugin", or "bytes" for the
// plugin without what only lumel writes. The camera is the first of the file. LUMEL_BROWSER is a browser of the Chromium family,
// NODE_PATH the folder that has three.js; `cargo x test` sets both. The page that draws gets everything from this script,
// which ends when the page says that it is done.

import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";

const MAX_SECONDS = 60;
const { LUMEL_BROWSER, NODE_PATH } = process.env;
const pictures = JSON.parse(readFileSync(process.argv[2]));

const IMPORTS = { three: "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/" };
const PAGE = `<!doctype html>
<script type="importmap">${JSON.stringify({ imports: IMPORTS })}</script>
<script type="module" src="/page.js"></script>`;

/** What the page asks for, as a type and bytes. */
function answer(path) {
  const script = (file) => ["text/javascript", readFileSync(file)];
  const [, kind, index] = path.split("/");
  if (kind === "") return ["text/html", PAGE];
  if (kind === "page.js") return script(new URL("page.js", import.meta.url));
  if (kind === "moz_lightmap.js") return script(new URL("../../../../../docs/three/moz_lightmap.js", import.meta.url));
  if (kind === "three") return script(join(NODE_PATH, path));
  if (kind === "pictures") return ["application/json", JSON.stringify(pictures)];
  if (kind === "glb") return ["model/gltf-binary", readFileSync(pictures[index].glb)];
  return ["text/plain", ""];
}

/** What the page tells. */
function hear(path, body) {
  const [, kind, index] = path.split("/");
  if (kind === "png") writeFileSync(pictures[index].png, body);
  if (kind === "failed") end(`the page failed: ${body}`);
  if (kind === "done") end();
}

async function serve(request, response) {
  const body = Buffer.concat(await request.toArray());
  const [type, bytes] = request.method === "GET" ? answer(request.url) : ["text/plain", ""];
  response.setHeader("Content-Type", type);
  response.end(bytes);
  if (request.method === "POST") hear(request.url, body);
}

const server = createServer((request, response) => serve(request, response).catch((error) => end(error.stack)));
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));

// Libraries that the browser from npm brings with it.
const libraries = join(dirname(LUMEL_BROWSER), "al2023/lib");
const env = existsSync(libraries) ? { ...process.env, LD_LIBRARY_PATH: libraries } : process.env;
const profile = mkdtempSync(join(tmpdir(), "lumel-browser-"));
const browser = spawn(
  LUMEL_BROWSER,
  [
    "--headless",
    // It sees our own page only, and containers have no rights to make a sandbox.
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-dev-shm-usage",
    // The same renderer on every machine.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    `--user-data-dir=${profile}`,
    `http://127.0.0.1:${server.address().port}/`,
  ],
  { env },
);
let [log, ended, problem] = ["", false, null];
for (const stream of [browser.stdout, browser.stderr]) stream.on("data", (text) => (log += text));
browser.on("error", (error) => finish(`${LUMEL_BROWSER} does not start: ${error.message}`));
browser.on("exit", (code, signal) => finish(problem ?? (ended ? null : `the browser ended: ${code ?? signal}\n${log}`)));
const timer = setTimeout(() => end(`no pictures after ${MAX_SECONDS} s\n${log}`), 1000 * MAX_SECONDS);

/** Closes the browser; the first word counts. */
function end(why) {
  if (ended) return;
  [ended, problem] = [true, why];
  browser.kill();
}

function finish(why) {
  clearTimeout(timer);
  if (why) console.error(why);
  try {
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  } catch {
    // Windows keeps files of programs that have just ended; they are temporary.
  }
  process.exit(why ? 1 : 0);
}
