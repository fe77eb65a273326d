// The phase diagram as a control: opening angle across, friction upwards, the boundary of equation (1), a dot to drag.

const OPENINGS = [0.5, 0.95], FRICTIONS = [0, 1];

class Pad {
  constructor(canvas, onChange) {
    this.canvas = canvas;
    this.onChange = onChange;
    this.opening = 0.75;
    this.friction = 0.35;
    this.boundary = null;
    const move = (event) => {
      const box = canvas.getBoundingClientRect(), m = this.margins(box.width, box.height);
      const x = (event.clientX - box.left - m.left) / m.width, y = 1 - (event.clientY - box.top - m.top) / m.height;
      this.change(OPENINGS[0] + x * (OPENINGS[1] - OPENINGS[0]), FRICTIONS[0] + y * (FRICTIONS[1] - FRICTIONS[0]));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.held = true;
      move(event);
    });
    canvas.addEventListener("pointermove", (event) => this.held && move(event));
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, () => { this.held = false; });
    canvas.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: [-0.01, 0], ArrowRight: [0.01, 0], ArrowUp: [0, 0.02], ArrowDown: [0, -0.02] }[event.key];
      if (!by)
        return;
      event.preventDefault();
      this.change(this.opening + by[0], this.friction + by[1]);
    });
  }

  /** Pixels of the canvas where an opening angle and a friction are. */
  place(opening, friction) {
    const m = this.margins(this.canvas.clientWidth, this.canvas.clientHeight);
    return [m.left + m.width * (opening - OPENINGS[0]) / (OPENINGS[1] - OPENINGS[0]),
      m.top + m.height * (1 - (friction - FRICTIONS[0]) / (FRICTIONS[1] - FRICTIONS[0]))];
  }

  margins(width, height) {
    return { left: 34, top: 8, width: width - 44, height: height - 36 };
  }

  change(opening, friction) {
    const clamp = (x, [low, high]) => Math.max(low, Math.min(high, x));
    this.set(Math.round(clamp(opening, OPENINGS) * 1000) / 1000, Math.round(clamp(friction, FRICTIONS) * 1000) / 1000);
    this.onChange(this.opening, this.friction);
  }

  set(opening, friction) {
    this.opening = opening;
    this.friction = friction;
    this.draw();
  }

  draw() {
    const { context, width, height } = fitted(this.canvas);
    const m = this.margins(width, height);
    const x = (o) => this.place(o, 0)[0], y = (f) => this.place(0, f)[1];
    context.fillStyle = "#0c1015";
    context.fillRect(0, 0, width, height);
    context.save();
    context.beginPath();
    context.rect(m.left, m.top, m.width, m.height);
    context.clip();
    context.fillStyle = "#14303f";
    context.fillRect(m.left, m.top, m.width, m.height);
    if (this.boundary)
      this.drawBoundary(context, m, x, y);
    context.restore();
    context.fillStyle = "#a9b7c6";
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    for (const o of [0.5, 0.6, 0.7, 0.8, 0.9])
      context.fillText(o.toFixed(1), x(o), height - 16);
    context.fillText("opening angle / 360°", m.left + m.width / 2, height - 3);
    context.textAlign = "right";
    for (const f of [0, 0.5, 1])
      context.fillText(f.toFixed(1), m.left - 4, y(f) + 4);
    context.save();
    context.translate(10, m.top + m.height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("friction", 0, 0);
    context.restore();
    context.beginPath();
    context.arc(x(this.opening), y(this.friction), 9, 0, 7);
    context.fillStyle = "#ffb454";
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = "#fff";
    context.stroke();
  }

  drawBoundary(context, m, x, y) {
    const line = [];
    for (let i = 0; i <= 120; ++i) {
      const o = OPENINGS[0] + (OPENINGS[1] - OPENINGS[0]) * i / 120, f = this.boundary(o);
      if (Number.isFinite(f))
        line.push([x(o), y(Math.min(f, 3))]);
    }
    if (line.length < 2)
      return;
    context.beginPath();
    line.forEach(([px, py], i) => (i ? context.lineTo(px, py) : context.moveTo(px, py)));
    context.lineTo(line.at(-1)[0], m.top - 200);
    context.lineTo(line[0][0], m.top - 200);
    context.closePath();
    context.fillStyle = "#4a2f12";
    context.fill();
    context.beginPath();
    line.forEach(([px, py], i) => (i ? context.lineTo(px, py) : context.moveTo(px, py)));
    context.strokeStyle = "#fff";
    context.lineWidth = 1.5;
    context.stroke();
    context.fillStyle = "#e9eef4";
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "left";
    context.fillText("slides: smooth", m.left + 10, m.top + m.height - 10);
    context.textAlign = "right";
    context.fillText("sticks: abrupt", m.left + m.width - 8, m.top + 18);
  }
}

/** A canvas in the resolution of the screen; CSS pixels from here on. */
function fitted(canvas, ratio = Math.min(2, devicePixelRatio || 1)) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height, ratio };
}
