// The live force curve, and the energies as bars.

class Curve {
  constructor(canvas) {
    this.canvas = canvas;
    this.clear();
  }

  clear(key = []) {
    this.key = key;
    this.strokes = [[]];
    this.others = [[]];
    this.draw();
  }

  /** Another test begins; what was measured stays as pale lines. */
  next() {
    if (this.strokes.at(-1).length > 1)
      this.push([], []);
  }

  push(stroke, other) {
    this.strokes.push(stroke);
    this.others.push(other);
    if (this.strokes.length > 6) {
      this.strokes.shift();
      this.others.shift();
    }
  }

  /** Force (N) at a travel (m); `other` is a second instrument's. A stroke ends where the travel turns. */
  add(travel, force, other) {
    const stroke = this.strokes.at(-1), last = stroke.at(-1), before = stroke.at(-2);
    if (last && Math.abs(travel - last[0]) < 1e-6)
      return;
    if (before && (travel - last[0]) * (last[0] - before[0]) < 0) {
      this.push([last], [this.others.at(-1).at(-1)]);
    }
    this.strokes.at(-1).push([travel, force]);
    this.others.at(-1).push([travel, other]);
  }

  draw() {
    const { context, width, height } = fitted(this.canvas);
    context.fillStyle = "#0c1015";
    context.fillRect(0, 0, width, height);
    const points = this.strokes.flat();
    const right = Math.max(1e-3, ...points.map((p) => p[0]));
    const high = Math.max(1e-3, ...points.map((p) => p[1])), low = Math.min(-0.08 * high, ...points.map((p) => p[1]));
    const x = (t) => 44 + (width - 54) * t / right, y = (f) => 12 + (height - 34) * (high - f) / (high - low);
    context.strokeStyle = "#33404f";
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(44, y(0));
    context.lineTo(width - 10, y(0));
    context.stroke();
    context.fillStyle = "#a9b7c6";
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    if (points.length > 1) {
      context.fillText(unitText(high, "N"), 42, y(high) + 8);
      context.fillText(`${right.toFixed(2)} m`, width - 8, height - 4);
    }
    context.fillText("0", 42, y(0) + 4);
    context.textAlign = "left";
    context.fillText("force over travel", 50, height - 4);
    context.textAlign = "right";
    this.key.forEach((name, i) => {
      context.fillStyle = ["#6cc9ff", "#ff7a7a"][i];
      context.fillText(name, width - 10, 24 + 13 * i);
    });
    this.lines(context, this.others, x, y, "#ff7a7a");
    this.lines(context, this.strokes, x, y, "#6cc9ff");
  }

  lines(context, strokes, x, y, colour) {
    context.strokeStyle = colour;
    strokes.forEach((stroke, i) => {
      context.globalAlpha = i === strokes.length - 1 ? 1 : 0.45;
      context.lineWidth = i === strokes.length - 1 ? 2 : 1.2;
      context.beginPath();
      let open = false;
      for (const p of stroke) {
        if (p === undefined || p[1] === undefined || !Number.isFinite(p[1]))
          continue;
        const py = Math.max(-50, Math.min(2000, y(p[1])));
        open ? context.lineTo(x(p[0]), py) : context.moveTo(x(p[0]), py);
        open = true;
      }
      context.stroke();
    });
    context.globalAlpha = 1;
  }
}

/** 0.0023 J as "2.3 mJ". */
function unitText(value, unit) {
  const size = Math.abs(value);
  if (size < 1e-9)
    return `0 ${unit}`;
  const [factor, prefix] = size >= 1000 ? [1e-3, "k"] : size >= 1 ? [1, ""] : size >= 1e-3 ? [1e3, "m"] : [1e6, "µ"];
  const scaled = value * factor;
  return `${Math.abs(scaled) >= 99.5 ? scaled.toFixed(0) : scaled.toPrecision(2)} ${prefix}${unit}`;
}

class Energies {
  constructor(list) {
    this.most = 1e-9;
    this.rows = {};
    for (const [key, name] of [["bending", "bent"], ["kinetic", "moving"], ["friction", "rubbed away"]]) {
      list.insertAdjacentHTML("beforeend", `<dt>${name}</dt><dd class="bar"><i></i></dd><dd class="value"></dd>`);
      this.rows[key] = { bar: list.querySelector(".bar:nth-last-of-type(2) i"), value: list.lastElementChild };
    }
  }

  clear() {
    this.most = 1e-9;
  }

  show(energy) {
    for (const key in this.rows)
      this.most = Math.max(this.most, energy[key]);
    for (const [key, row] of Object.entries(this.rows)) {
      row.bar.style.width = `${Math.max(0, Math.min(100, 100 * energy[key] / this.most))}%`;
      row.value.textContent = unitText(Math.max(0, energy[key]), "J");
    }
  }
}
