// Worlds, shells and scenes of the JavaScript package: free fall, statics and conservation by closed forms, handles,
// errors, copies. Wants SUPERCIRCLE_PACKAGE and SUPERCIRCLE_SOURCE in the environment.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { folder, load, source, SupercircleError } from "./package.mjs";

const sc = await load();
const scene = (name) => readFileSync(`${source}/scenes/${name}.json`, "utf8");
const GROUND = { body: [{ name: "ground", type: 0, fixture: [{ polygon: { vertices: { x: [-1, 1, 1, -1], y: [-0.1, -0.1, 0, 0] } } }] }] };

function near(value, expected, error, what = "") {
  assert.ok(Math.abs(value - expected) <= error, `${what} ${value} differs from ${expected} by more than ${error}`);
}
const refusal = (kind, words) => (e) => e instanceof SupercircleError && e.kind === kind && e.message !== "" && words.test(e.message);

test("a shell falls as Galilei says", () => {
  const world = new sc.World();
  const shell = world.createShell({ name: "one", position: [0, 1] });
  const start = shell.state.centre[1];
  let frame;
  for (let i = 0; i < 30; ++i) frame = world.step(1 / 60);
  // midpoint steps are exact for a constant acceleration; Box2D rounds gravity to a float, 6e-8 at most
  const fall = 0.5 * 9.81 * 0.5 ** 2;
  near(shell.state.centre[1] - start, -fall, 6e-8 * fall);
  near(frame.advanced, 1 / 60, 1e-12);
  near(world.time, 0.5, 1e-12);
  near(world.energy.residual, 0, 1e-12);
  world.dispose();
});

test("a hold carries the weight", () => {
  const world = new sc.World();
  const shell = world.createShell({ dampingRatio: 1 });
  const hold = shell.hold(0.5, { kind: "clamp" });
  for (let i = 0; i < 60; ++i) world.step();
  const weight = shell.state.mass * 9.81;
  // oscillations decay with critical damping: a thousandth of the weight is left at most
  near(hold.reaction.force[0], 0, 1e-3 * weight);
  near(hold.reaction.force[1], weight, 1e-3 * weight);
  hold.destroy();
  assert.equal(hold.valid, false);
  assert.throws(() => hold.reaction, refusal("stale", /./));
  hold.dispose(); // what is gone may be disposed of
  world.dispose();
});

test("shapes are equally spaced copies", () => {
  const world = new sc.World();
  assert.deepEqual(world.shapes(8), []);
  const first = world.createShell({ position: { x: 0, y: 0 } });
  world.createShell({ position: [1, 0], elements: 31 });
  const shapes = world.shapes(33);
  assert.equal(shapes.length, 2);
  assert.equal(shapes[0].length, 66);
  // chords of equal arcs of a circle: 2 R sin(L / (64 R)); the polyline deviates by 1e-5 L at most
  const chord = 2 * 0.0192 * Math.sin(first.state.length / 64 / 0.0192);
  for (let i = 0; i < 32; ++i)
    near(Math.hypot(shapes[0][2 * i + 2] - shapes[0][2 * i], shapes[0][2 * i + 3] - shapes[0][2 * i + 1]), chord, 1e-4 * chord);
  shapes[0].fill(0);
  assert.notEqual(first.polyline()[0], 0);
  assert.equal(first.curvatures().length, 15);
  for (const k of first.pose().curvatures) near(k, 1 / 0.0192, 1e-9);
  near(Math.hypot(...first.section(0.5).position), 0, 1e-12);
  world.dispose();
});

test("bodies, joints, queries, zones and events", () => {
  const world = new sc.World({ unitsPerMetre: 50 });
  world.add(GROUND);
  const shell = world.createShell({ name: "bow", position: [0, 0.001], velocity: [0, -0.5] });
  assert.ok(world.findShell("bow").equals(shell) && world.shells()[0].equals(shell));
  const zone = world.createZone([-1, -1], [1, 1]);
  const kinds = new Set();
  for (let i = 0; i < 20; ++i) {
    world.step();
    for (const event of world.events()) kinds.add(event.kind);
  }
  assert.ok(kinds.has("contact_begin") && kinds.has("zone_enter"), [...kinds].join());
  assert.ok(zone.shells[0].equals(shell));
  const ground = world.findBody("ground");
  assert.equal(ground.outlines()[0].length, 8);
  assert.equal(ground.state.mass, 0);
  const hits = world.rayCast([0, 1], [0, -1]);
  assert.ok(hits[0].shell.equals(shell));
  near(hits[0].normal[1], 1, 0.05);
  assert.ok(world.closestPoint([0, 1]).distance > 0.9);
  assert.ok(world.overlapBox([-1, -1], [1, 1])[0].equals(shell));
  assert.deepEqual(world.overlapPoint([5, 5]), []);
  const tether = shell.join(null, { kind: "tether", arc: 0, point: [0, 0.2] });
  tether.setMaxLength(0.05, 1);
  for (let i = 0; i < 30; ++i) world.step();
  assert.ok(tether.reaction.force[1] > 0);
  near(tether.length, 0.05, 5e-5);
  world.dispose();
});

test("bodies by definition, and shells of any size", () => {
  const world = new sc.World();
  world.createBody({ name: "ground", type: "static", line: [[-20, 0], [20, 0]] });
  const crate = world.createBody({ name: "crate", box: [0.6, 0.4], density: 2, position: [5, 1] });
  const ball = world.createBody({ circle: 0.5, position: { x: -5, y: 2 }, velocity: [0, -1] });
  const wedge = world.createBody({ polygon: new Float64Array([0, 0, 1, 0, 0, 1]), position: [8, 1] });
  near(crate.state.mass, 0.48, 1e-6); // floats of Box2D
  near(ball.state.mass, Math.PI / 4, 1e-6);
  near(wedge.state.mass, 0.5, 1e-6);
  assert.ok(world.findBody("crate").equals(crate) && world.bodies().length === 4);
  const shell = world.createShell({ ...sc.scaledShell(1, 2, { opening: 0.5 }), position: [0, 2] });
  near(shell.state.mass, 2, 1e-9);
  for (let i = 0; i < 120; ++i) world.step();
  near(crate.state.centre[1], 0.2, 0.0151); // Box2D's skin and slop, 10 and 5 mm
  near(ball.state.centre[1], 0.5, 0.0151);
  for (const [given, words] of [[{}, /none of them/], [{ box: [1, 1], circle: 1 }, /box and circle/], [{ box: [1, 0] }, /height/],
    [{ circle: -1 }, /radius/], [{ polygon: [[0, 0], [1, 0]] }, /3 to 8/], [{ circle: 1, frction: 1 }, /friction/]])
    assert.throws(() => world.createBody(given), refusal("bad_input", words), JSON.stringify(given));
  assert.throws(() => sc.scaledShell(0, 1), refusal("bad_input", /radius/));
  world.dispose();
});

test("saved worlds and logs repeat to the bit", () => {
  const world = new sc.World();
  const other = new sc.World();
  const shell = world.createShell();
  shell.hold(0.5);
  const state = world.save();
  world.startLog(3);
  for (let i = 0; i < 10; ++i) world.step();
  const log = world.readLog();
  const end = world.hash;
  world.restore(state);
  assert.ok(shell.valid && world.hash !== end);
  for (let i = 0; i < 10; ++i) world.step();
  assert.equal(world.hash, end);
  other.replayLog(log);
  assert.equal(other.hash, end);
  world.dispose();
  other.dispose();
});

test("a scene is played", () => {
  const world = sc.World.forScene(scene("two_shells"));
  const played = world.load(scene("two_shells"), { parameters: { mu: 0.2, travel_over_R: 0.05 } });
  assert.equal(played.parameters[1].value, 0.2);
  assert.equal(played.shells.length, 2);
  let largest = 0;
  while (!played.finished) {
    played.step(0.02);
    largest = Math.max(largest, played.force);
  }
  assert.equal(played.phase, "done");
  assert.ok(largest > 0);
  assert.ok(world.svg({ width: 200, height: 100, layers: "shells bodies" }).startsWith("<svg"));
  const { operations, numbers, texts } = world.picture({ width: 200, height: 100, layers: ["shells"] });
  let count = 0;
  for (let i = 1; i < operations.length; i += 2) count += operations[i];
  assert.ok(operations.length > 0 && numbers.length === count && numbers instanceof Float32Array && typeof texts === "string");
  const heard = world.sound(0.1);
  assert.ok(heard instanceof Float32Array && heard.length === 4800 && heard.every((x) => Math.abs(x) <= 1));
  assert.equal(new TextDecoder().decode(sc.wav(heard).subarray(0, 4)), "RIFF");
  played.dispose();
  world.dispose();
});

test("effects, materials, names and numbers of 64 bits", () => {
  const world = new sc.World();
  const shell = world.createShell({ name: "Öse", userData: 2n ** 64n - 1n });
  assert.equal(shell.name, "Öse");
  assert.equal(shell.userData, 2n ** 64n - 1n);
  shell.userData = 7;
  assert.equal(shell.userData, 7n);
  shell.setEffect("planar_drag", { f_N_m: 0.2 });
  assert.equal(shell.effects[0].key, "planar_drag");
  world.removeEffect("planar_drag");
  assert.deepEqual(shell.effects, []);
  const { mass } = shell.state;
  shell.setMaterial({ density: 2 * 1270 });
  near(shell.state.mass, 2 * mass, 1e-12 * mass);
  assert.ok(sc.effects().some((e) => e.key === "planar_drag"));
  shell.setFilter({ mask: 0xff });
  assert.equal(shell.filter.mask, 0xff);
  world.gravity = [0, -1.5];
  assert.deepEqual(world.gravity, [0, -1.5]);
  world.dispose();
});

test("refusals have a kind and a sentence", () => {
  const world = new sc.World();
  const shell = world.createShell();
  for (const [call, kind, words] of [
    [() => new sc.World({ gravity: [0, Infinity] }), "bad_input", /finite/],
    [() => new sc.World({ gravity: 3 }), "bad_input", /two numbers/],
    [() => new sc.World({ quality: "best" }), "bad_input", /laboratory, game/],
    [() => world.createShell({ radus: 1 }), "bad_input", /radius/],
    [() => world.createShell({ radius: "big" }), "bad_input", /radius/],
    [() => world.createShell({ elements: 1.5 }), "bad_input", /elements/],
    [() => world.createShell({ elements: 31 - 2 ** 32 }), "bad_input", /elements is -4294967265, not a whole number/],
    [() => world.createShell({ category: 2 ** 32 }), "bad_input", /category/],
    [() => world.findShell("nobody"), "bad_input", /nobody/],
    [() => world.findShell("a\0b"), "bad_input", /zero/],
    [() => world.load(scene("two_shells"), { parameters: { mew: 1 } }), "bad_input", /mew/],
    [() => world.load({ shel: [] }), "bad_input", /shell/],
    [() => world.load("{nonsense"), "bad_input", /./],
    [() => world.add("{"), "bad_input", /./],
    [() => shell.section(2), "bad_input", /between 0 and 1/],
    [() => shell.setNaturalCurvature([1, 2]), "bad_input", /./],
    [() => world.overlapPoint([0, Infinity]), "bad_input", /./],
    [() => world.step(NaN), "bad_input", /./],
    [() => shell.teleport([0]), "bad_input", /two numbers/],
  ])
    assert.throws(call, refusal(kind, words), String(call));
  shell.destroy();
  assert.throws(() => shell.state, refusal("stale", /./));
  world.dispose();
  world.dispose();
  assert.equal(world.valid, false);
  assert.throws(() => world.step(), refusal("stale", /./));
  assert.throws(() => shell.state, refusal("stale", /./));
});

test("a scene is checked without a world", () => {
  assert.deepEqual(sc.checkScene(scene("two_shells")), []);
  const [problem] = sc.checkScene({ schema: "supercircle-scene/1", shel: [] });
  assert.ok(problem.pointer === "/shel" && problem.nearest === "shell" && problem.line > 0 && problem.text !== "");
});

test("worlds come and go, and the memory moves when it grows", () => {
  const before = sc.calls.sc_alloc(8);
  sc.calls.sc_free(before);
  for (let i = 0; i < 5000; ++i) new sc.World().dispose(); // 4095 exist at most
  const large = sc.calls.sc_alloc(1 << 26);
  const world = new sc.World();
  world.createShell();
  world.step();
  near(world.time, 1 / 60, 1e-12);
  sc.calls.sc_free(large);
  world.dispose();
});

test("two instances know nothing of each other", async () => {
  const second = await load(readFileSync(`${folder}/supercircle.wasm`));
  const world = new sc.World();
  const other = new second.World();
  other.createShell();
  assert.equal(world.shells().length, 0);
  assert.equal(other.shells().length, 1);
  world.dispose();
  other.dispose();
});

test("structs have the layout that the module says", () => {
  const layout = JSON.parse(sc.calls.sc_layout());
  const api = JSON.parse(readFileSync(`${source}/bridge/c/api.json`));
  for (const struct of api.structs) {
    assert.equal(struct.size, layout[struct.name].size, struct.name);
    for (const member of struct.members) assert.equal(member.offset, layout[struct.name].members[member.name], `${struct.name}.${member.name}`);
  }
});

test("every call is there, has a type, and is used by a class", () => {
  const api = JSON.parse(readFileSync(`${source}/bridge/c/api.json`));
  const types = readFileSync(`${folder}/supercircle.d.ts`, "utf8");
  const code = ["package/parts.js", "package/world.js", "package/library.js"].map((f) => readFileSync(`${source}/bridge/web/${f}`, "utf8")).join("\n");
  // Threads are one in WebAssembly; memory and layouts are the loader's.
  const without = new Set(["sc_api_version", "sc_error", "sc_error_status", "sc_alloc", "sc_free", "sc_layout", "sc_world_set_threads"]);
  const unused = [];
  for (const { name, header } of api.calls.filter((c) => c.header === "supercircle.h")) {
    assert.equal(typeof sc.calls[name], "function", name);
    assert.ok(types.includes(`  ${name}(`), `${name} has no type`);
    const [, kind, rest] = name.match(/^sc_(world|shell|hold|joint|mouse_joint|force|body|zone|scene)_(.*)$/) ?? [];
    if (!without.has(name) && !code.includes(name) && !(kind && code.includes(`call("${rest}"`))) unused.push(name);
  }
  assert.deepEqual(unused, []);
});

test("every member of a class is declared, and the other way round", () => {
  const types = readFileSync(`${folder}/supercircle.d.ts`, "utf8");
  const inner = new Set(["call", "closest", "hit", "constructor"]);
  for (const name of ["World", "Scene", "Shell", "Hold", "Joint", "MouseJoint", "Force", "Body", "Zone"]) {
    const body = types.match(new RegExp(`^export interface ${name} (?:extends Part )?{$([^]*?)^}$`, "m"))[1];
    const declared = new Set([...body.matchAll(/^ {2}(?:readonly |get |set )?(\w+)[(:]/gm)].map((m) => m[1]));
    const members = new Set();
    const own = name === "World" ? Object.getPrototypeOf(sc.World.prototype) : sc[name].prototype;
    for (let p = own; p !== Object.prototype; p = Object.getPrototypeOf(p))
      for (const key of Object.getOwnPropertyNames(p)) if (!inner.has(key)) members.add(key);
    const part = ["valid", "equals", "destroy", "dispose", "kind"];
    for (const key of members) assert.ok(declared.has(key) || part.includes(key), `${name}.${key} is not declared`);
    for (const key of declared) assert.ok(members.has(key) || ["world", "id"].includes(key), `${name}.${key} is declared and does not exist`);
  }
});
