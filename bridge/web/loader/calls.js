// Makes a function of each call of the C interface, after the tables that bridge/web/generate.py writes. Structs are
// objects, points are [x, y], handles are bigints or objects with an `id`, buffers and results come back.

import { badInput } from "./loader.js";

const ARRAYS = { double: Float64Array, float: Float32Array, int32_t: Int32Array, uint8_t: Uint8Array, sc_point: Float64Array };
const BYTES = { double: 8, float: 4, int32_t: 4, uint8_t: 1, uint64_t: 8 };
const layouts = {};
for (const [name, text] of Object.entries(STRUCTS)) {
  const [bytes, ...members] = text.split(" ");
  layouts[name] = {
    bytes: parseInt(bytes), sized: bytes.endsWith("+"),
    members: members.map((m) => m.split(":")).map(([key, kind, offset]) => ({ key, kind, offset: Number(offset) })),
  };
}

const bytesOfOne = (kind) => layouts[kind]?.bytes ?? BYTES[kind];
const isHandle = (kind) => layouts[kind]?.members[0].key === "id";

/** [x, y] of a point: an array of two numbers, or an object with x and y. */
export function pointOf(value) {
  const point = value?.length === 2 ? [Number(value[0]), Number(value[1])] : [Number(value?.x), Number(value?.y)];
  if (Number.isNaN(point[0]) || Number.isNaN(point[1]))
    throw badInput(`a point is [x, y] or {x, y} with two numbers, not ${show(value)}`);
  return point;
}

/** A value in a message. */
export function show(value) {
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** A handle, or a number of 64 bits. */
function wide(value) {
  if (value === null || value === undefined) return 0n;
  if (typeof value === "object" && typeof value.id === "bigint") return value.id;
  try {
    return BigInt.asUintN(64, BigInt(value));
  } catch {
    throw badInput(`expected a handle or a whole number, got ${show(value)}`);
  }
}

function number(value, name) {
  if (typeof value !== "number" && typeof value !== "boolean") throw badInput(`${name} is ${show(value)}, not a number`);
  return Number(value);
}

function integer(value, name, least = -0x80000000, most = 0x7fffffff) {
  const n = number(value, name);
  if (!Number.isInteger(n) || n < least || n > most) throw badInput(`${name} is ${n}, not a whole number from ${least} to ${most}`);
  return n;
}

/** Of 32 bits without a sign; a mask made with ~ is negative in JavaScript. */
const whole = (value, name) => integer(value, name, -0x80000000, 0xffffffff) >>> 0;

const writers = {
  d: (data, at, value, name) => data.setFloat64(at, number(value, name), true),
  i: (data, at, value, name) => data.setInt32(at, integer(value, name), true),
  w: (data, at, value, name) => data.setUint32(at, whole(value, name), true),
  f: (data, at, value) => data.setInt32(at, value ? 1 : 0, true),
  n: (data, at, value) => data.setBigUint64(at, wide(value), true),
  u: (data, at, value) => data.setBigUint64(at, wide(value), true),
  h: (data, at, value) => data.setBigUint64(at, wide(value), true),
  sc_point(data, at, value) {
    const [x, y] = pointOf(value);
    data.setFloat64(at, x, true);
    data.setFloat64(at + 8, y, true);
  },
};
const readers = {
  d: (data, at) => data.getFloat64(at, true),
  i: (data, at) => data.getInt32(at, true),
  w: (data, at) => data.getUint32(at, true),
  f: (data, at) => data.getInt32(at, true) !== 0,
  n: (data, at) => Number(data.getBigUint64(at, true)),
  u: (data, at) => data.getBigUint64(at, true),
  h: (data, at) => data.getBigUint64(at, true),
  uint64_t: (data, at) => data.getBigUint64(at, true),
  sc_point: (data, at) => [data.getFloat64(at, true), data.getFloat64(at + 8, true)],
};

/** What stands at an address: an object for a struct, a bigint for a handle. */
function read(data, kind, at) {
  if (readers[kind]) return readers[kind](data, at);
  if (isHandle(kind)) return data.getBigUint64(at, true);
  const out = {};
  for (const m of layouts[kind].members) out[m.key] = readers[m.kind](data, at + m.offset);
  return out;
}

/** Writes an object as a struct; members that it lacks are zero. */
function write(core, kind, value) {
  const { bytes, sized, members } = layouts[kind];
  const at = core.take(bytes);
  core.bytes.fill(0, at, at + bytes);
  if (sized) core.data.setInt32(at, bytes, true);
  const known = new Map(members.map((m) => [m.key, m]));
  for (const [key, given] of Object.entries(value)) {
    const m = known.get(key);
    if (m === undefined) throw badInput(`there is no ${key}; known are ${[...known.keys()].join(", ")}`);
    writers[m.kind](core.data, at + m.offset, given, key);
  }
  return at;
}

/** Address and length of numbers, bytes or points; one number stands for an array with it. */
function putArray(core, kind, value, name) {
  if (value === null || value === undefined) return [0, 0];
  const flat = kind === "sc_point" && Array.isArray(value) ? value.flatMap(pointOf) : value;
  const items = new ARRAYS[kind](typeof flat === "number" ? [flat] : flat);
  if (kind === "double" && items.some(Number.isNaN)) throw badInput(`${name} has a value that is not a number`);
  const at = core.take(items.byteLength);
  core.bytes.set(new Uint8Array(items.buffer, items.byteOffset, items.byteLength), at);
  return [at, kind === "sc_point" ? items.length >> 1 : items.length];
}

/** A copy of an array in the module's memory. */
function copyArray(core, kind, at, count) {
  if (ARRAYS[kind]) {
    const bytes = core.bytes.slice(at, at + count * bytesOfOne(kind));
    return new ARRAYS[kind](bytes.buffer);
  }
  return Array.from({ length: count }, (_, i) => read(core.data, kind, at + i * bytesOfOne(kind)));
}

// Arguments that are given: each appends what the module takes.
const putters = {
  d: (core, out, value, p) => out.push(number(value, p.name)),
  i: (core, out, value, p) => out.push(integer(value, p.name)),
  w: (core, out, value, p) => out.push(whole(value, p.name)),
  u: (core, out, value) => out.push(wide(value)),
  t(core, out, value, p) {
    if (value === null || value === undefined) return out.push(0);
    if (String(value).includes("\0")) throw badInput(`${p.name} has a zero character`);
    return out.push(core.putText(String(value))[0]);
  },
  T: (core, out, value) => out.push(...core.putText(String(value))),
  "]": (core, out, value, p) => out.push(...putArray(core, p.type, value, p.name)),
  "<": (core, out, value, p) => out.push(value === null || value === undefined ? 0 : write(core, p.type, value)),
  "=": (core, out, value, p) => out.push((p.at = write(core, p.type, value))),
  p(core, out, value) {
    const at = core.take(16);
    writers.sc_point(core.data, at, value);
    out.push(at);
  },
};

/** What the outputs of a call hold: one value, or an object of several by name. */
function results(core, outputs, count) {
  const value = (p) => (p.letter === "[" ? copyArray(core, p.type, p.at, count) : read(core.data, p.type, p.at));
  if (outputs.length === 1) return value(outputs[0]);
  return Object.fromEntries(outputs.map((p) => [p.name, value(p)]));
}

/** The JavaScript function of one call. */
function makeCall(core, name, text) {
  const [returns, ...rest] = text.split(" ");
  const parameters = rest.map((t) => t.split(":")).map(([key, kind]) => ({ name: key, letter: kind[0], type: kind.slice(1), at: 0, room: 0 }));
  const outputs = parameters.filter((p) => "[>=".includes(p.letter));
  const buffer = parameters.find((p) => p.letter === "[");
  const counter = parameters.find((p) => p.letter === "c");

  function once(given) {
    core.begin();
    const out = [];
    let next = 0;
    for (const p of parameters) {
      if (p.letter === "[") out.push((p.at = core.take(p.room * bytesOfOne(p.type))), p.room);
      else if (p.letter === ">" || p.letter === "c") out.push((p.at = core.take(bytesOfOne(p.type) ?? 4)));
      else putters[p.letter](core, out, given[next++], p);
    }
    return core.exports[name](...out);
  }

  return (...given) => {
    if (buffer) buffer.room ||= Math.floor(8192 / bytesOfOne(buffer.type));
    let answer = once(given);
    if (buffer && answer > buffer.room) {
      buffer.room = answer;
      answer = once(given);
    }
    if (returns === "s" && answer !== 0)
      throw core.error(answer, answer === CONSTANTS.SC_FAILED && outputs.length ? results(core, outputs, 0) : undefined);
    if (returns === "s" || returns === "v") return outputs.length ? results(core, outputs, 0) : undefined;
    if (returns === "n" || returns === "i") {
      if (answer < 0) throw core.error(-answer);
      return outputs.length ? results(core, outputs, answer) : answer;
    }
    if (returns === "u") answer = BigInt.asUintN(64, answer);
    if ((!answer || Number.isNaN(answer)) && core.exports.sc_error_status() !== 0) throw core.error();
    if (returns === "t") return core.text(answer);
    if (returns === "b") return core.text(answer, core.data.getInt32(counter.at, true));
    if (returns[0] === "*") return copyArray(core, returns.slice(1), answer, core.data.getInt32(counter.at, true));
    return answer;
  };
}

/** All calls of the interface by name. */
export function makeCalls(core) {
  const calls = {};
  for (const [name, text] of Object.entries(CALLS)) calls[name] = makeCall(core, name, text);
  calls.sc_error = () => core.text(core.exports.sc_error()); // not a refusal of its own
  return calls;
}
