// measure.mjs [SHELLS]: prints what docs/decisions/0201 states: bytes, time until ready, processor time of a stack of
// shells (18; 0: none) against the native library. Not a test: times depend on the machine and on its load. Wants the environment
// of the tests (tests/CMakeLists.txt), or takes the folders of this source tree.

import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { brotliCompressSync, gzipSync } from "node:zlib";

const top = new URL("../../..", import.meta.url).pathname.replace(/\/$/, "");
process.env.SUPERCIRCLE_PACKAGE ??= `${top}/build/web/package`;
process.env.SUPERCIRCLE_SOURCE ??= top;
process.env.SUPERCIRCLE_LIBRARY ??= `${top}/build`;
process.env.PYTHONPATH ??= `${top}/bridge/python/src`;
const { chromium, report } = await import("./browser.mjs");
const { folder, load, source } = await import("./package.mjs");
const { play } = await import("./scenes.mjs");

const bytes = Object.fromEntries(["supercircle.wasm", "supercircle.mjs", "supercircle.js"].map((name) => [name, readFileSync(`${folder}/${name}`)]));
for (const [name, content] of Object.entries(bytes))
  console.log(`${name}: ${content.length / 1000} kB, gzip -9 ${gzipSync(content, { level: 9 }).length / 1000} kB, brotli ${brotliCompressSync(content).length / 1000} kB`);

let start = performance.now();
const sc = await load();
console.log(`Node ${process.version}: ready after ${(performance.now() - start).toFixed(0)} ms`);

if (chromium() !== null) {
  const page = `<!doctype html><script type="module">
const start = performance.now();
const { load } = await import("./supercircle.mjs");
const world = new (await load()).World();
world.createShell();
world.step();
fetch("report", { method: "POST", body: JSON.stringify(performance.now() - start) });
</script>`;
  const files = { "page.html": ["text/html", page], "supercircle.mjs": ["text/javascript", bytes["supercircle.mjs"]], "supercircle.wasm": ["application/wasm", bytes["supercircle.wasm"]] };
  const times = [];
  for (let i = 0; i < 5; ++i) times.push(await report(files, "page.html"));
  console.log(`Chromium: fetched, compiled and stepped once after ${times.map((t) => t.toFixed(0)).join(", ")} ms`);
}

const shells = Number(process.argv[2] ?? 18);
if (shells === 0) process.exit(0);
const cpu = process.cpuUsage();
const end = play(sc, readFileSync(`${source}/scenes/stack30.json`, "utf8"), { shells });
const { user, system } = process.cpuUsage(cpu);
const native = JSON.parse(spawnSync("/usr/bin/python3", [new URL("native.py", import.meta.url).pathname, "stack30", JSON.stringify({ shells })], { encoding: "utf8" }).stdout)[0];
const web = (user + system) / 1e6;
console.log(`stack30 with ${shells} shells, ${end.steps} frames: ${web.toFixed(1)} s in Node, ${native.cpu_s.toFixed(1)} s native, ratio ${(web / native.cpu_s).toFixed(2)}; states ${end.hash === native.hash ? "equal" : "differ"}`);
