// The small pictures of the scenes: draw lists of the library, taken after a while of play.
//
//     node pictures.mjs PACKAGE NAME...      prints {NAME: {width, height, list, numbers, operations, texts}}

import fs from "node:fs";
import path from "node:path";
import vm from "node:vm";
import zlib from "node:zlib";

const here = path.dirname(new URL(import.meta.url).pathname);
const root = path.resolve(here, "../../..");
const [folder, ...names] = process.argv.slice(2);
const { load } = await import(path.resolve(folder, "supercircle.mjs"));
const library = await load();
const scenes = vm.runInNewContext(`${fs.readFileSync(path.join(here, "scenes.js"), "utf8")}; scenes`);
const [width, height] = [216, 124]; // px, twice what is shown
const seconds = { snap: 2.6, two_shells: 2.6, nest: 1.2, pile_and_press: 3, crash_bumper: 2, egg_crate: 1.1, shell_tower: 1, peg_board: 1.7, ramp_and_pins: 1.6, drop_and_throw: 2.5, ring_tyres: 2.2, welded_boxes: 0.2 };

const out = {};
for (const name of names) {
  const text = fs.readFileSync(path.join(root, `scenes/play/${name}.json`), "utf8");
  const world = library.World.forScene(text, { quality: "game" });
  const scene = world.load(text);
  while (world.time < (seconds[name] ?? 1) && !scene.finished)
    scene.step(1 / 60);
  const [x0, y0, x1, y1] = scenes[name].view;
  const scale = Math.min(width / (x1 - x0), height / (y1 - y0));
  const list = world.picture({ width, height, centre: [(x0 + x1) / 2, (y0 + y1) / 2], pixelsPerMetre: scale, pixelRatio: 1, reducedMotion: true,
    layers: "bodies shells strain" });
  const bytes = Buffer.concat([Buffer.from(list.numbers.buffer), Buffer.from(list.operations.buffer)]);
  out[name] = { width, height, numbers: list.numbers.length, operations: list.operations.length, texts: list.texts,
    list: zlib.deflateRawSync(bytes, { level: 9 }).toString("base64") };
  world.dispose();
}
console.log(JSON.stringify(out));
