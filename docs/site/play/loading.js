// Scenes and their parameters: what is asked of the worker, and what its answer changes on the page.

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

function buildSliders() {
  $("sliders").replaceChildren();
  for (const p of state.known) {
    if (!Number.isFinite(p.min) || !Number.isFinite(p.max) || (!state.name && $("sliders").children.length >= 8))
      continue;
    const label = document.createElement("label"), value = document.createElement("output"), input = document.createElement("input");
    const id = `parameter-${p.name}`, shown = { phi_bar: "opening", mu: "friction", speed: "press speed" }[p.name] ?? p.name.replaceAll("_", " ");
    label.htmlFor = id;
    label.title = p.about ?? "";
    Object.assign(input, { type: "range", id, min: p.min, max: p.max, step: p.integer ? 1 : (p.max - p.min) / 200 || "any" });
    input.addEventListener("input", () => {
      touched();
      change({ [p.name]: Number(input.value) });
    });
    label.append(shown, value, input);
    $("sliders").append(label);
    showSlider(p.name, p.value);
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
