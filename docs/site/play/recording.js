// The tab "Recording": a file of a testing machine, what import understood of it, and the simulation of that test beside
// it. The laboratory is a second module, which arrives when the tab is first used.

/** Verdicts as sentences, those of verdictTitle in plugin/identification/diagnosis/result/verdict.cpp. */
const verdicts = {
  adequate: "The simulation is adequate",
  identified: "A missing effect is identified",
  ambiguous: "An effect is missing, but these runs do not decide which",
  outside_catalogue: "An effect outside the catalogue is missing",
  inconclusive: "These runs are inconclusive",
};
const wrongNumber = "A stated number is wrong"; // a title that diagnosis.json tells by its statement alone

/** What is shown of a diagnosis: {title, lines}. */
function diagnosisWords(d) {
  const plain = (label) => label.replaceAll("_", " ");
  return {
    title: d.statement.startsWith(wrongNumber) ? wrongNumber : verdicts[d.verdict],
    lines: [d.statement, ...(d.effects ?? []).slice(0, 3).map((e) => `${plain(e.label)}: probability ${e.probability.toFixed(2)}`)],
  };
}

class Laboratory {
  constructor(onProgress) {
    this.onProgress = onProgress;
    this.worker = null;
    this.waiting = new Map();
    this.next = 1;
  }

  /** Module, templates and example: a script beside the page, because pages of files may load nothing else. */
  arrived() {
    this.coming ??= new Promise((resolve, reject) => {
      const script = document.createElement("script");
      script.src = "recording_module.js";
      const missing = (what) => {
        this.coming = undefined; // a later try may find it
        script.remove();
        reject(new Error(`recording_module.js ${what}: copy it from where the page came from`));
      };
      script.onload = async () => {
        try {
          resolve({ ...recordingModule, bytes: await inflate(recordingModule.wasm) });
        } catch {
          missing("is damaged");
        }
      };
      script.onerror = () => missing("is not beside this page");
      document.head.append(script);
    });
    return this.coming;
  }

  /** A worker, begun once: requests that come while the module is on its way share it. */
  async start() {
    const { bytes } = await this.arrived();
    if (this.worker)
      return;
    const code = [$("library-code"), $("recording-worker-code")].map((part) => part.textContent);
    this.worker = new Worker(URL.createObjectURL(new Blob([code.join("\n")], { type: "text/javascript" })));
    this.worker.onmessage = ({ data }) => {
      if (data.kind === "progress")
        return this.onProgress(data.fraction, data.stage);
      this.waiting.get(data.id)?.(data);
      this.waiting.delete(data.id);
    };
    this.worker.onerror = (event) => this.stop(event.message);
    this.worker.postMessage({ kind: "start", bytes });
  }

  /** {answer} or {error}. */
  async ask(kind, request) {
    const id = this.next++;
    await this.start();
    if (id !== this.next - 1)
      return { error: "stopped" }; // another request has come while the module was on its way
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.worker.postMessage({ kind, id, request });
    });
  }

  stop(why = "stopped") {
    this.worker?.terminate();
    this.worker = null;
    for (const resolve of this.waiting.values())
      resolve({ error: why });
    this.waiting.clear();
  }
}

/** Recorded and simulated readings over the travel, or over time where nothing travels, and their difference. */
class Comparison {
  constructor(canvas) {
    this.canvas = canvas;
    this.curves = [];
  }

  show(curves) {
    this.curves = curves;
    this.draw();
  }

  draw() {
    const { context, width, height } = fitted(this.canvas);
    context.fillStyle = "#0c1015";
    context.fillRect(0, 0, width, height);
    if (this.curves.length === 0)
      return;
    const travels = this.curves.some((c) => c.displacement_m.some((d) => d !== null && d !== c.displacement_m[0]));
    const places = (c) => (travels ? c.displacement_m.map((d) => 1000 * d) : c.time_s);
    const split = Math.round(0.68 * height), unit = this.curves[0].unit;
    const known = (values) => values.filter((v) => v !== null && Number.isFinite(v));
    const range = (values) => values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
    const across = range(known(this.curves.flatMap(places)));
    const apart = this.curves.map((c) => c.recorded.map((r, i) => (r === null || c.simulated[i] === null ? null : r - c.simulated[i])));
    const word = this.curves[0].channel.replace(/_[^_]*$/, "").replaceAll("_", " ");
    const upper = this.axes(context, [64, 14, width - 14, split - 12], across, range(known(this.curves.flatMap((c) => [...c.recorded, ...c.simulated]))), "", `${word} (${unit})`);
    const lower = this.axes(context, [64, split + 16, width - 14, height - 34], across, range(known(apart.flat())), travels ? "travel (mm)" : "time (s)", `recorded - simulated (${unit})`);
    this.curves.forEach((c, k) => {
      const x = places(c);
      this.line(context, upper, x, c.recorded, "#e9eef4", 3.5);
      this.line(context, upper, x, c.simulated, "#ffb454", 1.6);
      this.line(context, lower, x, apart[k], "#6cc9ff", 1.3);
    });
    context.textAlign = "right";
    context.font = "13px system-ui, sans-serif";
    [["recorded", "#e9eef4"], ["simulated", "#ffb454"]].forEach(([name, colour], i) => {
      context.fillStyle = colour;
      context.fillText(name, width - 20, 32 + 17 * i);
    });
  }

  axes(context, [left, top, right, bottom], [x0, x1], [y0, y1], below, beside) {
    const pad = 0.06 * (y1 - y0) || 1, wide = x1 - x0 || 1;
    const x = (v) => left + (right - left) * (v - x0) / wide, y = (v) => bottom - (bottom - top) * (v - y0 + pad) / (y1 - y0 + 2 * pad);
    context.strokeStyle = "#33404f";
    context.fillStyle = "#a9b7c6";
    context.lineWidth = 1;
    context.font = "11px system-ui, sans-serif";
    const ticks = (a, b, about) => {
      const raw = (b - a) / about, size = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].find((s) => s * size >= raw) * size;
      const digits = Math.max(0, -Math.floor(Math.log10(step)));
      const out = [];
      for (let i = Math.ceil(a / step - 1e-9); i * step <= b + 1e-9 * step; ++i)
        out.push([i * step, (i * step).toFixed(digits)]);
      return out;
    };
    context.beginPath();
    context.textAlign = "right";
    for (const [v, text] of ticks(y0 - pad, y1 + pad, 4)) {
      context.moveTo(left, y(v));
      context.lineTo(right, y(v));
      context.fillText(text, left - 5, y(v) + 4);
    }
    context.textAlign = "center";
    for (const [v, text] of ticks(x0, x1, 7)) {
      context.moveTo(x(v), bottom);
      context.lineTo(x(v), bottom + 4);
      if (below)
        context.fillText(text, x(v), bottom + 16);
    }
    context.stroke();
    context.fillText(below, (left + right) / 2, bottom + 30);
    context.textAlign = "left";
    context.fillText(beside, left + 4, top - 3);
    return { x, y };
  }

  line(context, { x, y }, places, values, colour, width) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.lineJoin = "round";
    context.beginPath();
    let open = false;
    values.forEach((v, i) => {
      if (v === null || places[i] === null)
        return void (open = false);
      open ? context.lineTo(x(places[i]), y(v)) : context.moveTo(x(places[i]), y(v));
      open = true;
    });
    context.stroke();
  }
}

const recording = (() => {
  const comparison = new Comparison($("comparison"));
  const laboratory = new Laboratory((fraction, stage) => {
    $("progress").value = fraction;
    status(stage);
  });
  let dropped = {}; // bytes by name
  let files = null; // of the experiment
  let asked = 0;

  const status = (words) => { $("recording-status").textContent = words; };

  function busy(on) {
    $("stop").disabled = !on;
    $("progress").hidden = !on;
    $("progress").value = 0;
    if (on)
      $("diagnose").disabled = true;
  }

  /** The answer of a call, or null: refused or stopped, which is shown; or another request has come since. */
  async function ask(kind, request) {
    const own = ++asked;
    busy(true);
    if (laboratory.waiting.size > 0)
      laboratory.stop(); // what came before is of no interest any more
    let result;
    try {
      result = await laboratory.ask(kind, request);
    } catch (error) {
      result = { error: error.message };
    }
    if (own !== asked)
      return null;
    busy(false);
    $("diagnose").disabled = files === null;
    if (result.error !== undefined || result.answer.status === "failed") {
      status(result.error ?? result.answer.message);
      say($("recording-status").textContent);
      return null;
    }
    return result.answer;
  }

  /** Import, then replay if nothing is missing. */
  async function compare() {
    const names = Object.keys(dropped);
    if (names.length === 0)
      return;
    files = null;
    $("verdict").replaceChildren();
    const { templates } = await laboratory.arrived();
    const content = { ...dropped, "specimen.json": $("specimen").value };
    const request = { files: names, specimen: "specimen.json", content };
    const scene = templates[$("template").value]?.scene;
    if (scene) {
      content[`${scene.name}.json`] = scene.text;
      request.scene_file = `${scene.name}.json`;
    }
    status("reading ...");
    const imported = await ask("import", request);
    if (!imported)
      return comparison.show([]);
    $("account").textContent = imported.account + (imported.assumed.length ? `\nassumed: ${imported.assumed.join(", ")}` : "");
    if (imported.missing.length > 0) {
      comparison.show([]);
      return status(["Still missing in the description of the specimen:", ...imported.missing].join("\n"));
    }
    files = imported.files;
    status("simulating ...");
    const replayed = await ask("replay", { file: "experiment.json", content: files });
    if (!replayed)
      return;
    comparison.show(replayed.curves);
    const apart = replayed.replay.runs.map((run) => {
      const found = (start) => Object.keys(run).find((k) => k.startsWith(start));
      const key = found("rmse_about_mean_") ?? found("rmse_"), unit = key.split("_").at(-1), peak = Math.abs(run[found("peak_recorded_")]);
      return `${run.run}: ${unit === "N" ? unitText(run[key], unit) : `${run[key].toPrecision(2)} ${unit}`}${peak > 0 ? ` (${(100 * run[key] / peak).toPrecision(2)} % of the peak)` : ""}`;
    });
    const told = `Root mean square of the difference, nothing fitted: ${apart.join("; ")}`;
    $("comparison").setAttribute("aria-label", `Recorded and simulated readings. ${told}`);
    status(told);
    say(told);
  }

  async function diagnose() {
    $("verdict").replaceChildren();
    status("diagnosing ...");
    const begun = performance.now();
    const found = await ask("diagnose", { file: "experiment.json", content: files, next_experiment: false });
    if (!found)
      return;
    const { title, lines } = diagnosisWords(found.diagnosis);
    $("verdict").replaceChildren(...lines.map((text) => Object.assign(document.createElement("p"), { textContent: text })));
    status(`${title}. Diagnosed in ${((performance.now() - begun) / 1000).toFixed(0)} s.`);
    say(lines[0]);
  }

  async function take(list) {
    dropped = {};
    for (const file of list) {
      if (file.name.endsWith(".json"))
        $("specimen").value = await file.text();
      else
        dropped[file.name] = new Uint8Array(await file.arrayBuffer());
    }
    await prepared();
    await compare();
  }

  /** Templates, once the module has come; the first one is in the field. */
  async function prepared() {
    const { templates } = await laboratory.arrived();
    if ($("template").options.length === 0) {
      for (const [key, t] of Object.entries(templates))
        $("template").add(new Option(t.title, key));
      if ($("specimen").value === "")
        $("specimen").value = Object.values(templates)[0].specimen;
    }
    return templates;
  }

  const failed = (error) => status(error.message);
  $("template").addEventListener("change", async () => {
    $("specimen").value = (await prepared())[$("template").value].specimen;
    compare().catch(failed);
  });
  $("file").addEventListener("change", () => take($("file").files).catch(failed));
  $("example").addEventListener("click", async () => {
    try {
      const { example } = await laboratory.arrived(), templates = await prepared();
      $("template").value = example.template;
      $("specimen").value = templates[example.template].specimen;
      dropped = { [example.name]: Uint8Array.from(atob(example.base64), (c) => c.charCodeAt(0)) };
      await compare();
    } catch (error) {
      failed(error);
    }
  });
  $("again").addEventListener("click", () => compare().catch(failed));
  $("diagnose").addEventListener("click", () => diagnose().catch(failed));
  $("stop").addEventListener("click", () => laboratory.stop());
  $("keep").addEventListener("click", () => {
    for (const [name, text] of Object.entries(files ?? {}))
      saveFile(name, text);
  });
  for (const place of [$("recording"), $("comparison")]) {
    place.addEventListener("dragover", (event) => event.preventDefault());
    place.addEventListener("drop", (event) => {
      event.preventDefault();
      take(event.dataTransfer.files).catch(failed);
    });
  }
  return { open: () => prepared().catch(failed), draw: () => comparison.draw(), busy: () => !$("stop").disabled };
})();
