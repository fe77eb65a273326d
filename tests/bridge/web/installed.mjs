// The packages of npm that the tests use, in the versions of package-lock.json.

import { spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";

const here = (name) => new URL(name, import.meta.url).pathname;
const NAMES = ["typescript", "playwright-core", "axe-core"];

/** Installs them into a folder; exit code 77 where npm cannot. */
export function install(work) {
  mkdirSync(work, { recursive: true });
  for (const file of ["package.json", "package-lock.json", ".npmrc"]) copyFileSync(here(file), join(work, file));
  if (NAMES.every((name) => existsSync(join(work, "node_modules", name)))) return;
  const npm = spawnSync("npm", ["ci", "--no-audit", "--no-fund"], { cwd: work, encoding: "utf8" });
  if (npm.status !== 0) {
    console.log(`skipped: npm cannot install ${NAMES.join(", ")}: ${npm.error?.message ?? npm.stderr.trim().split("\n")[0]}`);
    process.exit(77);
  }
}
