// Scenes whose end states are compared between machines, and how they are played. A page runs this file, too.

/** name, parameters, whether it is quick enough for every run of the tests */
export const FIXED = [
  ["two_shells", {}, true],
  ["shell_on_cylinder", {}, true],
  ["squeeze", {}, true],
  ["stack30", { shells: 10 }, false],
  ["stack30", { shells: 18 }, false],
];
/** A crate tumbles onto a shell that lies on the ground, and rolls off it. */
const TUMBLING = JSON.stringify({
  schema: "supercircle-scene/1", gravity: { x: 0, y: -9.81 }, lengthScale: 1, duration: 2,
  body: [
    { name: "ground", type: 0, fixture: [{ friction: 0.5, polygon: { vertices: { x: [-6, 6, 6, -6], y: [-0.4, -0.4, 0, 0] } } }] },
    { name: "crate", type: 2, position: { x: 0.6, y: 3 }, angle: 0.7, angularVelocity: -3,
      fixture: [{ density: 1, friction: 0.5, polygon: { vertices: { x: [-0.3, 0.3, 0.3, -0.3], y: [-0.2, -0.2, 0.2, 0.2] } } }] },
  ],
  shell: [{ position: { x: 0, y: 1.2 }, angle: 3.14, radius: 1, thickness: 0.026, width: 1, density: 16, young_modulus: 1.5e9, mu: 0.35 }],
});
/** With dynamic bodies: Box2D's rotations take sine and cosine from the C library. */
export const DYNAMIC = [
  ["hello", {}, true],
  ["pendulum", {}, true],
  [TUMBLING, {}, true],
];

/** Hash at the end of a scene, and its steps; `limit` ends endless ones. */
export function play(sc, text, parameters, limit = 100000) {
  const world = sc.World.forScene(text);
  const scene = world.load(text, { parameters });
  let steps = 0;
  for (; !scene.finished && steps < limit; ++steps) scene.step(1 / 60);
  const bodies = world.bodies().flatMap((body) => [...body.state.centre, body.state.angle]);
  const hash = world.hash.toString(16);
  world.dispose();
  return { hash, steps, bodies };
}
