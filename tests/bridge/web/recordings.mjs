// recordings.mjs: the second module imports, replays and diagnoses the shipped example as the native library does, to the
// bit; it is stopped, and it refuses with a sentence.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { SupercircleError, loadLab, source } from "./package.mjs";

const told = [];
let going = true;
const lab = await loadLab(null, (fraction, stage) => (told.push([fraction, stage]), going));
const bytes = readFileSync(`${source}/examples/import/shell_on_cylinder.csv`); // no UTF-8
const specimen = readFileSync(`${source}/examples/import/specimen.json`, "utf8");
const request = { files: ["machine.csv"], specimen: "specimen.json", content: { "machine.csv": bytes, "specimen.json": specimen } };
const imported = lab.import(request);
assert.match(imported.account, /Windows-1252/);
assert.deepEqual(imported.missing, []);
assert.ok(request.content["machine.csv"] === bytes); // the caller's request is as it was
const replayed = lab.replay({ file: "experiment.json", content: imported.files });
assert.equal(replayed.status, "done");
assert.ok(told.length > 0 && told.every(([fraction, stage]) => fraction >= 0 && fraction <= 1 && stage !== ""));
assert.ok(replayed.replay.runs[0].rmse_about_mean_N < 0.01 * replayed.replay.runs[0].peak_recorded_N);

assert.throws(() => lab.replay({ file: "elsewhere.json" }), (e) => e instanceof SupercircleError && e.message.includes("elsewhere.json"));
assert.throws(() => lab.replay({ file: "experiment.json", content: imported.files, effects: ["plasticty:My_over_B_1_m=3"] }), /plasticity/);
going = false;
assert.equal(lab.diagnose({ file: "experiment.json", content: imported.files }).status, "cancelled");
going = true;
assert.deepEqual(lab.replay({ file: "experiment.json", content: imported.files }).curves, replayed.curves);

// Two candidates of all, so that a diagnosis takes seconds.
const catalogue = [...readFileSync(`${source}/docs/reference/effects.md`, "utf8").matchAll(/^\| \[(\w+)\]\(#\1\)/gm)].map((m) => m[1]);
const few = { file: "experiment.json", content: imported.files, next_experiment: false, jobs: 1,
  without: catalogue.filter((label) => label !== "machine_compliance" && label !== "sensor_gain") };
const { diagnosis } = lab.diagnose(few);
assert.ok(diagnosis.forward_runs > 10);

const native = spawnSync("/usr/bin/python3", ["-c", `
import json, sys
try:
    from supercircle import lab
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
replay, diagnose = json.load(sys.stdin)
print(json.dumps([lab._ask("sc_lab_replay", replay, None)["curves"], lab._ask("sc_lab_diagnose", diagnose, None)["diagnosis"]]))
`], { input: JSON.stringify([{ file: "experiment.json", content: imported.files }, few]), encoding: "utf8" });
if (native.status === 77) {
  console.log(native.stdout.trim());
  process.exit(77);
}
assert.equal(native.status, 0, native.stderr);
const [curves, found] = JSON.parse(native.stdout);
assert.deepEqual(curves, replayed.curves);
assert.deepEqual({ ...found, timing: null }, { ...diagnosis, timing: null });
console.log(`${replayed.curves[0].simulated.length} readings and a diagnosis, native equal`);
