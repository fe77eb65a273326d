// The worker's side of the page: one message out, one answer back, and a watchdog that can stop a scene that hangs.

class Engine {
  constructor(code, bytes, onAnswer) {
    this.code = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    this.bytes = bytes;
    this.onAnswer = onAnswer;
    this.next = 1;
    this.waiting = new Map();
    this.start();
  }

  start() {
    this.worker = new Worker(this.code);
    this.worker.onmessage = (event) => this.hear(event.data);
    this.worker.onerror = (event) => this.onAnswer({ kind: "failed", of: "worker", message: event.message });
    this.busySince = null;
    this.worker.postMessage({ kind: "start", bytes: this.bytes });
  }

  hear(answer) {
    if (answer.kind === "frame" || answer.of === "tick")
      this.busySince = null;
    const waiting = this.waiting.get(answer.id);
    this.waiting.delete(answer.id);
    if (waiting)
      waiting(answer);
    this.onAnswer(answer);
  }

  ask(message) {
    const id = this.next++;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.worker.postMessage({ ...message, id });
    });
  }

  /** Sends a frame's order; the next one waits for its answer. */
  tick(order) {
    this.busySince = performance.now();
    this.worker.postMessage({ kind: "tick", ...order });
  }

  /** Seconds since an unanswered order; 0: none. */
  lateness() {
    return this.busySince === null ? 0 : Math.max(1e-6, (performance.now() - this.busySince) / 1000);
  }

  /** Ends what hangs; the page loads something else then. */
  stop() {
    this.worker.terminate();
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const resolve of waiting)
      resolve({ ok: false, message: "the scene was stopped" });
    this.start();
  }
}

/** The bytes behind base64 of a deflated file. */
async function inflate(base64) {
  const deflated = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function deflate(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
