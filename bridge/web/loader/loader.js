// Compiles supercircle.wasm in Node, pages and workers, and moves texts and bytes across its border. Emscripten's own
// loader is not used: the module is standalone and asks for a few calls of WASI only.

const ERRNO_NOSYS = 52;
const encoder = new TextEncoder();
const decoder = new TextDecoder();
const KINDS = ["", "bad_input", "stale", "busy", "refused", "failed", "out_of_memory", "wrong_version"];

/** A refused call; it has changed nothing. `kind` says why in one word, `message` in a sentence. */
export class SupercircleError extends Error {
  constructor(status, message, result) {
    super(message);
    this.name = "SupercircleError";
    this.status = status;
    this.kind = KINDS[status] ?? "failed";
    this.result = result; // of a failed step: its Frame
  }
}

/** A refusal by the package itself. */
export function badInput(message) {
  return new SupercircleError(CONSTANTS.SC_BAD_INPUT, message);
}

/** The bytes of a module beside this one. */
async function bytesOf(url) {
  if (url.protocol === "file:" && typeof process === "object")
    return (await import("node:fs/promises")).readFile(url);
  const answer = await fetch(url);
  if (!answer.ok) throw badInput(`cannot load ${url}: ${answer.status} ${answer.statusText}`);
  return answer.arrayBuffer();
}

/** An instance of the module: its exports, a scratch memory for arguments, and errors. */
export class Core {
  /** Pages may not wait for an instance of this size, so it comes as a promise. */
  static async make(module, own = {}) {
    const core = new Core();
    core.exports = (await WebAssembly.instantiate(module, core.imports(module, own))).exports;
    core.start();
    return core;
  }

  start() {
    this.log = "";
    this.views();
    this.exports._initialize();
    const version = this.exports.sc_api_version();
    if (version !== CONSTANTS.SC_API_VERSION)
      throw new SupercircleError(CONSTANTS.SC_WRONG_VERSION, `the module has version ${version} of the interface, this package knows ${CONSTANTS.SC_API_VERSION}: take both from one package`);
    this.room = 65536;
    this.scratch = this.exports.sc_alloc(this.room);
    this.extra = [];
    this.used = 0;
  }

  /** What the module asks for: clock, randomness, messages. The rest answers "not supported". */
  imports(module, own) {
    const known = {
      ...own,
      emscripten_notify_memory_growth: () => this.views(),
      clock_time_get: (id, precision, out) => {
        this.data.setBigUint64(out, BigInt(Math.round(1e6 * performance.now())), true);
        return 0;
      },
      fd_write: (file, pieces, count, out) => this.write(pieces, count, out),
      proc_exit: (code) => {
        throw new Error(`supercircle.wasm ended with code ${code}. ${this.log}`);
      },
    };
    const imports = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module))
      (imports[from] ??= {})[name] = known[name] ?? (() => ERRNO_NOSYS);
    return imports;
  }

  /** Messages of the C library before it gives up. */
  write(pieces, count, out) {
    let written = 0;
    for (let i = 0; i < count; ++i) {
      const at = this.data.getUint32(pieces + 8 * i, true);
      const bytes = this.data.getUint32(pieces + 8 * i + 4, true);
      this.log = (this.log + decoder.decode(this.bytes.subarray(at, at + bytes))).slice(-2000);
      written += bytes;
    }
    this.data.setUint32(out, written, true);
    return 0;
  }

  /** The memory moves when it grows. */
  views() {
    const buffer = this.exports.memory.buffer;
    this.data = new DataView(buffer);
    this.bytes = new Uint8Array(buffer);
  }

  /** Begins a call: the scratch memory is free again. */
  begin() {
    for (const block of this.extra) this.exports.sc_free(block);
    this.extra.length = 0;
    this.used = 0;
  }

  /** Memory until the next call begins, aligned to 8 bytes. */
  take(bytes) {
    const at = this.scratch + this.used;
    if (this.used + bytes <= this.room) {
      this.used += (bytes + 7) & ~7;
      return at;
    }
    const block = bytes < 0x7fffffff ? this.exports.sc_alloc(bytes) : 0;
    if (block === 0) throw new SupercircleError(CONSTANTS.SC_NO_MEMORY, "out of memory");
    this.extra.push(block);
    return block;
  }

  /** Address and length of a text as UTF-8 with a zero after it. */
  putText(text) {
    const bytes = encoder.encode(text);
    const at = this.take(bytes.length + 1);
    this.bytes.set(bytes, at);
    this.bytes[at + bytes.length] = 0;
    return [at, bytes.length];
  }

  /** The text at an address, up to its zero or of so many bytes. */
  text(at, length) {
    return decoder.decode(this.bytes.subarray(at, length === undefined ? this.bytes.indexOf(0, at) : at + length));
  }

  /** The error of the call that was just refused. */
  error(status = this.exports.sc_error_status(), result = undefined) {
    return new SupercircleError(status, this.text(this.exports.sc_error()) || "the call was refused", result);
  }
}

/** Compiles the module: of bytes, a WebAssembly.Module, a Response, or (null) the file beside the package. */
export async function compile(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source === null) {
    if (BESIDE === null) throw badInput("the classic script needs the bytes of the module");
    source = BESIDE;
  }
  if (source instanceof URL) source = await bytesOf(source);
  if (typeof Response === "function" && source instanceof Response) source = await source.arrayBuffer();
  return WebAssembly.compile(source);
}
