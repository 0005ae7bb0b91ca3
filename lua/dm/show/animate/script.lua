--- The script of an animated page (dm.animate), as text: plain JavaScript on canvases, no library,
-- no network. open(scene) shows the JSON of the page (dm.animate.page says what is in it) and draws
-- frame after frame, show(scene) goes on with another; #t=1.5 in the address starts there, standing
-- still. What is drawn is always a recorded row: nothing is interpolated.
local palette = require "dm.show.palette"

local text = [==[
"use strict";
const COLOURS = [@COLOURS@];
const colour = i => COLOURS[i % COLOURS.length];
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
const element = id => document.getElementById(id);

let scene, first, last, seconds, box;
const state = { t: NaN, playing: true, speed: 1, trail: 0, azimuth: -0.6, height: 0.35, zoom: 1 };

// numbers back from base64: times are doubles, positions and quantities floats
function unpack(data) {
  for (const path of data.paths) {
    path.t = new Float64Array(bytes(path.t));
    path.xyz = new Float32Array(bytes(path.xyz));
    for (const body of path.bodies) {
      body.vertices = new Float32Array(bytes(body.vertices));
      body.poses = new Float32Array(bytes(body.poses));
    }
  }
  for (const plot of data.plots) {
    for (const line of plot.lines) {
      line.t = new Float64Array(bytes(line.t));
      line.y = new Float32Array(bytes(line.y));
    }
  }
  return data;
}

// what is shown from now on; the clock and the camera stay
function load(data) {
  scene = unpack(data);
  first = Math.min(...scene.paths.map(p => p.t[0]));
  last = Math.max(...scene.paths.map(p => p.t[p.t.length - 1]));
  // what the whole takes at speed 1
  seconds = Math.max(4, Math.min(20, scene.paths[0].t.length / 30));
  box = extent();
  state.trail = scene.trail;
  state.t = state.t >= first && state.t <= last ? state.t : first;
}

// the last row at or before t
function row(times, t) {
  let low = 0, high = times.length - 1;
  const slack = 1e-9 * (last - first);
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t + slack) low = middle; else high = middle - 1;
  }
  return low;
}

// ---- from space to the canvas ----

// middle and half width of everything that is shown, the same in all panels
function extent() {
  const lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
  for (const path of scene.paths) {
    for (let i = 0; i < path.xyz.length; i++) {
      const axis = i % scene.dim;
      lo[axis] = Math.min(lo[axis], path.xyz[i]);
      hi[axis] = Math.max(hi[axis], path.xyz[i]);
    }
    for (const body of path.bodies) {
      const reach = Math.max(...body.reach);
      for (let i = 0; i < body.poses.length; i++) {
        if (i % 7 < 4) continue;
        lo[i % 7 - 4] = Math.min(lo[i % 7 - 4], body.poses[i] - reach);
        hi[i % 7 - 4] = Math.max(hi[i % 7 - 4], body.poses[i] + reach);
      }
    }
    if (path.rods.some(rod => rod[0] === 0)) {
      for (let axis = 0; axis < scene.dim; axis++) {
        lo[axis] = Math.min(lo[axis], 0);
        hi[axis] = Math.max(hi[axis], 0);
      }
    }
  }
  const middle = [0, 0, 0], half = [0, 0, 0];
  for (let axis = 0; axis < scene.dim; axis++) {
    middle[axis] = (lo[axis] + hi[axis]) / 2;
    half[axis] = (hi[axis] - lo[axis]) / 2;
  }
  if (scene.dim === 3) {
    const ball = scene.paths.some(path => path.bodies.length > 0) ? Math.max(...half) : 0;
    half.fill(ball || Math.hypot(...half));
  }
  const least = 0.02 * Math.max(...half) || 1;
  return { middle, half: half.map(h => Math.max(h, least)) };
}

// (x, y, z) -> [right, up, towards the eye] in units of space, as the camera sees it
function turned(x, y, z) {
  if (scene.dim < 3) return [x - box.middle[0], y - box.middle[1], 0];
  const dx = x - box.middle[0], dy = y - box.middle[1], dz = z - box.middle[2];
  const c = Math.cos(state.azimuth), s = Math.sin(state.azimuth);
  const ch = Math.cos(state.height), sh = Math.sin(state.height), deep = c * dy + s * dx;
  return [c * dx - s * dy, ch * dz + sh * deep, sh * dz - ch * deep];
}

function camera(canvas) {
  const w = canvas.clientWidth, h = canvas.clientHeight;
  const scale = state.zoom * 0.88 * Math.min(w / (2 * box.half[0]), h / (2 * box.half[1]));
  return (x, y, z) => {
    const at = turned(x, y, z);
    return [w / 2 + scale * at[0], h / 2 - scale * at[1], scale * at[2]];
  };
}

// a context whose unit is the CSS pixel, cleared
function clear(canvas) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio)) canvas.width = Math.round(w * ratio);
  if (canvas.height !== Math.round(h * ratio)) canvas.height = Math.round(h * ratio);
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  return g;
}

]==] .. require "dm.show.animate.body_script" .. [==[
// ---- one panel ----

function place(path, frame, point, see) {
  if (point === 0) return see(0, 0, 0);
  const at = (frame * path.points + point - 1) * scene.dim;
  return see(path.xyz[at], path.xyz[at + 1], scene.dim === 3 ? path.xyz[at + 2] : 0);
}

// points whose trails are drawn: of many the last
function trailing(path) {
  const all = path.trails || Array.from({ length: path.points }, (_, i) => i + 1);
  return all.length > 12 ? all.slice(-1) : all;
}

// `shown` tells of a depth whether it belongs to this layer
function drawTrails(g, path, frame, see, shown) {
  const from = row(path.t, path.t[frame] - state.trail);
  g.lineWidth = 1.2;
  for (const point of trailing(path)) {
    g.strokeStyle = colour(point - 1);
    for (let piece = 0; piece < 4; piece++) { // older pieces are paler
      const a = from + Math.floor((frame - from) * piece / 4);
      const b = from + Math.floor((frame - from) * (piece + 1) / 4);
      g.globalAlpha = 0.2 + 0.2 * piece;
      g.beginPath();
      for (let i = a; i <= b; i++) {
        const at = place(path, i, point, see);
        if (i === a || !shown(at[2])) g.moveTo(at[0], at[1]); else g.lineTo(at[0], at[1]);
      }
      g.stroke();
    }
  }
  g.globalAlpha = 1;
}

function drawRods(g, path, frame, see, shown) {
  g.strokeStyle = "#333";
  g.lineWidth = 2;
  g.beginPath();
  for (const rod of path.rods) {
    const a = place(path, frame, rod[0], see), b = place(path, frame, rod[1], see);
    if (!shown((a[2] + b[2]) / 2)) continue;
    g.moveTo(a[0], a[1]);
    g.lineTo(b[0], b[1]);
  }
  g.stroke();
}

function disk(g, at, radius, fill) {
  g.fillStyle = fill;
  g.beginPath();
  g.arc(at[0], at[1], radius, 0, 2 * Math.PI);
  g.fill();
}

function drawAxes(g, canvas, see) {
  const origin = see(0, 0, 0), h = canvas.clientHeight;
  if (scene.dim === 2) {
    g.strokeStyle = "#e4e4e4";
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(0, origin[1]);
    g.lineTo(canvas.clientWidth, origin[1]);
    g.moveTo(origin[0], 0);
    g.lineTo(origin[0], h);
    g.stroke();
  }
  g.font = "12px sans-serif";
  g.lineWidth = 1.5;
  for (let axis = 0; axis < scene.dim; axis++) { // a little cross of axes in the corner
    const unit = see(axis === 0 ? 1 : 0, axis === 1 ? 1 : 0, axis === 2 ? 1 : 0);
    const one = see(box.middle[0] + 1, box.middle[1], box.middle[2]), zero = see(...box.middle);
    const size = scene.dim === 2 ? Math.abs(one[0] - zero[0]) : Math.hypot(...[0, 1, 2].map(a => {
      const e = see(a === 0 ? 1 : 0, a === 1 ? 1 : 0, a === 2 ? 1 : 0);
      return Math.hypot(e[0] - origin[0], e[1] - origin[1]);
    })) / Math.SQRT2;
    const dx = 26 * (unit[0] - origin[0]) / size, dy = 26 * (unit[1] - origin[1]) / size;
    g.strokeStyle = g.fillStyle = "#999";
    g.beginPath();
    g.moveTo(36, h - 36);
    g.lineTo(36 + dx, h - 36 + dy);
    g.stroke();
    g.fillText(scene.axes[axis], 32 + 1.45 * dx, h - 32 + 1.45 * dy);
  }
}

// what lies in front of the bodies, or behind them
function drawLayer(g, path, frame, see, shown) {
  if (state.trail > 0) drawTrails(g, path, frame, see, shown);
  drawRods(g, path, frame, see, shown);
  const origin = see(0, 0, 0);
  if (path.rods.some(rod => rod[0] === 0) && shown(origin[2])) disk(g, origin, 3, "#333");
  const radius = path.points > 40 ? 2.5 : path.bodies.length > 0 ? 4 : 6;
  for (let point = 1; point <= path.points; point++) {
    const at = place(path, frame, point, see);
    const front = path.bodies.length > 1 ? shown(Infinity) : shown(at[2]);
    if (front) disk(g, at, radius, colour(point - 1));
  }
}

function drawPanel(path) {
  const g = clear(path.canvas), see = camera(path.canvas), frame = row(path.t, state.t);
  drawAxes(g, path.canvas, see);
  const bodies = path.bodies.map((body, i) => placed(body, i, frame, see));
  const middle = bodies.reduce((sum, body) => sum + body.depth / bodies.length, 0);
  if (bodies.length > 0) drawLayer(g, path, frame, see, depth => depth < middle);
  drawBodies(g, bodies);
  drawLayer(g, path, frame, see, depth => bodies.length === 0 || depth >= middle);
  path.frame = frame;
}

]==] .. require "dm.show.animate.plot_script" .. [==[
// ---- the page ----

function figure(holder, name, kind) {
  const frame = document.createElement("figure"), caption = document.createElement("figcaption");
  const canvas = document.createElement("canvas");
  frame.className = kind;
  caption.textContent = name;
  if (name) frame.appendChild(caption);
  frame.appendChild(canvas);
  element(holder).appendChild(frame);
  return canvas;
}

function drawAll() {
  scene.paths.forEach(drawPanel);
  scene.plots.forEach(drawPlot);
  element("time").textContent = "t = " + state.t.toPrecision(5);
  element("scrub").value = last > first ? (state.t - first) / (last - first) : 0;
  document.body.setAttribute("data-frame", scene.paths.map(p => p.frame).join(" "));
}

function go(t) {
  state.t = Math.max(first, Math.min(last, t));
  drawAll();
}

function play(on) {
  state.playing = on;
  element("play").textContent = on ? "pause" : "play";
}

function showSpeed() {
  state.speed = Math.pow(2, Number(element("speed").value));
  const rate = state.speed * (last - first) / seconds;
  element("rate").textContent = rate.toPrecision(3) + " of t a second";
}

let before = null;
function tick(now) {
  if (state.playing && before !== null) {
    let t = state.t + state.speed * (last - first) / seconds * Math.min(0.1, (now - before) / 1000);
    if (t > last) t = first;
    go(t);
  }
  before = now;
  requestAnimationFrame(tick);
}

// drag turns a scene in space, the wheel comes nearer
function watchMouse(canvas) {
  let at = null;
  canvas.addEventListener("pointerdown", e => { at = [e.clientX, e.clientY]; });
  window.addEventListener("pointerup", () => { at = null; });
  window.addEventListener("pointermove", e => {
    if (!at || scene.dim < 3) return;
    state.azimuth += (e.clientX - at[0]) / 120;
    state.height = Math.max(-1.57, Math.min(1.57, state.height + (e.clientY - at[1]) / 120));
    at = [e.clientX, e.clientY];
    drawAll();
  });
  canvas.addEventListener("wheel", e => {
    e.preventDefault();
    state.zoom = Math.max(0.2, Math.min(50, state.zoom * Math.exp(-e.deltaY / 500)));
    drawAll();
  }, { passive: false });
}

function watchKeys(e) {
  const step = (last - first) / 200;
  if (e.key === " ") play(!state.playing);
  else if (e.key === "ArrowRight") { play(false); go(state.t + step); }
  else if (e.key === "ArrowLeft") { play(false); go(state.t - step); }
  else return;
  e.preventDefault();
}

// canvases of paths and plots; those that are there are used again
const canvases = { paths: [], plots: [] };
function canvas(holder, i, name, kind) {
  const all = canvases[holder];
  if (!all[i]) {
    all[i] = figure(holder, name, kind);
    if (kind === "panel") watchMouse(all[i]); else watchPlot(all[i]);
  }
  return all[i];
}

// a click on a plot is a time
function watchPlot(canvas) {
  canvas.addEventListener("pointerdown", e => {
    const inside = (e.offsetX - LEFT) / (canvas.clientWidth - LEFT - 10);
    play(false);
    go(first + inside * (last - first));
  });
}

function show(data) {
  load(data);
  scene.paths.forEach((path, i) => { path.canvas = canvas("paths", i, path.name, "panel"); });
  scene.plots.forEach((plot, i) => {
    plot.canvas = canvas("plots", i, "", "plot");
    plot.range = range(plot);
  });
  element("trail").value = last > first ? Math.min(1, state.trail / (last - first)) : 0;
  showSpeed();
  drawAll();
}

function open(data) {
  show(data);
  element("play").addEventListener("click", () => play(!state.playing));
  element("scrub").addEventListener("input", e => {
    play(false);
    go(first + Number(e.target.value) * (last - first));
  });
  element("speed").addEventListener("input", showSpeed);
  element("trail").addEventListener("input", e => {
    state.trail = Number(e.target.value) * (last - first);
    drawAll();
  });
  window.addEventListener("keydown", watchKeys);
  window.addEventListener("resize", drawAll);
  const asked = /^#t=(.+)$/.exec(window.location.hash);
  play(!asked);
  go(asked && isFinite(Number(asked[1])) ? Number(asked[1]) : first);
  requestAnimationFrame(tick);
}
]==]
return (text:gsub("@COLOURS@", '"' .. table.concat(palette.LINES, '", "') .. '"'))
