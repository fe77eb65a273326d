// The program of the package's README, from the packed package: in Node, and as a classic script in a page opened from a
// file, with the module inside. Both print the same.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium, report } from "./browser.mjs";
import { folder, source } from "./package.mjs";

const readme = readFileSync(`${folder}/README.md`, "utf8");
const program = readme.match(/```js\n([^]*?)```/)[1];
assert.ok(program.trim().split("\n").length <= 12, "about ten lines");
assert.ok(readFileSync(`${source}/docs/how-to/from_javascript.md`, "utf8").includes(program), "the how-to page has the same program");

const work = mkdtempSync(join(tmpdir(), "supercircle-readme-"));
try {
  // as npm installs it
  const packed = join(work, "node_modules/supercircle");
  mkdirSync(packed, { recursive: true });
  const { files } = JSON.parse(readFileSync(`${folder}/package.json`));
  for (const file of [...files, "package.json"]) writeFileSync(join(packed, file), readFileSync(`${folder}/${file}`));
  writeFileSync(join(work, "program.mjs"), program);
  const printed = execFileSync(process.execPath, ["program.mjs"], { cwd: work, encoding: "utf8" }).trim().split("\n");
  // it hangs on its ends: R (1 - cos(135 deg)) = 32.8 mm is the height of the shell, its centre of mass lies lower
  const height = Number(printed[0].match(/([\d.]+) mm/)[1]);
  assert.ok(height > 0 && height < 32.8, printed[0]);

  if (chromium() === null) {
    console.log("skipped: chromium is missing, the page was not opened; bridge/web/build.sh installs it");
    process.exitCode = 77;
  } else {
    const bytes = readFileSync(`${folder}/supercircle.wasm`).toString("base64");
    const body = program.replace(/^import .*\n/m, "").replace("await load()", "await supercircle.load(Uint8Array.from(atob(MODULE), (c) => c.charCodeAt(0)))");
    const page = (port) => {
      writeFileSync(join(work, "page.html"), `<!doctype html><meta charset="utf-8"><script>${readFileSync(`${folder}/supercircle.js`, "utf8")}</script><script>
const MODULE = "${bytes}", lines = [], console = { log: (line) => lines.push(line) };
(async () => { ${body} })().catch((e) => lines.push(String(e))).then(() =>
  fetch("http://127.0.0.1:${port}/report", { method: "POST", mode: "no-cors", body: JSON.stringify(lines) }));
</script>`);
      return pathToFileURL(join(work, "page.html")).href;
    };
    assert.deepEqual(await report({}, page), printed);
  }
} finally {
  rmSync(work, { recursive: true, force: true });
}
