// The player of the motion. Plain JavaScript without a library: the page works from a file, without a network.
(() => {
'use strict';
const element = document.getElementById('motion');
if (!element) return;
const data = JSON.parse(element.textContent);
const unpack = (name, Type) => {
  const text = atob(data[name]), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return new Type(bytes.buffer);
};
const times = unpack('t', Float32Array), displacements = unpack('d', Float32Array), forces = unpack('f',
  Float32Array);
const phases = unpack('phase', Uint16Array), counts = unpack('counts', Uint16Array);
const poses = unpack('poses', Float32Array), turns = unpack('turns', Int16Array), bodies = unpack('bodies',
  Float32Array);
const contactCounts = unpack('contactCounts', Uint16Array), contacts = unpack('contacts', Int16Array);
const frames = times.length;
if (frames === 0) return;

// Where each frame starts in the packed columns.
const before = [0];
for (const shell of data.shells) before.push(before[before.length - 1] + shell.l.length);
const poseAt = [0], turnAt = [0], contactAt = [0];
for (let i = 0; i < frames; ++i) {
  poseAt.push(poseAt[i] + 4 * counts[i]);
  turnAt.push(turnAt[i] + before[counts[i]]);
  contactAt.push(contactAt[i] + 4 * contactCounts[i]);
}

const byId = id => document.getElementById(id);
const stage = byId('stage'), context = stage.getContext('2d');
const ui = {};
for (const id of ['play', 'back', 'forward', 'scrub', 'speed', 'phase', 'showContacts', 'colourBend', 'fit',
  'rTime', 'rMove',
  'rForce', 'rBend', 'rContacts', 'keyBar', 'keyText', 'keyContacts']) ui[id] = byId(id);
const duration = times[frames - 1] - times[0];
let now = times[0], playing = false, lastTick = -1, zoom = 1, pan = [0, 0];

/// Frame at or before a time, and how far the time is towards the next one.
const locate = time => {
  let low = 0, high = frames - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle; else high = middle - 1;
  }
  const next = Math.min(low + 1, frames - 1), gap = times[next] - times[low];
  return { i: low, next, w: gap > 0 ? Math.min(Math.max((time - times[low]) / gap, 0), 1) : 0 };
};
const mix = (a, b, w) => a + (b - a) * w;
const mixAngle = (a, b, w) => {
  const turn = b - a;
  return a + w * (turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI)));
};
const pick = (table, t) => table[Math.round(Math.min(Math.max(t, 0), 1) * (table.length - 1)) || 0];

const camera = () => {
  const [x0, x1, y0, y1] = data.view, w = stage.clientWidth, h = stage.clientHeight;
  const scale = zoom * Math.min((w - 16) / (x1 - x0), (h - 16) / (y1 - y0));
  return { scale, x: w / 2 - scale * ((x0 + x1) / 2 + pan[0]), y: h / 2 + scale * ((y0 + y1) / 2 + pan[1]) };
};

const drawBodies = (at, pixel) => {
  for (const outline of data.outlines) {
    let x = 0, y = 0, angle = 0;
    if (outline.body >= 0 && outline.body < data.bodyCount) {
      const a = 3 * (at.i * data.bodyCount + outline.body), b = 3 * (at.next * data.bodyCount + outline.body);
      x = mix(bodies[a], bodies[b], at.w);
      y = mix(bodies[a + 1], bodies[b + 1], at.w);
      angle = mixAngle(bodies[a + 2], bodies[b + 2], at.w);
    }
    const c = Math.cos(angle), s = Math.sin(angle), p = outline.p;
    context.beginPath();
    if (outline.kind === 2) {
      const px = p.length ? p[0] : 0, py = p.length ? p[1] : 0;
      context.arc(x + c * px - s * py, y + s * px + c * py, outline.r, 0, 2 * Math.PI);
    } else {
      for (let k = 0; k < p.length; k += 2) context.lineTo(x + c * p[k] - s * p[k + 1], y + s * p[k] + c * p[k + 1]);
      if (outline.kind === 1) context.closePath();
    }
    context.lineWidth = outline.kind === 0 ? Math.max(1.6 * pixel, 2 * outline.r) : pixel;
    context.strokeStyle = outline.dark ? '#5a646f' : '#b4bcc5';
    context.fillStyle = outline.dark ? '#78828e' : '#dadee3';
    if (outline.kind !== 0) context.fill();
    context.stroke();
  }
};

/// One arc from the pen's place; moves the pen.
const arc = (pen, length, turn) => {
  const curvature = turn / length;
  if (Math.abs(turn) < 1e-4) {
    pen.x += length * Math.cos(pen.angle + turn / 2);
    pen.y += length * Math.sin(pen.angle + turn / 2);
    context.lineTo(pen.x, pen.y);
  } else {
    const cx = pen.x - Math.sin(pen.angle) / curvature, cy = pen.y + Math.cos(pen.angle) / curvature;
    const start = pen.angle - Math.sign(curvature) * Math.PI / 2;
    context.arc(cx, cy, Math.abs(1 / curvature), start, start + turn, curvature < 0);
    pen.x = cx + Math.sin(pen.angle + turn) / curvature;
    pen.y = cy - Math.cos(pen.angle + turn) / curvature;
  }
  pen.angle += turn;
};

const drawShells = (at, pixel) => {
  const byElement = ui.colourBend.checked;
  let energy = 0;
  for (let k = 0; k < counts[at.i]; ++k) {
    const shell = data.shells[k], n = shell.l.length;
    // A shell that only just appeared, or a torn record, is not interpolated.
    const w = k < counts[at.next] ? at.w : 0, j = w > 0 ? at.next : at.i;
    const a = poseAt[at.i] + 4 * k, b = poseAt[j] + 4 * k;
    const ta = turnAt[at.i] + before[k], tb = turnAt[j] + before[k];
    const pen = { x: mix(poses[a], poses[b], w), y: mix(poses[a + 1], poses[b + 1], w),
      angle: mixAngle(poses[a + 2], poses[b + 2], w) };
    const stored = mix(poses[a + 3], poses[b + 3], w);
    if (!Number.isFinite(pen.x + pen.y + pen.angle)) continue;
    if (Number.isFinite(stored)) energy += stored;
    context.lineWidth = Math.max(shell.h, 0.9 * pixel);
    context.strokeStyle = Number.isFinite(stored) ? pick(data.energyColours, data.energyScale > 0 ?
      stored / data.energyScale : 0) : '#9aa0a6';
    context.beginPath();
    context.moveTo(pen.x, pen.y);
    for (let e = 0; e < n; ++e) {
      const turn = mix(turns[ta + e], turns[tb + e], w) * data.turnUnit;
      if (byElement) {
        const change = turn / shell.l[e] - (shell.k0.length === n ? shell.k0[e] : 0);
        context.strokeStyle = pick(data.bendColours, data.bendScale > 0 ? 0.5 + 0.5 * change / data.bendScale : 0.5);
        context.beginPath();
        context.moveTo(pen.x, pen.y);
      }
      arc(pen, shell.l[e], turn);
      if (byElement) context.stroke();
    }
    if (shell.closed && !byElement) context.closePath();
    if (!byElement) context.stroke();
  }
  return energy;
};

const drawContacts = (frame, pixel, width) => {
  const [x0, y0, unit, most] = data.contactFrame;
  if (!(most > 0)) return;
  const longest = 0.16 * width;
  context.lineWidth = 1.5 * pixel;
  for (const slips of [0, 1]) {
    context.strokeStyle = slips ? '#d98a00' : '#0b3d2e';
    context.beginPath();
    for (let c = contactAt[frame]; c < contactAt[frame + 1]; c += 4) {
      if ((contacts[c] & 1) !== slips) continue;
      const x = x0 + unit * contacts[c], y = y0 + unit * contacts[c + 1];
      // Stored as signed square roots of the share of the largest force.
      const rx = contacts[c + 2] / 32767, ry = contacts[c + 3] / 32767, fx = rx * Math.abs(rx),
        fy = ry * Math.abs(ry);
      const size = Math.hypot(fx, fy);
      if (size === 0) continue;
      const reach = 0.5 * longest * Math.sqrt(size) / size;
      context.moveTo(x - fx * reach, y - fy * reach);
      context.lineTo(x + fx * reach, y + fy * reach);
    }
    context.stroke();
  }
};

const number = (value, digits) => Number.isFinite(value) ? value.toFixed(digits).replace('-', '\u2212') : '\u2013';

/// Markers on the diagrams. data-plot: left, top, width, height, x range, y range.
const plots = {};
for (const id of ['force', 'energy']) {
  const svg = byId(id + '-figure');
  if (svg && svg.dataset.plot) {
    const v = svg.dataset.plot.split(' ').map(Number);
    plots[id] = { svg, x: v[0], y: v[1], w: v[2], h: v[3], x0: v[4], x1: v[5], y0: v[6], y1: v[7],
      marker: byId(id + '-marker') };
  }
}
const moveMarkers = (displacement, force) => {
  const f = plots.force, e = plots.energy;
  if (f) {
    const u = (displacement - f.x0) / (f.x1 - f.x0), v = (force - f.y0) / (f.y1 - f.y0);
    const inside = u >= 0 && u <= 1 && v >= -0.01 && v <= 1.01;
    f.marker.setAttribute('visibility', inside ? 'visible' : 'hidden');
    if (inside) {
      f.marker.setAttribute('cx', (f.x + u * f.w).toFixed(2));
      f.marker.setAttribute('cy', (f.y + (1 - v) * f.h).toFixed(2));
    }
  }
  if (e) {
    const u = Math.min(Math.max((now - e.x0) / (e.x1 - e.x0), 0), 1);
    e.marker.setAttribute('visibility', 'visible');
    e.marker.setAttribute('transform', 'translate(' + (e.x + u * e.w).toFixed(2) + ' 0)');
  }
};

const draw = () => {
  const ratio = window.devicePixelRatio || 1, width = stage.clientWidth, height = stage.clientHeight;
  if (stage.width !== Math.round(width * ratio) || stage.height !== Math.round(height * ratio)) {
    stage.width = Math.round(width * ratio);
    stage.height = Math.round(height * ratio);
  }
  const at = locate(now), view = camera(), pixel = 1 / view.scale;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, stage.width, stage.height);
  context.setTransform(view.scale * ratio, 0, 0, -view.scale * ratio, view.x * ratio, view.y * ratio);
  context.lineCap = context.lineJoin = 'round';
  drawBodies(at, pixel);
  const energy = drawShells(at, pixel);
  const nearest = at.w > 0.5 ? at.next : at.i;
  if (ui.showContacts.checked) drawContacts(nearest, pixel, Math.min(data.view[1] - data.view[0],
    data.view[3] - data.view[2]));
  const displacement = mix(displacements[at.i], displacements[at.next], at.w), force = mix(forces[at.i],
    forces[at.next], at.w);
  ui.rTime.textContent = number(now, duration < 1 ? 4 : 2) + ' s';
  ui.rMove.textContent = number(1e3 * displacement, 2) + ' mm';
  ui.rForce.textContent = number(force, 3) + ' N';
  ui.rBend.textContent = number(1e3 * energy, 2) + ' mJ';
  ui.rContacts.textContent = contactCounts[nearest];
  if (document.activeElement !== ui.phase) ui.phase.value = String(phases[nearest]);
  if (document.activeElement !== ui.scrub || playing) ui.scrub.value = duration > 0 ? (now - times[0]) / duration : 0;
  moveMarkers(displacement, force);
};

const tick = stamp => {
  if (!playing) return;
  // A frame's stamp may lie before the key press that started it: the first one only sets the clock.
  const passed = lastTick < 0 ? 0 : Math.min(Math.max((stamp - lastTick) / 1e3, 0), 0.1);
  lastTick = stamp;
  now += Number(ui.speed.value) * passed;
  if (now >= times[frames - 1]) {
    now = times[frames - 1];
    play(false);
  }
  draw();
  if (playing) requestAnimationFrame(tick);
};
const play = wanted => {
  if (wanted && now >= times[frames - 1]) now = times[0];
  playing = wanted && duration > 0;
  ui.play.textContent = playing ? 'Pause' : 'Play';
  ui.play.setAttribute('aria-pressed', String(playing));
  if (playing) {
    lastTick = -1;
    requestAnimationFrame(tick);
  }
};
const seek = time => {
  now = Math.min(Math.max(time, times[0]), times[frames - 1]);
  draw();
};
/// To a recorded frame, never between two.
const step = by => {
  play(false);
  const at = locate(now);
  const from = by < 0 && at.w > 0 ? at.next : at.i;
  seek(times[Math.min(Math.max(from + by, 0), frames - 1)]);
};

const showKey = () => {
  const bend = ui.colourBend.checked, table = bend ? data.bendColours : data.energyColours;
  ui.keyBar.style.background = 'linear-gradient(to right, ' + table.join(', ') + ')';
  const scale = bend ? data.bendScale : 1e3 * data.energyScale;
  ui.keyText.textContent = bend ?
    'unbent \u2212' + scale.toPrecision(3) + ' \u2026 more bent +' + scale.toPrecision(3) +
      ' 1/m (change of curvature)'
    : '0 \u2026 ' + scale.toPrecision(3) + ' mJ bending energy a shell';
  ui.keyBar.hidden = ui.keyText.hidden = !(scale > 0);
  ui.keyContacts.hidden = !ui.showContacts.checked;
};

data.phaseNames.forEach((name, index) => {
  const option = document.createElement('option');
  option.value = String(index);
  option.textContent = name || 'run';
  ui.phase.append(option);
});
ui.play.onclick = () => play(!playing);
ui.back.onclick = () => step(-1);
ui.forward.onclick = () => step(1);
ui.scrub.oninput = () => { play(false); seek(times[0] + Number(ui.scrub.value) * duration); };
ui.phase.onchange = () => {
  const first = phases.indexOf(Number(ui.phase.value));
  ui.phase.blur();
  if (first >= 0) seek(times[first]);
};
ui.showContacts.onchange = ui.colourBend.onchange = () => { showKey(); draw(); };
ui.fit.onclick = () => { zoom = 1; pan = [0, 0]; draw(); };

document.addEventListener('keydown', event => {
  const target = event.target, tag = target.tagName;
  if (event.ctrlKey || event.altKey || event.metaKey || tag === 'SELECT') return;
  if (event.key === ' ') {
    if (tag === 'BUTTON' || target.type === 'checkbox') return; // the control's own key
    play(!playing);
  } else if (event.key === 'ArrowRight') step(event.shiftKey ? 10 : 1);
  else if (event.key === 'ArrowLeft') step(event.shiftKey ? -10 : -1);
  else if (event.key === 'Home') { play(false); seek(times[0]); }
  else if (event.key === 'End') { play(false); seek(times[frames - 1]); }
  else return;
  event.preventDefault();
});

// Zoom with ctrl + wheel (a plain wheel scrolls the page), drag to move, double click to fit.
stage.addEventListener('wheel', event => {
  if (!event.ctrlKey) return;
  event.preventDefault();
  const old = camera(), wx = (event.offsetX - old.x) / old.scale, wy = (old.y - event.offsetY) / old.scale;
  zoom = Math.min(Math.max(zoom * Math.exp(-0.002 * event.deltaY), 1), 60);
  const fresh = camera();
  pan[0] += wx - (event.offsetX - fresh.x) / fresh.scale;
  pan[1] += wy - (fresh.y - event.offsetY) / fresh.scale;
  if (zoom === 1) pan = [0, 0];
  draw();
}, { passive: false });
let grip = null;
stage.addEventListener('pointerdown', event => { if (event.pointerType === 'mouse') { grip = [event.clientX,
  event.clientY]; stage.setPointerCapture(event.pointerId); } });
stage.addEventListener('pointermove', event => {
  if (!grip) return;
  const scale = camera().scale;
  pan[0] -= (event.clientX - grip[0]) / scale;
  pan[1] += (event.clientY - grip[1]) / scale;
  grip = [event.clientX, event.clientY];
  draw();
});
stage.addEventListener('pointerup', () => { grip = null; });
stage.addEventListener('pointercancel', () => { grip = null; });
stage.addEventListener('dblclick', () => ui.fit.onclick());

const inPlot = (plot, event) => {
  const box = plot.svg.getBoundingClientRect(), unit = plot.svg.viewBox.baseVal.width / box.width;
  return [((event.clientX - box.left) * unit - plot.x) / plot.w,
    1 - ((event.clientY - box.top) * unit - plot.y) / plot.h];
};
if (plots.energy) plots.energy.svg.addEventListener('click', event => {
  const [u] = inPlot(plots.energy, event);
  if (u >= 0 && u <= 1) { play(false); seek(mix(plots.energy.x0, plots.energy.x1, u)); }
});
if (plots.force) plots.force.svg.addEventListener('click', event => {
  const [u, v] = inPlot(plots.force, event), p = plots.force;
  let best = -1, least = 0.0025; // within a twentieth of the diagram
  for (let i = 0; i < frames; ++i) {
    const du = (displacements[i] - p.x0) / (p.x1 - p.x0) - u, dv = (forces[i] - p.y0) / (p.y1 - p.y0) - v;
    if (du * du + dv * dv < least) { least = du * du + dv * dv; best = i; }
  }
  if (best >= 0) { play(false); seek(times[best]); }
});
for (const row of document.querySelectorAll('tr[data-time]'))
  row.addEventListener('click', () => { play(false); seek(Number(row.dataset.time)); stage.scrollIntoView({
    block: 'nearest' }); });

const fitStage = () => {
  const aspect = (data.view[3] - data.view[2]) / (data.view[1] - data.view[0]);
  stage.style.height = Math.round(Math.min(Math.max(stage.clientWidth * aspect, 180), 500)) + 'px';
  draw();
};
new ResizeObserver(fitStage).observe(stage.parentElement);
fitStage();
// report.html#t=12.5&contacts&curvature opens at that moment, with that valueText.
const openAt = () => {
  const wanted = new URLSearchParams(location.hash.slice(1));
  ui.showContacts.checked = wanted.has('contacts');
  ui.colourBend.checked = wanted.has('curvature');
  showKey();
  const time = parseFloat(wanted.get('t'));
  play(false);
  seek(Number.isFinite(time) ? time : times[data.start]);
};
window.addEventListener('hashchange', openAt);
openAt();
})();
