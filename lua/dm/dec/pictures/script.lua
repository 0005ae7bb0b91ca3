--- The script of a page that turns a mesh (K:animate), as text: plain JavaScript on a canvas, no
-- library, no network. Faces are drawn from the farthest to the nearest; #form=2 in the address
-- chooses a form, #row=5 a row of a film, and the picture stands still then.
return [==[
"use strict";
const scene = JSON.parse(document.getElementById("data").textContent);
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
const element = id => document.getElementById(id);
const scenePoints = new Float32Array(bytes(scene.points)), points = scenePoints;
const faces = new Uint32Array(bytes(scene.faces)), edges = new Uint32Array(bytes(scene.edges));
for (const form of scene.forms) {
  if (form.values) form.values = new Float32Array(bytes(form.values));
  form.arrows = new Float32Array(bytes(form.arrows));
}
const canvas = element("picture"), film = scene.motion; // values of a form row by row, or nothing
if (film) {
  film.t = new Float64Array(bytes(film.t));
  film.values = new Float32Array(bytes(film.values));
  film.points = film.points ? new Float32Array(bytes(film.points)) : null;
  film.size = film.values.length / film.frames;
  film.row = 0;
  film.runs = true;
  film.shown = 0; // seconds since this row came
}
const state = { form: scene.forms.length > 1 ? 1 : 0, turning: scene.dim === 3, azimuth: -0.6,
  height: 0.35, zoom: 1 };

const box = (() => {
  const points = film && film.points || scenePoints; // of all rows
  const lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    lo[i % 3] = Math.min(lo[i % 3], points[i]);
    hi[i % 3] = Math.max(hi[i % 3], points[i]);
  }
  const half = lo.map((x, c) => (hi[c] - x) / 2);
  const middle = lo.map((x, c) => (x + hi[c]) / 2);
  if (scene.dim === 3) {
    let radius = 0;
    for (let i = 0; i < points.length; i += 3) {
      radius = Math.max(radius, Math.hypot(...[0, 1, 2].map(c => points[i + c] - middle[c])));
    }
    half.fill(radius);
  }
  return { middle, half };
})();

// (x, y, z) -> across, up, towards the eye
function turned(x, y, z) {
  const dx = x - box.middle[0], dy = y - box.middle[1], dz = z - box.middle[2];
  if (scene.dim < 3) return [dx, dy, 0];
  const c = Math.cos(state.azimuth), s = Math.sin(state.azimuth);
  const ch = Math.cos(state.height), sh = Math.sin(state.height), deep = c * dy + s * dx;
  return [c * dx - s * dy, ch * dz + sh * deep, sh * dz - ch * deep];
}

function colour(form, x) {
  const place = (x - form.least) / (form.largest - form.least) * (form.stops.length - 1);
  const at = Math.max(0, Math.min(form.stops.length - 1, place));
  const i = Math.min(form.stops.length - 2, Math.floor(at)), t = at - i;
  const part = (stop, k) => parseInt(stop.slice(1 + 2 * k, 3 + 2 * k), 16);
  const mixed = [0, 1, 2].map(k =>
    Math.round(part(form.stops[i], k) * (1 - t) + part(form.stops[i + 1], k) * t));
  return "rgb(" + mixed.join(",") + ")";
}
for (const form of scene.forms) {
  form.colours = form.values ? Array.from(form.values, x => colour(form, x)) : [];
}
// row i of a film: its values are those of the second form
function show(i) {
  film.row = i;
  const form = scene.forms[1], n = points.length;
  form.values = film.values.subarray(i * film.size, (i + 1) * film.size);
  form.colours = Array.from(form.values, x => colour(form, x));
  if (film.points) points.set(film.points.subarray(i * n, (i + 1) * n));
  element("row").value = i;
  element("time").textContent = "t = " + film.t[i].toPrecision(4);
}

// a context whose unit is the CSS pixel, cleared
function clear() {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  canvas.width = Math.round(w * ratio);
  canvas.height = Math.round(h * ratio);
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  return g;
}

// every point across, down, towards the eye, in pixels
function seen(list) {
  const w = canvas.clientWidth - 110, h = canvas.clientHeight, out = new Float32Array(list.length);
  const fit = Math.min(w / (2 * box.half[0] || 1), h / (2 * box.half[1] || 1));
  const scale = 0.9 * state.zoom * fit;
  for (let i = 0; i < list.length; i += 3) {
    const at = turned(list[i], list[i + 1], list[i + 2]);
    out[i] = w / 2 + scale * at[0];
    out[i + 1] = h / 2 - scale * at[1];
    out[i + 2] = scale * at[2];
  }
  return out;
}

function trace(g, at, cells, first, size) {
  g.beginPath();
  for (let j = 0; j < size; j++) {
    const v = 3 * cells[first + j];
    if (j === 0) g.moveTo(at[v], at[v + 1]); else g.lineTo(at[v], at[v + 1]);
  }
}

function drawFace(g, at, form, i) {
  const fill = form.on === "faces" ? form.colours[i] : "#e3e9f0", edged = element("edges").checked;
  trace(g, at, faces, 3 * i, 3);
  g.closePath();
  g.fillStyle = fill;
  g.fill();
  g.strokeStyle = edged && form.on !== "edges" ? "#777" : fill; // its own colour closes the seams
  g.lineWidth = 0.6;
  g.stroke();
}

function drawEdge(g, at, form, i) {
  trace(g, at, edges, 2 * i, 2);
  g.strokeStyle = form.on === "edges" ? form.colours[i] : "#333";
  g.lineWidth = 2;
  g.stroke();
}

function drawArrow(g, at, i) {
  const [x0, y0, , x, y] = at.subarray(6 * i, 6 * i + 5), dx = x - x0, dy = y - y0;
  g.strokeStyle = "#111";
  g.lineWidth = 1.1;
  g.beginPath();
  g.moveTo(x0, y0);
  g.lineTo(x, y);
  for (const side of [-1, 1]) {
    g.moveTo(x, y);
    g.lineTo(x - 0.3 * dx + side * 0.15 * dy, y - 0.3 * dy - side * 0.15 * dx);
  }
  g.stroke();
}

function typicalLength(at) {
  let sum = 0;
  for (let i = 0; i < edges.length; i += 2) {
    sum += Math.hypot(...[0, 1, 2].map(c => at[3 * edges[i] + c] - at[3 * edges[i + 1] + c]));
  }
  return 2 * sum / edges.length;
}

// is a face of a body turned away? What is seen of it then is inside
function isTurnedAway(at, i) {
  if (!scene.solid) return false;
  const [p, q, r] = [0, 1, 2].map(j => 3 * faces[3 * i + j]);
  const x = [at[q] - at[p], at[p + 1] - at[q + 1]], y = [at[r] - at[p], at[p + 1] - at[r + 1]];
  return x[0] * y[1] - x[1] * y[0] < 0;
}

// all that is drawn from the farthest to the nearest; lines a little before the faces they lie on
function pieces(at, form, tips) {
  const out = [], near = 0.5 * typicalLength(at);
  const add = (cells, size, kind, nearer) => {
    for (let i = 0; i < cells.length / size; i++) {
      if (kind === 0 && isTurnedAway(at, i)) continue;
      let depth = nearer;
      for (let j = 0; j < size; j++) depth += at[3 * cells[size * i + j] + 2] / size;
      out.push([depth, kind, i]);
    }
  };
  add(faces, 3, 0, 0);
  if (form.on === "edges" || faces.length === 0) add(edges, 2, 1, near);
  for (let i = 0; i < tips.length / 6; i++) {
    out.push([(tips[6 * i + 2] + tips[6 * i + 5]) / 2 + 1.5 * near, 2, i]);
  }
  if (scene.dim === 3) out.sort((a, b) => a[0] - b[0]);
  return out;
}

function digits(x) {
  if (x === 0) return "0";
  return Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5 ? x.toExponential(2) : x.toPrecision(3);
}

function drawScale(g, form) {
  const w = canvas.clientWidth, h = canvas.clientHeight;
  g.fillStyle = "#333";
  g.font = "12px sans-serif";
  g.textAlign = "right";
  g.fillText(form.label, w - 8, 22);
  g.textAlign = "left";
  if (!form.values) return;
  const steps = 120, top = 40, length = h - 80;
  for (let i = 0; i < steps; i++) {
    g.fillStyle = colour(form, form.least + (form.largest - form.least) * (i + 0.5) / steps);
    g.fillRect(w - 92, top + length * (1 - (i + 1) / steps), 16, length / steps + 1);
  }
  g.fillStyle = "#333";
  for (let i = 0; i <= 4; i++) {
    const x = form.least + (form.largest - form.least) * i / 4;
    g.fillText(digits(x), w - 70, top + length * (1 - i / 4) + 4);
  }
}

function draw() {
  const g = clear(), form = scene.forms[state.form], at = seen(points);
  const tips = element("arrows").checked ? seen(form.arrows) : new Float32Array(0);
  for (const [, kind, i] of pieces(at, form, tips)) {
    if (kind === 0) drawFace(g, at, form, i);
    else if (kind === 1) drawEdge(g, at, form, i);
    else drawArrow(g, tips, i);
  }
  drawScale(g, form);
  document.body.setAttribute("data-form", form.name);
}

function turn(on) {
  state.turning = on && scene.dim === 3;
  element("turn").textContent = state.turning ? "hold" : "turn";
}

// the next rows, as many as fit into the time that passed; is there a new one?
function advance(seconds) {
  if (!film || !film.runs) return false;
  const each = film.seconds / film.frames;
  film.shown += seconds;
  const steps = Math.floor(film.shown / each);
  film.shown -= steps * each;
  if (steps > 0) show((film.row + steps) % film.frames);
  return steps > 0;
}

let before = null;
function tick(now) {
  const passed = before === null ? 0 : Math.min(0.1, (now - before) / 1000);
  if (state.turning) state.azimuth += 0.4 * passed;
  if (advance(passed) || state.turning && before !== null) draw();
  before = now;
  requestAnimationFrame(tick);
}

function watchMouse() {
  let at = null;
  canvas.addEventListener("pointerdown", e => { at = [e.clientX, e.clientY]; turn(false); });
  window.addEventListener("pointerup", () => { at = null; });
  window.addEventListener("pointermove", e => {
    if (!at || scene.dim < 3) return;
    state.azimuth += (e.clientX - at[0]) / 120;
    state.height = Math.max(-1.57, Math.min(1.57, state.height + (e.clientY - at[1]) / 120));
    at = [e.clientX, e.clientY];
    draw();
  });
  canvas.addEventListener("wheel", e => {
    e.preventDefault();
    state.zoom = Math.max(0.2, Math.min(50, state.zoom * Math.exp(-e.deltaY / 500)));
    draw();
  }, { passive: false });
}

function watchFilm() {
  const run = on => { film.runs = on; element("go").textContent = on ? "pause" : "play"; };
  element("film").hidden = false;
  element("row").max = film.frames - 1;
  element("row").addEventListener("input", e => {
    run(false);
    show(Number(e.target.value));
    draw();
  });
  element("go").addEventListener("click", () => run(!film.runs));
  window.addEventListener("keydown", e => {
    if (e.key !== " ") return;
    run(!film.runs);
    e.preventDefault();
  });
  const row = /row=(\d+)/.exec(location.hash);
  show(row ? Math.min(film.frames, Number(row[1])) - 1 : 0);
  if (row) run(false);
}

scene.forms.forEach((form, i) => {
  const choice = document.createElement("option");
  choice.value = i;
  choice.textContent = form.name;
  element("form").appendChild(choice);
});
const asked = /form=(\d+)/.exec(location.hash);
if (asked && scene.forms[Number(asked[1]) - 1]) {
  state.form = Number(asked[1]) - 1;
  turn(false);
} else turn(state.turning);
element("form").value = state.form;
element("edges").checked = faces.length < 9000;
element("form").addEventListener("change", e => { state.form = Number(e.target.value); draw(); });
for (const id of ["edges", "arrows"]) element(id).addEventListener("change", draw);
element("turn").addEventListener("click", () => turn(!state.turning));
window.addEventListener("resize", draw);
watchMouse();
if (film) watchFilm();
draw();
requestAnimationFrame(tick);
]==]
