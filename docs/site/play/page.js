// Wires the page: what the visitor does becomes orders to the worker, what comes back becomes picture, curve and words.

const $ = (id) => document.getElementById(id);
const still = matchMedia("(prefers-reduced-motion: reduce)");
const texts = JSON.parse($("scene-texts").textContent);
const FRAME = 1 / 60; // s

const state = {
  name: "snap", text: "", scene: scenes.snap, parameters: {}, known: [], camera: { x: 0, y: 0, scale: 100 }, byHand: false,
  press: 0, drag: undefined, grab: null, release: false, pointer: null, paused: false, slow: false, single: 0, left: 0,
  frame: null, ratio: Math.min(2, devicePixelRatio || 1), simulation: 0, drawing: 0, late: 0, ghost: false, slowUntil: 0,
};

let said = -1000; // ms
/** For screen readers; what is said at one moment is one text. */
function say(words) {
  const now = performance.now();
  $("live").textContent = now - said < 50 ? `${$("live").textContent}. ${words}` : words;
  said = now;
}
const hint = (words) => { $("hint").textContent = words; };

const curve = new Curve($("curve"));
const energies = new Energies($("energy"));
const goals = new Goals($("goals"), say);
const sound = new Sound($("sound"));
const editor = new Editor($("text"), $("problems"), async (text) => {
  const answer = await engine.ask({ kind: "check", text, name: "scene" });
  editor.show(answer.problems ?? []);
});
const pad = new Pad($("pad"), (opening, friction) => {
  touched();
  change({ phi_bar: opening, mu: friction });
});

let engine = null;
let reload = 0, wanted = null; // parameters that are on their way

/* ---- loading */

const own = () => (state.name ? scenes[state.name] : foreign);

async function load({ name = null, text = name ? texts[name] : "", parameters = {}, selfPlay = false }, keepView = false) {
  const scene = name ? scenes[name] : foreign;
  const numbers = { ...defaultsOf(text), ...parameters };
  const answer = await engine.ask({
    kind: "load", text, name: name ?? "scene", parameters, seed: 1, selfPlay: selfPlay || !name, pressed: Boolean(scene.pressed),
    body: scene.body ?? null, also: scene.also ?? [], cells: scene.cells ?? [], substeps: scene.substeps ?? 1, rate: numbers.speed ?? 0.5,
    most: scene.most ? scene.most(numbers) : Infinity,
  });
  if (answer.problems)
    editor.show(answer.problems);
  if (!answer.ok) {
    say(`Not a valid scene: ${answer.problems?.[0]?.text ?? answer.message}`);
    return false;
  }
  const sameScene = state.name === name && state.text === text;
  stroke = null;
  Object.assign(state, { name, text, scene, parameters, drag: undefined, grab: null, press: 0, selfPlay, ghost: selfPlay, frame: null });
  state.known = answer.parameters;
  state.numbers = Object.fromEntries(answer.parameters.map((p) => [p.name, p.value]));
  if (!sameScene || !keepView)
    frameView(scene.view ?? padded(answer.bounds));
  if (!sameScene) {
    buildSliders();
    $("text").value = text;
    for (const button of $("pictures").children)
      button.setAttribute("aria-current", String(button.dataset.name === name));
  }
  sameScene ? curve.next() : curve.clear(scene.key);
  energies.clear();
  goals.begin();
  goals.show(scene.goals ?? []);
  showPad();
  if (!selfPlay)
    hint(scene.hint);
  return true;
}

/** Defaults that the page needs before the scene is loaded. */
function defaultsOf(text) {
  try {
    const parsed = JSON.parse(text).parameters ?? {};
    return Object.fromEntries(Object.entries(parsed).map(([k, p]) => [k, p.value]).filter(([, v]) => typeof v === "number"));
  } catch {
    return {};
  }
}

const padded = ([x0, y0, x1, y1]) => {
  const by = 0.35 * Math.max(x1 - x0, y1 - y0, 1e-3);
  return [x0 - by, y0 - by, x1 + by, y1 + by];
};

/** Changed parameters start the scene again, at most every 120 ms while something is dragged. */
function change(parameters) {
  wanted = { ...(wanted ?? state.parameters), ...parameters };
  for (const [name, value] of Object.entries(parameters))
    showSlider(name, value);
  clearTimeout(reload);
  reload = setTimeout(async () => {
    const asked = wanted;
    await load({ name: state.name, text: state.text, parameters: asked }, true);
    if (wanted === asked)
      wanted = null;
  }, 120);
}

/* ---- parameters */

function buildSliders() {
  $("sliders").replaceChildren();
  for (const p of state.known) {
    if (!Number.isFinite(p.min) || !Number.isFinite(p.max) || (!state.name && $("sliders").children.length >= 8))
      continue;
    const label = document.createElement("label"), value = document.createElement("output"), input = document.createElement("input");
    const id = `parameter-${p.name}`, label_text = { phi_bar: "opening", mu: "friction", speed: "press speed" }[p.name] ?? p.name.replaceAll("_", " ");
    label.htmlFor = id;
    label.title = p.about ?? "";
    Object.assign(input, { type: "range", id, min: p.min, max: p.max, step: p.integer ? 1 : (p.max - p.min) / 200 || "any" });
    input.addEventListener("input", () => {
      touched();
      change({ [p.name]: Number(input.value) });
    });
    label.append(`${label_text}`, value, input);
    $("sliders").append(label);
    showSlider(p.name, p.value, p.unit);
  }
}

function showSlider(name, value) {
  const input = $(`parameter-${name}`);
  if (!input)
    return;
  input.value = value;
  const unit = state.known.find((p) => p.name === name)?.unit ?? "1";
  input.previousElementSibling.textContent = `${Number(Number(value).toPrecision(3))}${unit === "1" ? "" : ` ${unit}`}`;
}

function showPad() {
  const has = Boolean(state.scene.boundary);
  $("phase").hidden = !has;
  pad.boundary = state.scene.boundary ?? null;
  if (has && wanted === null)
    pad.set(state.numbers.phi_bar, state.numbers.mu);
  $("pressing").hidden = !state.scene.pressed;
  $("curve").hidden = !state.scene.pressed && state.name !== null;
  showType();
}

function showType() {
  const { boundary, unit } = state.scene;
  if (!boundary || !state.frame) {
    $("type").textContent = "";
    return;
  }
  const peak = state.frame.peak;
  const abrupt = peak > unit(state.numbers);
  $("type").textContent = abrupt ? "Type II: the tips stick, the shell snaps or coils" : peak > 0 ? "Type I so far: the tips slide" : "";
  $("type").dataset.type = abrupt ? "II" : peak > 0 ? "I" : "";
}

/* ---- view */

function frameView([x0, y0, x1, y1]) {
  const width = $("world").clientWidth || 600, height = $("world").clientHeight || 400;
  state.extent = [x0, y0, x1, y1];
  state.camera = { x: (x0 + x1) / 2, y: (y0 + y1) / 2, scale: Math.min(width / (x1 - x0), height / (y1 - y0)) };
}

const toWorld = (px, py) => ({
  x: state.camera.x + (px - $("world").clientWidth / 2) / state.camera.scale,
  y: state.camera.y - (py - $("world").clientHeight / 2) / state.camera.scale,
});
const toScreen = (x, y) => [
  $("world").clientWidth / 2 + (x - state.camera.x) * state.camera.scale,
  $("world").clientHeight / 2 - (y - state.camera.y) * state.camera.scale,
];

/** The middle of the picture stays over the scene. */
function moveCamera(dx, dy) {
  const [x0, y0, x1, y1] = state.extent;
  state.camera.x = Math.max(x0, Math.min(x1, state.camera.x + dx));
  state.camera.y = Math.max(y0, Math.min(y1, state.camera.y + dy));
}

function zoom(px, py, by) {
  const before = toWorld(px, py);
  state.camera.scale = Math.max(1, Math.min(1e6, state.camera.scale * by));
  const after = toWorld(px, py);
  moveCamera(before.x - after.x, before.y - after.y);
}

/* ---- hands */

/** The visitor takes over from the self-play. */
function touched() {
  sound.wake();
  state.byHand = true;
  if (state.ghost || state.selfPlay) {
    state.ghost = false;
    state.selfPlay = false;
    hint(state.scene.hint);
  }
}

function handlePlace() {
  const handle = state.scene.handle?.(state.numbers);
  return handle && [handle[0], handle[1] - (state.frame?.travel ?? 0)];
}

const fingers = new Map();
let pinch = null, pan = null;

function down(event) {
  touched();
  $("world").setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  if (fingers.size === 2) {
    const [a, b] = [...fingers.values()];
    pinch = { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
    Object.assign(state, { release: true, pointer: null, drag: undefined });
    return;
  }
  const radius = 24 / state.camera.scale, at = toWorld(event.offsetX, event.offsetY), handle = handlePlace();
  const near = handle && Math.hypot(at.x - handle[0], at.y - handle[1]) < 2.5 * radius;
  // Without a plate the handle's shell is held, and anywhere in its circle takes it.
  const onShell = handle && !state.scene.body && Math.hypot(at.x - handle[0], at.y - handle[1] + 1) < 1.15;
  if (state.scene.pressed && (near || onShell)) {
    state.dragFrom = { y: at.y, travel: state.frame?.travel ?? 0 };
    state.drag = state.dragFrom.travel;
    goals.begin();
    return;
  }
  state.grab = { ...at, radius: 1.5 * radius };
  state.pointer = at;
  state.undecided = true;
  pan = { x: event.offsetX, y: event.offsetY };
}

function move(event) {
  if (!fingers.has(event.pointerId))
    return;
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  if (pinch && fingers.size === 2) {
    const [a, b] = [...fingers.values()];
    const next = { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
    moveCamera((pinch.x - next.x) / state.camera.scale, (next.y - pinch.y) / state.camera.scale);
    zoom(next.x, next.y, next.distance / Math.max(1, pinch.distance));
    pinch = next;
    return;
  }
  const at = toWorld(event.offsetX, event.offsetY);
  if (state.drag !== undefined)
    state.drag = Math.max(0, state.dragFrom.travel + state.dragFrom.y - at.y);
  else if (state.undecided || state.frame?.grabbed) {
    state.pointer = at;
    pan = { x: event.offsetX, y: event.offsetY };
  } else if (pan) {
    moveCamera((pan.x - event.offsetX) / state.camera.scale, (event.offsetY - pan.y) / state.camera.scale);
    pan = { x: event.offsetX, y: event.offsetY };
  }
}

function up(event) {
  fingers.delete(event.pointerId);
  if (fingers.size < 2)
    pinch = null;
  if (fingers.size === 0)
    Object.assign(state, { release: true, pointer: null, grab: null, drag: undefined });
  pan = null;
}

/** Press and lift act while they are held; a tap makes a whole stroke. */
function holdable(button, direction) {
  let since = 0;
  const begin = (event) => {
    event.preventDefault();
    touched();
    since = performance.now();
    stroke = null;
    if (direction > 0)
      goals.begin();
    state.press = direction;
    button.setAttribute("aria-pressed", "true");
  };
  const end = () => {
    if (!since)
      return;
    button.setAttribute("aria-pressed", "false");
    state.press = 0;
    if (performance.now() - since < 250)
      stroke = { direction, last: null };
    since = 0;
  };
  button.addEventListener("pointerdown", begin);
  for (const name of ["pointerup", "pointercancel", "pointerleave"])
    button.addEventListener(name, end);
  const keys = (event, act) => {
    if ((event.key === " " || event.key === "Enter") && !event.repeat)
      act(event);
  };
  button.addEventListener("keydown", (event) => keys(event, begin));
  button.addEventListener("keyup", (event) => keys(event, end));
  return { begin, end };
}
let stroke = null; // a whole stroke by itself: until the travel ends

const pressing = holdable($("press"), 1);
holdable($("lift"), -1);
for (const element of [$("pad"), $("world")]) {
  element.addEventListener("keydown", (event) => event.key === " " && !event.repeat && state.scene.pressed && pressing.begin(event));
  element.addEventListener("keyup", (event) => event.key === " " && pressing.end());
}
$("world").addEventListener("keydown", (event) => {
  const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
  if (by) {
    event.preventDefault();
    moveCamera(30 * by[0] / state.camera.scale, 30 * by[1] / state.camera.scale);
  } else if (event.key === "+" || event.key === "-")
    zoom($("world").clientWidth / 2, $("world").clientHeight / 2, event.key === "+" ? 1.2 : 1 / 1.2);
});
$("world").addEventListener("pointerdown", down);
$("world").addEventListener("pointermove", move);
$("world").addEventListener("pointerup", up);
$("world").addEventListener("pointercancel", up);
$("world").addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(event.offsetX, event.offsetY, Math.exp(-event.deltaY / 400));
}, { passive: false });

/* ---- frames */

let lastTime = 0;

function pressOrder() {
  if (!stroke)
    return state.press;
  const travel = state.frame?.travel ?? 0;
  if (stroke.last !== null && Math.abs(travel - stroke.last) < 1e-9 && ++stroke.still > 2)
    stroke = null;
  else
    stroke = { direction: stroke.direction, last: travel, still: stroke.still ?? 0 };
  return stroke ? stroke.direction : 0;
}

function order(elapsed) {
  const rate = state.slow ? 0.15 : performance.now() < state.slowUntil ? 0.25 : 1;
  let steps = 0, dt = FRAME;
  if (state.single > 0) {
    steps = 1;
    --state.single;
  } else if (!state.paused) {
    if (rate < 1) {
      steps = 1;
      dt = FRAME * rate;
    } else {
      state.left = Math.min(state.left + elapsed, 2.5 * FRAME);
      steps = Math.floor(state.left / FRAME + 1e-3);
      state.left = Math.max(0, state.left - steps * FRAME);
    }
  }
  const canvas = $("world");
  const message = {
    steps, dt, press: pressOrder(), drag: state.drag, grab: state.grab, release: state.release, pointer: state.pointer,
    sound: sound.on, wantNested: !goals.done.has("nest"),
    view: {
      width: Math.max(1, Math.round(canvas.clientWidth * state.ratio)), height: Math.max(1, Math.round(canvas.clientHeight * state.ratio)),
      centre: [state.camera.x, state.camera.y], pixelsPerMetre: state.camera.scale * state.ratio, pixelRatio: state.ratio,
      clock: performance.now() / 1000, reducedMotion: still.matches, layers: "bodies shells strain contacts holds",
    },
  };
  return message;
}

function animate(now) {
  requestAnimationFrame(animate);
  const elapsed = Math.min(0.1, (now - lastTime) / 1000);
  if (document.hidden || !state.scene)
    return;
  const late = engine.lateness();
  $("trouble").hidden = late < 2;
  if (late >= 2)
    showHanging(late);
  if (late > 0)
    return; // the last order is on its way
  engine.tick(order(elapsed));
  lastTime = now;
  state.grab = null;
  state.release = false;
}

function showHanging(late) {
  const box = $("trouble");
  if (box.dataset.shown !== "1") {
    box.dataset.shown = "1";
    box.innerHTML = "This scene takes long. <button type=\"button\">Stop it</button>";
    box.querySelector("button").addEventListener("click", () => {
      box.dataset.shown = "";
      engine.stop();
    });
  }
  if (late > 20) {
    box.dataset.shown = "";
    engine.stop();
  }
}

function show(frame) {
  $("trouble").dataset.shown = "";
  if (frame.idle)
    return;
  const before = performance.now();
  state.frame = frame;
  globalThis.play.onFrame?.(frame);
  const canvas = $("world"), { context, width, height } = fitted(canvas, state.ratio);
  context.setTransform(1, 0, 0, 1, 0, 0);
  drawPicture(context, frame.list.operations, frame.list.numbers, frame.list.texts);
  context.setTransform(state.ratio, 0, 0, state.ratio, 0, 0);
  drawHands(context, width, height);
  if (state.scene.pressed || state.name === null) {
    curve.add(frame.travel, frame.force, frame.loads[0]);
    curve.draw();
  }
  energies.show(frame.energy);
  sound.play(frame.sound ?? []);
  snapWords(frame);
  goals.see(frame, FRAME, { unit: state.scene.boundary && state.scene.unit(state.numbers), most: state.scene.most?.(state.numbers), byHand: state.byHand });
  showType();
  if (state.selfPlay && frame.mode === "hand") {
    state.selfPlay = state.ghost = false;
    hint("Your turn: grab it.");
  }
  if (frame.decided)
    state.undecided = false;
  $("world").style.cursor = frame.grabbed || state.drag !== undefined ? "grabbing" : "";
  const drawn = performance.now() - before;
  state.simulation += 0.05 * (frame.simulation - state.simulation);
  state.drawing += 0.05 * (drawn + frame.picture - state.drawing);
  $("times").textContent = `${state.simulation.toFixed(1)} ms simulation, ${state.drawing.toFixed(1)} ms picture` +
    `${frame.exhausted || state.slow ? ", in slow motion" : ""}`;
  // Late pictures get fewer pixels: half the pixels halve the time of filling.
  state.late = drawn > 14 ? state.late + 1 : Math.max(0, state.late - 0.2);
  if (state.late > 30 && state.ratio > 0.75) {
    state.ratio = Math.max(0.75, state.ratio * 0.75);
    state.late = 0;
  }
}

function snapWords(frame) {
  if (frame.snaps.length === 0)
    return;
  const largest = Math.max(...frame.snaps.map((s) => s.energy));
  say(`Snap, ${unitText(largest, "J")}`);
  if (state.byHand && state.scene.boundary)
    hint(`Snapped: ${unitText(largest, "J")} released. Now drag the orange dot into the blue and press: does it still snap?`);
  if (!still.matches && state.selfPlay)
    state.slowUntil = performance.now() + 500;
}

/** The handle of the press, and the finger of the self-play. */
function drawHands(context) {
  const place = handlePlace();
  if (!place)
    return;
  const [x, y] = toScreen(...place);
  if (state.drag !== undefined) { // the hand is ahead of the press
    const wanted = toScreen(place[0], place[1] + state.frame.travel - state.drag);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(...wanted);
    context.strokeStyle = "#ffb454";
    context.lineWidth = 2;
    context.stroke();
  }
  context.beginPath();
  context.arc(x, y, state.ghost ? 16 : 11, 0, 7);
  context.fillStyle = state.drag !== undefined || state.ghost ? "rgba(255,180,84,0.85)" : "rgba(255,180,84,0.35)";
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = "#fff";
  context.stroke();
}

/* ---- buttons */

function toggle(button, key) {
  button.addEventListener("click", () => {
    state[key] = !state[key];
    button.setAttribute("aria-pressed", String(state[key]));
    if (key === "paused")
      button.textContent = state.paused ? "Play" : "Pause";
  });
}
toggle($("pause"), "paused");
toggle($("slow"), "slow");
$("step").addEventListener("click", () => {
  if (!state.paused)
    $("pause").click();
  state.single = 1;
});
$("restart").addEventListener("click", () => load({ name: state.name, text: state.text, parameters: state.parameters }));
$("fit").addEventListener("click", () => frameView(state.extent));
$("world").addEventListener("dblclick", () => frameView(state.extent));
$("run").addEventListener("click", async () => {
  touched();
  const text = $("text").value, name = Object.keys(texts).find((n) => texts[n] === text) ?? null;
  if (await load({ name, text, parameters: name ? state.parameters : {} }))
    say("The text runs.");
});
$("share").addEventListener("click", async () => {
  const packed = await linkOf({ name: state.name, text: state.text, parameters: state.parameters });
  $("link").value = packed === null ? "" : `${location.href.replace(/#.*/, "")}#${packed}`;
  $("sharing-note").textContent = packed === null ? "This text is too long for a link. Save it as a file." : "The link carries scene and numbers.";
  $("link").hidden = $("copy").hidden = packed === null;
  if (packed !== null)
    history.replaceState(null, "", `#${packed}`);
  $("sharing").showModal();
});
$("copy").addEventListener("click", async () => {
  $("link").select();
  try {
    await navigator.clipboard.writeText($("link").value);
  } catch {
    document.execCommand("copy");
  }
  $("copy").textContent = "Copied";
  setTimeout(() => { $("copy").textContent = "Copy"; }, 2000);
  say("Copied.");
});
$("save").addEventListener("click", () => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([state.text], { type: "application/json" }));
  link.download = `${state.name ?? "scene"}.json`;
  link.click();
});
$("close").addEventListener("click", () => $("sharing").close());

const tabs = ["feel", "scenes", "json"];
for (const name of tabs)
  $(`tab-${name}`).addEventListener("click", () => {
    document.querySelector("main").dataset.tab = name;
    for (const other of tabs)
      $(`tab-${other}`).setAttribute("aria-selected", String(other === name));
    pad.draw();
    curve.draw();
  });

function buildPictures() {
  for (const [name, scene] of Object.entries(scenes)) {
    const button = document.createElement("button"), canvas = document.createElement("canvas");
    button.type = "button";
    button.dataset.name = name;
    button.append(canvas, scene.title);
    button.addEventListener("click", () => {
      touched();
      load({ name });
    });
    $("pictures").append(button);
    const picture = pictures[name];
    if (!picture)
      continue;
    canvas.width = picture.width;
    canvas.height = picture.height;
    inflate(picture.list).then((bytes) => {
      const numbers = new Float32Array(bytes.buffer, 0, picture.numbers);
      const operations = new Int32Array(bytes.buffer, 4 * picture.numbers, picture.operations);
      drawPicture(canvas.getContext("2d"), operations, numbers, picture.texts);
    });
  }
}

/* ---- start */

new ResizeObserver(() => {
  if (state.extent)
    frameView(state.extent);
  pad.draw();
  curve.draw();
}).observe($("stage"));

function hear(answer) {
  if (answer.kind === "frame")
    show(answer);
  else if (answer.kind === "started")
    begin();
  else if (answer.kind === "failed") {
    $("trouble").hidden = false;
    $("trouble").textContent = answer.message;
  }
}

async function begin() {
  let asked = null;
  try {
    asked = await readLink(location.hash);
  } catch {
    hint("This link is damaged.");
  }
  const named = asked?.name && scenes[asked.name];
  if (asked && (named || asked.text)) {
    state.byHand = true;
    if (await load(asked))
      return;
  }
  await load({ name: "snap", selfPlay: true });
  hint("A shell is pressed over a cylinder ...");
}

(async () => {
  buildPictures();
  const bytes = await inflate($("module").textContent.trim());
  engine = new Engine($("worker-code").textContent, bytes, hear);
  requestAnimationFrame(animate);
})();

// For tests and the curious.
globalThis.play = {
  state, load, scenes, texts, goals, pad, onFrame: null, ask: (message) => engine.ask(message), handle: () => toScreen(...handlePlace()),
};
