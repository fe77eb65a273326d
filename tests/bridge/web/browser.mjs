// Runs a page in a headless Chromium and waits for what it reports.

import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";

/** The command of the browser, or null. */
export function chromium() {
  return ["chromium", "chromium-browser", "google-chrome"].find((name) => spawnSync(name, ["--version"]).status === 0) ?? null;
}

/** Serves `files` (path: [type, content]), opens `page` of them (or a URL), and gives what it posts to /report. */
export async function report(files, page, seconds = 300) {
  let done;
  const reported = new Promise((resolve) => (done = resolve));
  const server = createServer((request, answer) => {
    if (request.method === "POST") {
      let text = "";
      request.on("data", (part) => (text += part));
      request.on("end", () => (answer.end(), done(JSON.parse(text))));
      return;
    }
    const file = files[request.url.slice(1)];
    answer.writeHead(file ? 200 : 404, { "content-type": file?.[0] ?? "text/plain" });
    answer.end(file?.[1] ?? "");
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address();
  const profile = mkdtempSync(join(tmpdir(), "chromium-"));
  const url = typeof page === "function" ? page(port) : `http://127.0.0.1:${port}/${page}`;
  const browser = spawn(chromium(), ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", `--user-data-dir=${profile}`, url],
    { stdio: "ignore" });
  const timer = setTimeout(() => done({ error: `the page reported nothing within ${seconds} s` }), 1000 * seconds);
  const result = await reported;
  clearTimeout(timer);
  const ended = new Promise((resolve) => browser.on("exit", resolve));
  browser.kill();
  await ended;
  server.close();
  server.closeAllConnections?.();
  try {
    rmSync(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 200 });
  } catch { /* its last processes still write there; the folder is a temporary one */ }
  return result;
}
