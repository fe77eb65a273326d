// hashes.mjs quick|slow: scenes end in the same state in the native library, in Node and in Chromium, to the bit.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { chromium, report } from "./browser.mjs";
import { folder, load, source } from "./package.mjs";
import { DYNAMIC, FIXED, play } from "./scenes.mjs";

const slow = process.argv[2] === "slow";
const scenes = [...FIXED, ...DYNAMIC].filter(([, , quick]) => quick !== slow);
const text = (name) => name.startsWith("{") ? name : readFileSync(`${source}/scenes/${name}.json`, "utf8");

const sc = await load();
const node = scenes.map(([name, parameters]) => play(sc, text(name), parameters));

const page = `<!doctype html><meta charset="utf-8"><script type="module">
import { load } from "./supercircle.mjs";
import { play } from "./scenes.mjs";
const ends = [];
let error = null;
try {
  const sc = await load();
  for (const [text, parameters] of ${JSON.stringify(scenes.map(([name, parameters]) => [text(name), parameters])).replaceAll("<", "\\u003c")})
    ends.push(play(sc, text, parameters));
} catch (e) { error = String(e); }
fetch("report", { method: "POST", body: JSON.stringify({ ends, error }) });
</script>`;
const files = {
  "page.html": ["text/html", page],
  "supercircle.mjs": ["text/javascript", readFileSync(`${folder}/supercircle.mjs`)],
  "supercircle.wasm": ["application/wasm", readFileSync(`${folder}/supercircle.wasm`)],
  "scenes.mjs": ["text/javascript", readFileSync(new URL("scenes.mjs", import.meta.url))],
};
let missing = "";
if (chromium() === null) missing = "skipped: chromium is missing, the browser was not compared; bridge/web/build.sh installs it";
else {
  const { ends, error } = await report(files, "page.html", 3000);
  assert.ok(!error, error);
  scenes.forEach(([name], i) => assert.deepEqual(ends[i], node[i], `${name}: Chromium and Node differ`));
}

const native = spawnSync("/usr/bin/python3", [new URL("native.py", import.meta.url).pathname, ...scenes.flatMap(([name, parameters]) => [name, JSON.stringify(parameters)])],
  { encoding: "utf8" });
if (native.status === 77) missing = native.stdout.trim();
else {
  assert.equal(native.status, 0, native.stderr);
  JSON.parse(native.stdout).forEach((end, i) => {
    const [name, parameters] = scenes[i];
    const equal = end.hash === node[i].hash && JSON.stringify(end.bodies) === JSON.stringify(node[i].bodies);
    console.log(`${name.startsWith("{") ? "tumbling crate" : name} ${JSON.stringify(parameters)}: ${node[i].steps} steps, ${node[i].hash}, native ${equal ? "equal" : `${end.hash}`}`);
    if (!DYNAMIC.some(([other]) => other === name)) assert.equal(end.hash, node[i].hash, `${name}: native and WebAssembly differ`);
  });
}
if (missing !== "") {
  console.log(missing);
  process.exit(77);
}
