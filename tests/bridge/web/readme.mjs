// The program of the package's README, from the packed package in an empty folder: in Node, and as a classic script in a
// page opened from a file, with the module inside. Both print the same.

import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium, report } from "./browser.mjs";
import { folder, source } from "./package.mjs";

const { files, version } = JSON.parse(readFileSync(`${folder}/package.json`));
const tarball = join(folder, "..", `supercircle-${version}.tgz`);
if (!existsSync(tarball)) {
  assert.notEqual(spawnSync("npm", ["--version"]).status, 0, `npm is there, but not ${tarball}`);
  console.log("skipped: npm is missing, so there is no packed package; bridge/web/build.sh installs it");
  process.exit(77);
}

/** Installs the packed package into an empty folder, by npm without a network, else as npm unpacks it. */
function installed(work) {
  const packed = join(work, "node_modules/supercircle");
  const npm = spawnSync("npm", ["install", "--offline", "--no-audit", "--no-fund", "--cache", join(work, "cache"), "--prefix", work, tarball],
    { cwd: work, encoding: "utf8" });
  if (npm.status !== 0) {
    console.log(`tar unpacks it, npm does not: ${npm.error?.message ?? npm.stderr.trim().split("\n")[0]}`);
    rmSync(packed, { recursive: true, force: true });
    mkdirSync(packed, { recursive: true });
    execFileSync("tar", ["-xzf", tarball, "-C", packed, "--strip-components=1"]);
  }
  return packed;
}

const work = mkdtempSync(join(tmpdir(), "supercircle-readme-"));
try {
  const packed = installed(work);
  for (const file of [...files, "package.json", "README.md"])
    assert.ok(readFileSync(join(packed, file)).equals(readFileSync(join(folder, file))), `${file} of ${tarball} is not that of ${folder}`);
  const program = readFileSync(join(packed, "README.md"), "utf8").match(/```js\n([^]*?)```/)[1];
  assert.ok(program.trim().split("\n").length <= 12, "about ten lines");
  for (const page of ["how-to/from_javascript.md", "reference/javascript.md"])
    assert.ok(readFileSync(`${source}/docs/${page}`, "utf8").includes(program), `${page} has the same program`);
  writeFileSync(join(work, "program.mjs"), program);
  const printed = execFileSync(process.execPath, ["program.mjs"], { cwd: work, encoding: "utf8" }).trim().split("\n");
  // it hangs on its ends: R (1 - cos(135 deg)) = 32.8 mm is the height of the shell, its centre of mass lies lower
  const height = Number(printed[0].match(/([\d.]+) mm/)[1]);
  assert.ok(height > 0 && height < 32.8, printed[0]);

  if (chromium() === null) {
    console.log("skipped: chromium is missing, the page was not opened; bridge/web/build.sh installs it");
    process.exitCode = 77;
  } else {
    const bytes = readFileSync(join(packed, "supercircle.wasm")).toString("base64");
    const body = program.replace(/^import .*\n/m, "").replace("await load()", "await supercircle.load(Uint8Array.from(atob(MODULE), (c) => c.charCodeAt(0)))");
    const page = (port) => {
      writeFileSync(join(work, "page.html"), `<!doctype html><meta charset="utf-8"><script>${readFileSync(join(packed, "supercircle.js"), "utf8")}</script><script>
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
