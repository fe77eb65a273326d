// The page in Chromium, as its visitors use it: mouse, fingers, keyboard alone, links, files, wrong texts.
//
//     node page.mjs PAGE PACKAGES [PICTURES]
//
// PACKAGES: a folder where npm's packages are or will be installed. PICTURES: a folder for screenshots. Exit code 77:
// no npm or no browser. The environment variable PARTS names the parts to run, such as PARTS=links,keyboard.

import { execFileSync } from "node:child_process";
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { chromium as command } from "../bridge/web/browser.mjs";
import { install } from "../bridge/web/installed.mjs";

const [file, packages, pictures] = process.argv.slice(2);
if (!fs.existsSync(file)) {
  console.log(`skipped: there is no ${file}; docs/site/play/build.py makes it`);
  process.exit(77);
}
install(packages);
const here = createRequire(path.join(path.resolve(packages), "package.json"));
const { chromium } = here("playwright-core");
const axe = fs.readFileSync(here.resolve("axe-core/axe.min.js"), "utf8");
const url = pathToFileURL(path.resolve(file)).href;
if (command() === null) {
  console.log("skipped: there is no Chromium");
  process.exit(77);
}
const executablePath = execFileSync("sh", ["-c", `command -v ${command()}`], { encoding: "utf8" }).trim();
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const patience = 180000; // ms: machines may be busy, and nothing here is a test of speed
const wide = { viewport: { width: 1280, height: 720 } }, narrow = { viewport: { width: 400, height: 800 }, hasTouch: true, isMobile: true };

async function open(settings, hash = "") {
  const context = await browser.newContext(settings), page = await context.newPage();
  page.setDefaultTimeout(patience);
  page.problems = [];
  page.on("console", (m) => ["error", "warning"].includes(m.type()) && page.problems.push(m.text()));
  page.on("pageerror", (e) => page.problems.push(e.message));
  page.on("request", (r) => /^(file|data|blob):/.test(r.url()) || page.problems.push(`asks the network: ${r.url()}`));
  await page.goto(url + hash);
  await page.waitForFunction(() => globalThis.play?.state.frame?.time > 0, null, { timeout: patience });
  return page;
}
async function close(page) {
  assert.deepEqual(page.problems, []);
  await page.context().close();
}
const show = async (page, name) => pictures && page.screenshot({ path: path.join(pictures, `${name}.png`) });

/** Waits until the page has drawn `count` pictures that were asked for after now. */
const drawn = (page, count = 3) => page.evaluate((n) => new Promise((resolve) => {
  play.onFrame = () => {
    if (--n < 0) {
      play.onFrame = null;
      requestAnimationFrame(() => resolve());
    }
  };
}), count);
const timeOf = (page) => page.evaluate(() => play.state.frame.time);

async function selfPlay() {
  const page = await open(wide);
  await page.waitForFunction(() => document.getElementById("live").textContent.startsWith("Snap, "), null, { timeout: patience });
  await show(page, "wide_snap");
  await page.waitForFunction(() => document.getElementById("hint").textContent.startsWith("Your turn"), null, { timeout: patience });
  assert.equal(await page.evaluate(() => play.goals.snaps), 1); // the shell snaps once on its way down
  assert.equal(await page.evaluate(() => play.goals.done.size), 0); // the visitor has done nothing yet
  await close(page);
}

/** Drags the dot to an opening angle and a friction, presses for a whole stroke, and returns the type that the page shows. */
async function typeAt(page, opening, friction) {
  const box = await page.locator("#pad").boundingBox();
  const at = await page.evaluate(([o, f]) => play.pad.place(o, f), [opening, friction]);
  await page.mouse.move(box.x + 40, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + at[0], box.y + at[1], { steps: 3 });
  await page.mouse.up();
  await page.waitForFunction(([o, f]) => Math.abs(play.state.numbers.phi_bar - o) < 0.004 && Math.abs(play.state.numbers.mu - f) < 0.02 &&
    play.state.frame?.travel === 0, [opening, friction], { timeout: patience });
  await page.click("#press"); // a tap is a whole stroke
  await page.waitForFunction(() => play.state.frame?.travel > 0.97 * play.state.scene.most(play.state.numbers), null, { timeout: patience });
  return page.evaluate(() => document.getElementById("type").dataset.type);
}

async function phaseDiagram() {
  const page = await open(wide, "#s=snap&phi_bar=0.8&mu=0.3&speed=1");
  for (const opening of [0.8, 0.85, 0.9]) {
    const boundary = await page.evaluate((o) => play.scenes.snap.boundary(o), opening);
    assert.equal(await typeAt(page, opening, 0.65 * boundary), "I", `below the boundary at ${opening}`);
    assert.equal(await typeAt(page, opening, 1.35 * boundary), "II", `above the boundary at ${opening}`);
  }
  assert.ok(await page.evaluate(() => play.goals.done.has("stick")));
  await close(page);
}

async function everyScene() {
  const page = await open(wide);
  for (const name of await page.evaluate(() => Object.keys(play.scenes))) {
    await page.click(`#pictures button[data-name="${name}"]`);
    await page.waitForFunction((n) => play.state.name === n && play.state.frame?.time > 0, name, { timeout: patience });
    // A frame that is out of budget is shorter: as many as it takes. Small portions: the page stops what answers nothing for long.
    let answer = { time: 0 };
    for (let portion = 0; portion < 200 && answer.time <= 9.99; ++portion) {
      answer = await page.evaluate(() => play.ask({ kind: "forward", steps: 30 }));
      assert.equal(answer.quarantined, 0, name);
      assert.ok(answer.finite, name);
    }
    assert.ok(answer.time > 9.99, `${name} stands still at ${answer.time} s`);
    await drawn(page);
    await show(page, `wide_${name}`);
    await page.setViewportSize(narrow.viewport);
    await drawn(page);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${name} scrolls sideways`);
    await show(page, `narrow_${name}`);
    await page.setViewportSize(wide.viewport);
  }
  await close(page);
}

async function wrongText() {
  const page = await open(wide);
  await page.click("#tab-json");
  await page.fill("#text", (await page.inputValue("#text")).replace('"thickness":', '"thicknes":'));
  const problem = page.locator("#problems li button").first();
  await problem.waitFor();
  const told = await problem.textContent();
  const line = (await page.inputValue("#text")).split("\n").findIndex((l) => l.includes('"thicknes"')) + 1;
  assert.match(told, new RegExp(`:${line}:\\d+: .*thicknes`));
  const before = await page.evaluate(() => play.state.frame?.time);
  await page.click("#run");
  await page.waitForFunction((t) => play.state.frame?.time > t, before); // what ran goes on
  await problem.click();
  const chosen = await page.evaluate(() => { const a = document.getElementById("text"); return a.value.slice(a.selectionStart, a.selectionEnd); });
  assert.equal(chosen, '"thicknes"');
  await show(page, "wide_problem");
  await page.locator("#problems button.mend").first().click();
  await page.waitForFunction(() => document.getElementById("problems").children.length === 0);
  assert.ok((await page.inputValue("#text")).includes('"thickness":'));
  await close(page);
}

async function hanging() {
  const page = await open(wide, "#s=ramp_and_pins");
  await page.click("#tab-json");
  await page.fill("#text", "{ }  my own text");
  const endless = page.evaluate(() => play.ask({ kind: "forward", steps: 1e9 })); // nothing else is heard meanwhile
  await page.locator("#trouble button").click();
  assert.equal((await endless).ok, false);
  await page.waitForFunction(() => play.state.name === "snap" && play.state.frame?.time > 0); // and not the link again
  assert.equal(await page.inputValue("#text"), "{ }  my own text");
  await close(page);
}

async function recordings() {
  const page = await open(wide);
  // Verdicts are the program's sentences, and no word of a code is shown.
  const verdict = fs.readFileSync(new URL("../../plugin/identification/diagnosis/result/verdict.cpp", import.meta.url), "utf8");
  for (const key of ["adequate", "identified", "ambiguous", "outside_catalogue", "inconclusive"]) {
    const shown = await page.evaluate((v) => play.diagnosisWords({ verdict: v, statement: "It is so.", effects: [{ label: "planar_drag", probability: 0.876 }] }), key);
    assert.ok(verdict.includes(`"${shown.title}"`), shown.title);
    assert.deepEqual(shown.lines, ["It is so.", "planar drag: probability 0.88"]);
  }
  const wrong = await page.evaluate(() => play.diagnosisWords({ verdict: "identified", statement: "A stated number is wrong: friction is 0.3.", effects: [] }));
  assert.ok(wrong.title === "A stated number is wrong" && verdict.includes(`"${wrong.title}"`));
  const status = (start) => page.waitForFunction((s) => document.getElementById("recording-status").textContent.startsWith(s), start, { timeout: patience });
  await page.click("#tab-recording");
  await page.click("#example");
  await status("Root mean square");
  const told = await page.textContent("#recording-status");
  assert.ok(Number(/\((\S+) % of the peak\)/.exec(told)?.[1]) < 1, told);
  assert.match(await page.textContent("#account"), /Windows-1252/);
  await show(page, "wide_recording");
  await accessible(page, "wide recording");
  await page.click("#diagnose");
  await page.waitForFunction(() => document.getElementById("progress").value > 0, null, { timeout: patience });
  await page.click("#stop");
  await status("stopped");
  // A description that does not fit is refused with a sentence; the file stays, and mended text compares again.
  const good = await page.inputValue("#specimen");
  await page.fill("#specimen", good.replace('"thickness_m"', '"thicknes_m"'));
  await page.click("#again");
  await page.waitForFunction(() => /missing[^]*thickness_m/.test(document.getElementById("recording-status").textContent));
  await page.fill("#specimen", good);
  await page.click("#again");
  await status("Root mean square");
  // A file of one's own, chosen or dropped.
  const table = "time [s];travel [mm];force [N]\n" +
    Array.from({ length: 60 }, (_, i) => `${0.2 * i};${0.2 * Math.min(i, 59 - i)};${0.001 * Math.min(i, 59 - i)}`).join("\n");
  for (const place of ["comparison", "recording"]) {
    const name = `dropped_on_${place}.csv`;
    const taken = await page.evaluate(([id, file, text]) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([text], file, { type: "text/csv" }));
      // refused by default: the browser would leave the page for the file
      return ["dragover", "drop"].map((kind) => !document.getElementById(id).dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true })));
    }, [place, name, table]);
    assert.deepEqual(taken, [true, true], place);
    await page.waitForFunction((n) => document.getElementById("account").textContent.includes(n), name, { timeout: patience });
    await status("Root mean square");
  }
  await page.setInputFiles("#file", { name: "mine.csv", mimeType: "text/csv", buffer: Buffer.from(table) });
  await page.waitForFunction(() => document.getElementById("account").textContent.includes("mine.csv"));
  await status("Root mean square");
  await page.setInputFiles("#file", { name: "empty.csv", mimeType: "text/csv", buffer: Buffer.from("no numbers here") });
  await page.waitForFunction(() => document.getElementById("recording-status").textContent.includes("empty.csv"));
  await page.click("#tab-feel"); // the shells go on
  const time = await page.evaluate(() => play.state.frame.time);
  await page.waitForFunction((t) => play.state.frame.time > t, time, { timeout: patience });
  await close(page);
}

const hashOf = (page) => page.evaluate(() => play.ask({ kind: "hash", steps: 90 }).then((a) => a.hash));

async function links() {
  for (const own of [false, true]) {
    const page = await open(wide, "#s=ramp_and_pins&mu=0.42");
    if (own) {
      await page.click("#tab-json");
      await page.fill("#text", (await page.inputValue("#text")).replace('"gravity": { "x": 0', '"gravity": { "x": 0.5'));
      await page.click("#run");
      await page.waitForFunction(() => play.state.name === null);
    }
    await page.click("#share");
    await page.waitForFunction(() => document.getElementById("sharing").open);
    const link = await page.inputValue("#link");
    assert.ok(link.length < 8200 && link.includes(own ? "#z=" : "#s=ramp_and_pins"), link.slice(0, 200));
    const other = await open(wide, link.slice(link.indexOf("#")));
    assert.equal(await hashOf(other), await hashOf(page));
    await close(other);
    await close(page);
  }
}

async function longLinks() {
  const page = await open(wide, "#s=ramp_and_pins");
  await page.click("#tab-json");
  // what no compression shortens: 20480 hexadecimal digits, whose link would have 13700 characters
  const noise = Array.from({ length: 320 }, (_, i) => createHash("sha256").update(String(i)).digest("hex")).join("");
  const text = (await page.inputValue("#text")).replace('"about": "', `"about": "${noise}`);
  assert.ok(text.includes(noise));
  await page.fill("#text", text);
  await page.click("#run");
  await page.waitForFunction(() => play.state.name === null);
  const before = page.url();
  await page.click("#share");
  await page.waitForFunction(() => document.getElementById("sharing").open);
  assert.match(await page.textContent("#sharing-note"), /too long for a link.*file/);
  assert.equal(await page.isVisible("#link"), false);
  assert.equal(await page.isVisible("#copy"), false);
  assert.equal(page.url(), before);
  const offered = page.waitForEvent("download");
  await page.click("#save");
  const file = await offered;
  assert.equal(file.suggestedFilename(), "scene.json");
  assert.equal(fs.readFileSync(await file.path(), "utf8"), text);
  await page.click("#close");
  await close(page);
}

async function pauseStepSlow() {
  const page = await open(wide, "#s=ramp_and_pins");
  const pressed = (id) => page.getAttribute(`#${id}`, "aria-pressed");
  const frame = 1 / 60;
  const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);
  await page.click("#pause");
  assert.equal(await pressed("pause"), "true");
  assert.equal(await page.textContent("#pause"), "Play");
  await drawn(page); // what was on its way
  const stopped = await timeOf(page);
  await drawn(page, 5);
  near(await timeOf(page), stopped);
  for (let steps = 1; steps <= 3; ++steps) {
    await page.click("#step");
    await drawn(page);
    near(await timeOf(page), stopped + steps * frame);
  }
  await page.click("#slow");
  assert.equal(await pressed("slow"), "true");
  await page.click("#pause");
  assert.equal(await page.textContent("#pause"), "Pause");
  const times = await page.evaluate(() => new Promise((resolve) => {
    const seen = [];
    play.onFrame = (f) => {
      seen.push(f.time);
      if (seen.length === 12) {
        play.onFrame = null;
        resolve(seen);
      }
    };
  }));
  for (let i = 3; i < times.length; ++i) {
    const passed = times[i] - times[i - 1];
    assert.ok(passed > 0 && passed < 0.2 * frame, `${passed} s in a picture of slow motion`);
  }
  assert.match(await page.textContent("#times"), /in slow motion/);
  await page.click("#slow");
  await page.click("#step"); // a step of what runs pauses it
  assert.equal(await pressed("pause"), "true");
  await drawn(page);
  const after = await timeOf(page);
  await drawn(page, 5);
  near(await timeOf(page), after);
  await close(page);
}

async function narrowPage() {
  const page = await open(narrow);
  for (const tab of ["feel", "scenes", "json", "recording"]) {
    await page.tap(`#tab-${tab}`);
    await page.waitForTimeout(200);
    await show(page, `narrow_${tab}`);
    const faults = await page.evaluate(() => {
      const found = [], seen = [];
      if (document.documentElement.scrollWidth > innerWidth)
        found.push(`scrolls sideways: ${document.documentElement.scrollWidth} px`);
      for (const e of document.querySelectorAll("button, input, select, a, textarea, canvas[tabindex]")) {
        const b = e.getBoundingClientRect();
        if (b.width === 0 || e.closest("dialog:not([open])") || e.closest("label, p") && e.tagName === "A")
          continue;
        if (b.width < 43.5 || b.height < 43.5)
          found.push(`${e.id || e.textContent} is ${b.width.toFixed(0)} x ${b.height.toFixed(0)} px`);
        for (const [other, o] of seen)
          if (b.left < o.right - 1 && o.left < b.right - 1 && b.top < o.bottom - 1 && o.top < b.bottom - 1)
            found.push(`${e.id || e.textContent} overlaps ${other.id || other.textContent}`);
        seen.push([e, b]);
      }
      return found;
    });
    assert.deepEqual(faults, [], tab);
    await accessible(page, `narrow ${tab}`);
  }
  // A finger grabs: the press follows it.
  await page.tap("#tab-feel");
  const touch = await page.context().newCDPSession(page);
  await page.evaluate(() => play.load({ name: "snap" }));
  await page.waitForFunction(() => play.state.frame?.mode === "hand");
  const at = await page.evaluate(() => { const b = document.getElementById("world").getBoundingClientRect(), h = play.handle(); return [b.left + h[0], b.top + h[1]]; });
  const points = (y) => [{ x: at[0], y: at[1] + y }];
  await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: points(0) });
  for (let y = 10; y <= 60; y += 10)
    await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: points(y) });
  await page.waitForFunction(() => play.state.frame?.travel > 0.3, null, { timeout: patience });
  await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await close(page);
}

async function accessible(page, what) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => axe.run());
  assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.html).join(" | ")}`), [], what);
}

async function keyboard() {
  const page = await open(wide, "#s=snap&speed=1");
  await accessible(page, "wide");
  const focused = () => page.evaluate(() => document.activeElement.id);
  const reach = async (id) => {
    for (let i = 0; i < 60 && (await focused()) !== id; ++i)
      await page.keyboard.press("Tab");
    assert.equal(await focused(), id);
  };
  await reach("pad");
  const before = await page.evaluate(() => play.state.parameters.phi_bar ?? play.state.numbers.phi_bar);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((b) => play.state.numbers.phi_bar > b && play.state.frame?.time < 1, before);
  await page.keyboard.down(" ");
  await page.waitForFunction(() => play.state.frame?.travel > 0.2);
  await page.keyboard.up(" ");
  await reach("share");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.getElementById("sharing").open);
  assert.ok((await page.inputValue("#link")).includes("phi_bar="));
  await page.keyboard.press("Escape");
  await close(page);
}

async function reducedMotion() {
  const page = await open({ ...wide, reducedMotion: "reduce" }, "#s=snap&phi_bar=0.85&mu=0.42&speed=1");
  await page.evaluate(() => {
    globalThis.glows = 0;
    const count = (drawn) => { for (let i = 0; i < drawn.length; i += 2) globalThis.glows += drawn[i] === 4; };
    play.onFrame = (frame) => count(frame.list.operations);
  });
  await page.click("#press");
  await page.waitForFunction(() => document.getElementById("live").textContent.startsWith("Snap, "), null, { timeout: patience });
  await page.waitForTimeout(500);
  assert.equal(await page.evaluate(() => globalThis.glows), 0);
  await close(page);
}

const parts = { selfPlay, phaseDiagram, everyScene, pauseStepSlow, wrongText, hanging, recordings, links, longLinks, narrowPage, keyboard, reducedMotion };
const wanted = process.env.PARTS ? process.env.PARTS.split(",") : Object.keys(parts);
let failed = 0;
for (const name of wanted) {
  try {
    await parts[name]();
    console.log(`${name}: passed`);
  } catch (error) {
    ++failed;
    console.log(`${name}: ${error.stack}`);
  }
}
await browser.close();
process.exit(failed ? 1 : 0);
