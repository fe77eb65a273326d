// What the page knows of its twelve scenes beyond their JSON. Lengths in m, forces in N; `p`: the scene's parameters.

/** Equation (1) of Sano et al., supplement: friction above which a tip sticks on a cylinder of the shell's own radius. */
function stickingFriction(opening) {
  const phi = Math.PI * opening, c = Math.cos(phi), s = Math.sin(phi);
  const ratio = (0.5 - 1.5 * c * c + c - phi * s * c) / (0.5 * phi - 1.5 * s * c + phi * c * c);
  return Math.abs(Math.tan(Math.PI - phi + Math.atan(ratio)));
}

/** Bending stiffness over R^2 of a shell of R = 1 m and 0.02 kg (density and modulus as in the scenes). */
const forceUnit = (p) => 21.6403 * (p.stiffness ?? 4);
const overCylinder = (opening, clearance) => {
  const phi = Math.PI * opening;
  return -Math.cos(phi) + Math.sqrt((1 + clearance) ** 2 - Math.sin(phi) ** 2);
};
const thickness = 0.0005 / 0.0192;

/** Friction above which a shell jumps over its twin: bisected with runs of the scene, peak force above B / R^2. */
const twins = [
  [0.78, 0.937], [0.79, 0.835], [0.8, 0.739], [0.81, 0.649], [0.82, 0.571],
  [0.83, 0.497], [0.84, 0.427], [0.85, 0.36], [0.86, 0.298], [0.87, 0.239],
  [0.88, 0.185], [0.89, 0.132], [0.9, 0.079], [0.91, 0.028], [0.92, 0.001],
];
function twinFriction(opening) {
  for (let i = 1; i < twins.length; ++i)
    if (opening <= twins[i][0]) {
      const [x0, y0] = twins[i - 1], [x1, y1] = twins[i];
      return opening < x0 ? NaN : y0 + (y1 - y0) * (opening - x0) / (x1 - x0);
    }
  return NaN;
}

const scenes = {
  snap: {
    title: "Snap", goals: ["snap", "stick", "hold"], hint: "Drag the shell down over the cylinder, or press.", view: [-2.2, -1.35, 2.2, 3.2],
    pressed: true, most: (p) => 0.97 * overCylinder(p.phi_bar, 0.001), unit: forceUnit, boundary: stickingFriction,
    handle: (p) => [0, overCylinder(p.phi_bar, 0.001) + 1], selfPlay: true,
  },
  two_shells: {
    title: "Two shells", goals: ["snap", "stick", "hold"], hint: "Both bend. The upper one slides or sticks.", view: [-2.3, -2.1, 2.3, 3.3],
    pressed: true, most: (p) => 0.95 * (overCylinder(p.phi_bar, thickness + 0.001) - thickness), unit: forceUnit,
    boundary: twinFriction, handle: (p) => [0, overCylinder(p.phi_bar, thickness + 0.001) + 1],
  },
  nest: {
    title: "Nest", goals: ["nest"], hint: "Press three shells into one nest.", view: [-3.6, -0.5, 3.6, 7.6],
    pressed: true, body: "press", most: () => 5.15, handle: () => [0, 7.15],
  },
  pile_and_press: {
    title: "Pile and press", goals: ["five", "joules"], hint: "Let them fall, then press. How many snaps in one stroke?", view: [-5.4, -0.5, 5.4, 11.4],
    pressed: true, body: "press", most: () => 8.2, handle: () => [0, 10.95],
  },
  drop_and_throw: { title: "Drop and throw", hint: "Grab a shell and throw it. Hang one on the post.", view: [-7.6, -0.6, 7.6, 8] },
  ramp_and_pins: { title: "Ramp and pins", hint: "Closed side down they roll, tips down they stay.", view: [-7.6, -0.6, 9.2, 9.4] },
  ring_tyres: { title: "Ring tyres", hint: "Closed shells as tyres on driven hubs. Change friction and torque.", view: [-9.6, -0.7, 13.6, 5] },
  crash_bumper: { title: "Crash bumper", hint: "Shells wrap around each other and take the blow.", view: [-9.2, -0.6, 7.6, 5] },
  egg_crate: { title: "Egg crate", hint: "The cups snap around the eggs. Pull one out.", view: [-4.6, -0.6, 4.6, 6.4] },
  shell_tower: { title: "Shell tower", hint: "Throw the ball at the tower.", view: [-9.6, -0.6, 9.6, 8] },
  peg_board: { title: "Peg board", hint: "Some hang on the pegs.", view: [-5.4, -0.5, 5.4, 12.2] },
  welded_boxes: {
    title: "Welded boxes", key: ["shell", "boxes"], hint: "Left a shell, right the usual chain of boxes on weld joints. Red: what a load cell under the boxes says.",
    view: [-2.2, -2.3, 5.4, 3.2], pressed: true, most: () => 0.97 * overCylinder(0.9, 0.001),
    handle: () => [0, overCylinder(0.9, 0.001) + 1], also: ["press of boxes"], substeps: 16,
    cells: [{ body: "load cell", rest: 0, stiffness: 4 * (2 * Math.PI * 20) ** 2 }],
  },
};

/** A scene of somebody else: its view comes from its shells, a protocol plays by itself. */
const foreign = { title: "Your scene", hint: "Your text plays.", view: null };
