// check_canvas.js: whether plugin/graphics/picture/canvas.js reads each operation as docs/reference/picture.md has it.
// A context that writes down its calls takes the place of a canvas.
"use strict";
const assert = require("assert");
const path = require("path");
const drawPicture = require(path.join(__dirname, "../../../plugin/graphics/picture/canvas.js"));

function recorder() {
  const calls = [];
  return new Proxy({ calls }, {
    get: (target, name) => name in target ? target[name] : (...args) => {
      calls.push([name, ...args]);
      return { addColorStop: (t, colour) => calls.push(["addColorStop", t, colour]) };
    },
    set: (target, name, value) => {
      calls.push([name + "=", value]);
      return true;
    }
  });
}

function play(operations, numbers, texts) {
  const context = recorder();
  drawPicture(context, new Int32Array(operations), new Float32Array(numbers), texts);
  const saves = context.calls.filter((c) => c[0] === "save").length;
  assert.strictEqual(saves, context.calls.filter((c) => c[0] === "restore").length, "the state is restored");
  return context.calls;
}
const only = (calls, ...names) => calls.filter((c) => names.includes(c[0]));

// A polygon.
let calls = play([1, 8], [0x102030, 0.5, 0, 0, 10, 0, 10, 5], "");
assert.deepStrictEqual(only(calls, "globalAlpha=", "fillStyle=", "lineTo", "fill"),
  [["globalAlpha=", 0.5], ["fillStyle=", "#102030"], ["lineTo", 0, 0], ["lineTo", 10, 0], ["lineTo", 10, 5], ["fill"]]);

// A band: two pieces of one colour are one stroke, the third has another one.
const red = 0xff0000, green = 0x00ff00;
calls = play([2, 18], [1, 0, 0, 0, 2, red, 10, 0, 2, red, 20, 0, 2, green, 30, 0, 2, green], "");
assert.deepStrictEqual(only(calls, "moveTo", "lineTo", "strokeStyle=", "lineWidth=", "stroke"),
  [["moveTo", 0, 0], ["lineTo", 10, 0], ["lineTo", 20, 0], ["strokeStyle=", "#ff0000"], ["lineWidth=", 4], ["stroke"],
    ["moveTo", 20, 0], ["lineTo", 30, 0], ["strokeStyle=", "#00ff00"], ["lineWidth=", 4], ["stroke"]]);

// A closed one of one colour is a closed path, with round joints where it is sharp.
calls = play([2, 14], [0.25, 1, 0, 0, 2, red, 10, 0, 2, red, 5, 8, 2, red], "");
assert.deepStrictEqual(only(calls, "closePath", "globalAlpha="), [["globalAlpha=", 0.25], ["closePath"]]);
assert.strictEqual(only(calls, "lineTo").length, 3);
assert.deepStrictEqual(only(calls, "lineJoin=").pop(), ["lineJoin=", "round"]);

// A piece whose width changes is the hull of two discs.
calls = play([2, 10], [1, 0, 0, 0, 3, red, 10, 0, 3, red], "");
assert.strictEqual(only(calls, "stroke").length, 1);
calls = play([2, 10], [1, 0, 0, 0, 3, red, 10, 0, 1, red], "");
assert.deepStrictEqual(only(calls, "arc").map((c) => c.slice(1, 4)), [[0, 0, 3], [10, 0, 1]]);
assert.strictEqual(only(calls, "fill").length, 1);

// Disc, glow, text with an angle, text without, clip; an unknown operation is skipped.
calls = play([3, 5, 99, 2, 4, 5, 5, 8, 5, 8, 6, 4],
  [1, 2, 3, red, 0.5, 7, 7, 10, 20, 5, 0x010203, 0.75,
    7, 8, 12, red, 1, 1, 1, 90, 9, 9, 13, green, 1, 0, 0, 0, 1, 2, 30, 40],
  new TextEncoder().encode("2.3 \u00b5J\0second\0"));
assert.deepStrictEqual(only(calls, "arc"), [["arc", 1, 2, 3, 0, 2 * Math.PI]]);
assert.deepStrictEqual(only(calls, "createRadialGradient"), [["createRadialGradient", 10, 20, 0, 10, 20, 5]]);
const stops = only(calls, "addColorStop");
assert.deepStrictEqual([stops[0], stops[stops.length - 1]], [["addColorStop", 0, "#010203ff"], ["addColorStop", 1, "#01020300"]]);
assert.deepStrictEqual(only(calls, "fillText"), [["fillText", "2.3 \u00b5J", 0, 0], ["fillText", "second", 9, 9]]);
assert.deepStrictEqual(only(calls, "font=", "textAlign="),
  [["font=", "bold 12px sans-serif"], ["textAlign=", "center"], ["font=", "13px sans-serif"], ["textAlign=", "left"]]);
assert.deepStrictEqual(only(calls, "rect", "clip"), [["rect", 1, 2, 30, 40], ["clip"]]);
console.log("canvas.js draws every operation");
