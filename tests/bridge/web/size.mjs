// What a page downloads: module and loader, compressed. Decision 0201 has the parts; the bound is their sum and a twentieth.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { folder } from "./package.mjs";

const kB = (name) => gzipSync(readFileSync(`${folder}/${name}`), { level: 9 }).length / 1000;
const module = kB("supercircle.wasm");
const loader = kB("supercircle.mjs");
console.log(`supercircle.wasm ${module.toFixed(1)} kB, supercircle.mjs ${loader.toFixed(1)} kB, both ${(module + loader).toFixed(1)} kB with gzip -9`);
assert.ok(module + loader <= 900);
