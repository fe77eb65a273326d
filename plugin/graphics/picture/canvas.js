// Draws a list of operations (docs/reference/picture.md) into a CanvasRenderingContext2D. A classic script without
// dependencies: drawPicture(context, operations, numbers, texts).
//
//   context     of a canvas; one unit of its transform is one pixel of the list
//   operations  Int32Array: code and count of numbers of each operation (sc_picture_operations)
//   numbers     Float32Array (sc_picture_numbers)
//   texts       Uint8Array of UTF-8, or a string; each text ends with a zero (sc_picture_texts)
//
// Arrays of WebAssembly's memory are read before the function returns and need no copy. The context's state is restored.
"use strict";

var drawPicture = (function () {
  const POLYGON = 1, BAND = 2, DISC = 3, GLOW = 4, TEXT = 5, CLIP = 6;
  const colours = new Map();
  const decoder = typeof TextDecoder === "undefined" ? null : new TextDecoder();
  const GLOW_STOPS = 8;

  function css(packed) {
    let text = colours.get(packed);
    if (text === undefined) {
      text = "#" + (0x1000000 + packed).toString(16).slice(1);
      colours.set(packed, text);
    }
    return text;
  }

  function polygon(c, n, at, count) {
    c.globalAlpha = n[at + 1];
    c.fillStyle = css(n[at]);
    c.beginPath();
    for (let i = at + 2; i < at + count; i += 2)
      c.lineTo(n[i], n[i + 1]);
    c.fill();
  }

  // A piece whose width changes: the hull of the discs at its ends.
  function taper(c, n, a, b) {
    const dx = n[b] - n[a], dy = n[b + 1] - n[a + 1], length = Math.hypot(dx, dy), p = n[a + 2], q = n[b + 2];
    c.beginPath();
    if (length <= Math.abs(p - q)) {
      const larger = p > q ? a : b;
      c.arc(n[larger], n[larger + 1], n[larger + 2], 0, 2 * Math.PI);
    } else {
      const along = Math.atan2(dy, dx), side = Math.acos((p - q) / length);
      c.arc(n[a], n[a + 1], p, along + side, along - side + 2 * Math.PI);
      c.arc(n[b], n[b + 1], q, along - side, along + side);
    }
    c.fill();
  }

  // Whether the line turns by less than 25 degrees at b: mitred joints look like round ones there, in two thirds of
  // the time.
  function smooth(n, a, b, c) {
    const x = n[b] - n[a], y = n[b + 1] - n[a + 1], u = n[c] - n[b], v = n[c + 1] - n[b + 1];
    const dot = x * u + y * v;
    return dot > 0 && dot * dot > 0.82 * (x * x + y * y) * (u * u + v * v);
  }

  // Pieces of one colour and width are one stroke.
  function band(c, n, at, count) {
    const first = at + 2, vertices = (count - 2) / 4, closed = n[at + 1] !== 0, pieces = closed ? vertices : vertices - 1;
    const place = (i) => first + 4 * (i % vertices);
    c.globalAlpha = n[at];
    for (let i = 0; i < pieces;) {
      const a = place(i), half = n[a + 2], colour = n[a + 3];
      if (n[place(i + 1) + 2] !== half) {
        c.fillStyle = css(colour);
        taper(c, n, a, place(i + 1));
        ++i;
        continue;
      }
      const begin = i;
      let mitre = true;
      c.beginPath();
      c.moveTo(n[a], n[a + 1]);
      for (let before = a, b = a; i < pieces && n[b + 3] === colour && n[b + 2] === half; ++i) {
        const next = place(i + 1);
        if (n[next + 2] !== half)
          break;
        c.lineTo(n[next], n[next + 1]);
        mitre = mitre && (i === begin || smooth(n, before, b, next));
        before = b;
        b = next;
      }
      if (i - begin === vertices) {
        c.closePath();
        mitre = mitre && smooth(n, place(vertices - 1), a, place(1));
      }
      c.lineJoin = mitre ? "miter" : "round";
      c.strokeStyle = css(colour);
      c.lineWidth = 2 * half;
      c.stroke();
    }
  }

  function disc(c, n, at) {
    c.globalAlpha = n[at + 4];
    c.fillStyle = css(n[at + 3]);
    c.beginPath();
    c.arc(n[at], n[at + 1], n[at + 2], 0, 2 * Math.PI);
    c.fill();
  }

  function glow(c, n, at) {
    const x = n[at], y = n[at + 1], radius = n[at + 2], colour = css(n[at + 3]);
    if (!(radius > 0))
      return;
    const light = c.createRadialGradient(x, y, 0, x, y, radius);
    for (let i = 0; i <= GLOW_STOPS; ++i) {
      const t = i / GLOW_STOPS, share = (1 - t * t) * (1 - t * t);
      light.addColorStop(t, colour + (0x100 + Math.round(255 * share)).toString(16).slice(1));
    }
    c.globalCompositeOperation = "lighter";
    c.globalAlpha = n[at + 4];
    c.fillStyle = light;
    c.fillRect(x - radius, y - radius, 2 * radius, 2 * radius);
    c.globalCompositeOperation = "source-over";
  }

  function text(c, n, at, what) {
    c.globalAlpha = n[at + 4];
    c.fillStyle = css(n[at + 3]);
    c.font = (n[at + 6] !== 0 ? "bold " : "") + n[at + 2] + "px sans-serif";
    c.textAlign = ["left", "center", "right"][n[at + 5]];
    c.textBaseline = "alphabetic";
    if (n[at + 7] === 0) {
      c.fillText(what, n[at], n[at + 1]);
      return;
    }
    c.save();
    c.translate(n[at], n[at + 1]);
    c.rotate(n[at + 7] * Math.PI / 180);
    c.fillText(what, 0, 0);
    c.restore();
  }

  function begin(c) {
    c.save();
    c.lineCap = "round";
    c.miterLimit = 10;
    c.setLineDash([]);
    c.globalCompositeOperation = "source-over";
  }

  return function drawPicture(context, operations, numbers, texts) {
    const words = (typeof texts === "string" ? texts : decoder.decode(texts.slice())).split("\0");
    let at = 0, word = 0;
    begin(context);
    for (let i = 0; i + 1 < operations.length; i += 2) {
      const count = operations[i + 1];
      switch (operations[i]) {
        case POLYGON: polygon(context, numbers, at, count); break;
        case BAND: band(context, numbers, at, count); break;
        case DISC: disc(context, numbers, at); break;
        case GLOW: glow(context, numbers, at); break;
        case TEXT: text(context, numbers, at, words[word++]); break;
        case CLIP:
          context.restore();
          begin(context);
          context.beginPath();
          context.rect(numbers[at], numbers[at + 1], numbers[at + 2], numbers[at + 3]);
          context.clip();
          break;
      }
      at += count;
    }
    context.restore();
  };
})();

if (typeof module !== "undefined")
  module.exports = drawPicture;
