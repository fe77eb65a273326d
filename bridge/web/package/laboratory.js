// What loadLab() gives: recordings on an instance of the second module, supercircle_lab.wasm.

import { Core, compile } from "../loader/loader.js";

/** Bytes as base64. */
function base64(bytes) {
  let text = "";
  for (let at = 0; at < bytes.length; at += 8192)
    text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  return btoa(text);
}

/** The laboratory: its calls block until they are done, so a page makes them in a worker. */
export async function loadLab(source = null, progress = null) {
  if (source === null && BESIDE !== null) source = new URL("./supercircle_lab.wasm", BESIDE);
  const core = await Core.make(await compile(await source), {
    progress: (fraction, stage) => (progress?.(fraction, core.text(stage)) === false ? 1 : 0),
  });
  function ask(name, { content = {}, ...request }) {
    content = Object.fromEntries(Object.entries(content).map(([path, value]) => [path, typeof value === "string" ? value : { base64: base64(value) }]));
    core.begin();
    const call = core.putText(name)[0];
    const answer = core.exports.sc_page_lab(call, core.putText(JSON.stringify({ ...request, content }))[0]);
    if (answer === 0) throw core.error();
    return JSON.parse(core.text(answer));
  }
  return {
    import: (request) => ask("import", request),
    replay: (request) => ask("replay", request),
    diagnose: (request) => ask("diagnose", { jobs: 1, ...request }),
  };
}
