// Where the built package is; tests that need it skip when the web build was skipped.

import { existsSync } from "node:fs";
import { pathToFileURL } from "node:url";

export const folder = process.env.SUPERCIRCLE_PACKAGE;
export const source = process.env.SUPERCIRCLE_SOURCE;
if (!existsSync(`${folder}/supercircle.mjs`)) {
  console.log(`skipped: there is no package in ${folder}; bridge/web/build.sh builds it`);
  process.exit(77);
}
export const { load, loadLab, SupercircleError } = await import(pathToFileURL(`${folder}/supercircle.mjs`));
