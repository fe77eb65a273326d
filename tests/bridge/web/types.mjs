// types.mjs FOLDER: TypeScript accepts the declarations and a program that uses them. The compiler is installed into
// FOLDER, in the version of package-lock.json.

import { spawnSync } from "node:child_process";
import { copyFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { install } from "./installed.mjs";
import { folder } from "./package.mjs";

const here = (name) => new URL(name, import.meta.url).pathname;
const work = process.argv[2];
install(work);
copyFileSync(here("usage.ts"), join(work, "usage.ts"));
const compiler = join(work, "node_modules/typescript/bin/tsc");
rmSync(join(work, "node_modules/supercircle"), { recursive: true, force: true });
symlinkSync(folder, join(work, "node_modules/supercircle"));
const compilerOptions = { strict: true, noEmit: true, target: "es2022", module: "nodenext", moduleResolution: "nodenext", lib: ["es2022", "dom"], types: [], skipLibCheck: false };
writeFileSync(join(work, "tsconfig.json"), JSON.stringify({ compilerOptions, files: ["usage.ts"] }));
const result = spawnSync(process.execPath, [compiler, "-p", work], { encoding: "utf8" });
console.log(result.stdout);
process.exit(result.status ?? 1);
