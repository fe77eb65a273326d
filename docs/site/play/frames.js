// Orders to the worker for each frame, and what comes back: picture, curve, words.

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
  if (document.hidden || !state.scene || $("stage").offsetParent === null)
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
    box.querySelector("button").addEventListener("click", stopHanging);
  }
  if (late > 20)
    stopHanging();
}

/** Ends the scene that hangs; its text stays in the editor. */
function stopHanging() {
  $("trouble").dataset.shown = "";
  state.stopped = $("text").value;
  engine.stop();
}

function show(frame) {
  $("trouble").dataset.shown = "";
  if (frame.idle)
    return;
  const before = performance.now();
  state.frame = frame;
  globalThis.play.onFrame?.(frame);
  const canvas = $("world"), { context } = fitted(canvas, state.ratio);
  context.setTransform(1, 0, 0, 1, 0, 0);
  drawPicture(context, frame.list.operations, frame.list.numbers, frame.list.texts);
  context.setTransform(state.ratio, 0, 0, state.ratio, 0, 0);
  drawHands(context);
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
