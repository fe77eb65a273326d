// Mouse, fingers and keys: the view, the press, and what is grabbed.

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
    Object.assign(state, { release: true, pointer: null, grab: null, drag: undefined, undecided: false });
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
  element.addEventListener("keydown", (event) => {
    if (event.key !== " " || !state.scene.pressed)
      return;
    event.preventDefault(); // a held space would scroll the page
    if (!event.repeat)
      pressing.begin(event);
  });
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
