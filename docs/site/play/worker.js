// The physics: one world in a worker, so that no scene can stop the page. Answers every message.

const FRAME = 1 / 60; // s
let library = null;
let playing = null; // {text, name, world, scene, ...}: what runs goes on while a new text is wrong

function describeProblems(list) {
  return list.map((p) => ({
    line: p.line, column: p.column, pointer: p.pointer, text: p.text, nearest: p.nearest, note: p.note,
  }));
}

function open(request) {
  const problems = library.checkScene(request.text, request.name);
  const errors = problems.filter((p) => !p.note);
  if (errors.length > 0)
    return { problems: describeProblems(problems) };
  const world = library.World.forScene(request.text, { quality: "game" });
  let scene;
  try {
    scene = world.load(request.text, { seed: request.seed, parameters: request.parameters, file: request.name });
  } catch (error) {
    world.dispose();
    return { problems: [{ line: 0, column: 0, pointer: "", text: error.message, nearest: "", note: false }] };
  }
  const next = {
    ...request, world, scene, mode: request.selfPlay ? "protocol" : "hand", travel: 0, speed: 0, force: 0, peak: 0,
    grab: null, snaps: [],
  };
  if (request.body)
    world.attachCrosshead(request.body);
  return { problems: describeProblems(problems), next };
}

function bounds(world) {
  let box = null;
  for (const shell of world.shells()) {
    const { lower, upper } = shell.state;
    box = box === null ? [...lower, ...upper]
      : [Math.min(box[0], lower[0]), Math.min(box[1], lower[1]), Math.max(box[2], upper[0]), Math.max(box[3], upper[1])];
  }
  return box ?? [-1, -1, 1, 1];
}

const finite = (x) => (Number.isFinite(x) ? x : 0);

/** Velocity of the crosshead for this step, positive downwards; the hand moves it, or a drag asks for a travel. */
function wantedSpeed(p, order, dt) {
  const v = order.drag === undefined ? order.press * p.rate
    : Math.max(-4 * p.rate, Math.min(4 * p.rate, (order.drag - p.travel) / (4 * dt)));
  return Math.max(-p.travel / dt, Math.min((p.most - p.travel) / dt, v));
}

function moveCrosshead(p, order, dt) {
  p.speed = wantedSpeed(p, order, dt);
  p.world.setCrossheadVelocity([0, -p.speed]);
  for (const name of p.also)
    p.world.findBody(name).setVelocity([0, -p.speed]);
}

function grab(p, order) {
  if (order.grab) {
    drop(p);
    const at = { x: order.grab.x, y: order.grab.y };
    p.grab = grabBody(p, at) ?? grabShell(p, at, order.grab.radius) ?? grabBody(p, at, order.grab.radius);
  }
  if (order.release)
    drop(p);
  if (p.grab && order.pointer) {
    try {
      p.grab.move(order.pointer);
    } catch {
      p.grab = null;
    }
  }
}

function grabShell(p, at, radius) {
  try {
    const hit = p.world.closestPoint(at, radius);
    return hit.shell.grab(hit.arc, at, { frequency: 4, dampingRatio: 1 });
  } catch {
    return null;
  }
}

/** The loose body under a place, or the first one found on a circle around it. */
function grabBody(p, at, radius = 0) {
  for (let i = 0; i < (radius > 0 ? 8 : 1); ++i) {
    const there = { x: at.x + radius * Math.cos(i * Math.PI / 4), y: at.y + radius * Math.sin(i * Math.PI / 4) };
    try {
      return p.world.grabBody(there, 0);
    } catch { /* nothing there */ }
  }
  return null;
}

function drop(p) {
  try {
    p.grab?.destroy();
  } catch { /* its shell is gone */ }
  p.grab = null;
}

/** A frame of dt seconds; returns the report of its last step. */
function advance(p, order, dt) {
  let frame = null, force = 0;
  for (let i = 0; i < p.substeps; ++i) {
    frame = step(p, i === 0 ? order : { ...order, grab: null, release: false }, dt / p.substeps);
    force += p.force / p.substeps;
    for (const e of p.world.events())
      if (e.kind === "snap_end")
        p.snaps.push({ energy: e.energyReleased });
  }
  p.force = force;
  return frame;
}

/** One step of the world. A hand on the press ends the protocol. */
function step(p, order, dt) {
  if (p.mode === "protocol" && (order.press !== 0 || order.drag !== undefined || order.grab))
    p.mode = "hand";
  if (p.mode === "protocol" && p.scene.finished)
    p.mode = "hand";
  grab(p, order);
  let frame;
  if (p.mode === "protocol") {
    frame = p.scene.step(dt);
    p.travel = p.scene.travel;
    p.force = p.scene.force;
  } else {
    if (p.pressed)
      moveCrosshead(p, order, dt);
    frame = p.world.step(dt);
    p.travel = finite(p.travel + p.speed * frame.advanced);
    p.force = p.pressed ? finite(p.world.crossheadForce[1]) : 0;
  }
  p.peak = Math.max(p.peak, p.force);
  return frame;
}

/** Largest number of shells whose boxes have one middle, to an eighth of their width. */
function nested(world) {
  const boxes = world.shells().map((shell) => {
    const { lower, upper } = shell.state;
    return { x: (lower[0] + upper[0]) / 2, y: (lower[1] + upper[1]) / 2, near: (upper[0] - lower[0]) / 8 };
  });
  return Math.max(0, ...boxes.map((a) => boxes.filter((b) => Math.hypot(a.x - b.x, a.y - b.y) < a.near).length));
}

function tick(order) {
  const p = playing;
  const begin = performance.now();
  p.snaps = [];
  let frame = { advanced: 0, budgetExhausted: false, quarantined: 0 };
  for (let i = 0; i < order.steps; ++i)
    frame = advance(p, i === 0 ? order : { ...order, grab: null, release: false }, order.dt);
  const simulated = performance.now();
  const list = p.world.picture(order.view);
  const energy = p.world.energy;
  const loads = p.cells.map((c) => c.stiffness * (c.rest - p.world.findBody(c.body).state.centre[1]));
  const sound = order.sound ? p.world.sound(order.steps * order.dt) : null;
  const answer = {
    kind: "frame", list, time: p.world.time, travel: p.travel, force: p.force, peak: p.peak, loads, mode: p.mode, snaps: p.snaps,
    energy: { kinetic: energy.kinetic, bending: energy.bending, friction: energy.friction, impact: energy.impact },
    grabbed: p.grab !== null, decided: Boolean(order.grab), nested: order.wantNested ? nested(p.world) : 0, exhausted: Boolean(frame.budgetExhausted),
    quarantined: frame.quarantined, sound, simulation: simulated - begin, picture: performance.now() - simulated,
  };
  const transfer = [list.operations.buffer, list.numbers.buffer];
  if (sound)
    transfer.push(sound.buffer);
  postMessage(answer, transfer);
}

/** Hash of a fresh world of what is playing after a number of frames: equal on every machine. */
function hashAfter(steps) {
  const { next } = open({ ...playing, selfPlay: true });
  for (let i = 0; i < steps && !next.scene.finished; ++i)
    next.scene.step(FRAME);
  const hash = String(next.world.hash);
  next.world.dispose();
  return hash;
}

/** Plays on without pictures; how many shells were in quarantine at most, and whether every number is finite. */
function forward(steps) {
  const p = playing;
  let quarantined = 0;
  for (let i = 0; i < steps; ++i)
    quarantined = Math.max(quarantined, advance(p, { press: 0, grab: null, release: false, pointer: null }, FRAME).quarantined);
  return { quarantined, time: p.world.time, finite: p.world.shells().every((s) => s.state.centre.every(Number.isFinite)) };
}

const answers = {
  async start(m) {
    library = await supercircle.load(m.bytes);
    postMessage({ kind: "started", version: library.version });
  },
  load(m) {
    const { problems, next } = open(m);
    if (next) {
      playing?.world.dispose();
      playing = next;
    }
    postMessage({
      kind: "loaded", id: m.id, ok: next !== undefined, problems, name: next?.scene.name, bounds: next && bounds(next.world),
      parameters: next?.scene.parameters, shells: next?.world.shells().length,
    });
  },
  check(m) {
    postMessage({ kind: "checked", id: m.id, problems: describeProblems(library.checkScene(m.text, m.name)) });
  },
  tick(m) {
    if (playing)
      tick(m);
    else
      postMessage({ kind: "frame", idle: true });
  },
  forward(m) {
    postMessage({ kind: "forward", id: m.id, ...forward(m.steps) });
  },
  hash(m) {
    postMessage({ kind: "hash", id: m.id, hash: hashAfter(m.steps) });
  },
};

onmessage = async (event) => {
  try {
    await answers[event.data.kind](event.data);
  } catch (error) {
    postMessage({ kind: "failed", of: event.data.kind, id: event.data.id, message: error.message });
  }
};
