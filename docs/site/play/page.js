// Buttons and tabs, and how the page begins.

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
$("save").addEventListener("click", () => saveFile(`${state.name ?? "scene"}.json`, state.text));
$("close").addEventListener("click", () => $("sharing").close());

const tabs = ["feel", "scenes", "json", "recording"];
for (const name of tabs)
  $(`tab-${name}`).addEventListener("click", () => {
    document.querySelector("main").dataset.tab = name;
    for (const other of tabs)
      $(`tab-${other}`).setAttribute("aria-selected", String(other === name));
    pad.draw();
    curve.draw();
    if (name === "recording") {
      recording.open();
      recording.draw();
    }
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

new ResizeObserver(() => {
  if (state.extent)
    frameView(state.extent);
  pad.draw();
  curve.draw();
}).observe($("stage"));
new ResizeObserver(() => recording.draw()).observe($("beside"));

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
  if (state.stopped !== undefined) { // not again what hung
    const text = state.stopped;
    delete state.stopped;
    await load({ name: "snap" });
    $("text").value = text;
    hint("The scene was stopped. Its text is still under JSON.");
    return;
  }
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
  engine = new Engine([$("library-code"), $("worker-code")].map((part) => part.textContent).join("\n"), bytes, hear);
  requestAnimationFrame(animate);
})();

// For tests and the curious.
globalThis.play = {
  state, load, scenes, texts, goals, pad, onFrame: null, ask: (message) => engine.ask(message), handle: () => toScreen(...handlePlace()),
  diagnosisWords,
};
