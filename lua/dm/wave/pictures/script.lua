--- The script of a page on which a wave moves (path:animate of waves), as text: plain JavaScript on
-- a canvas, no library, no network. Every point is a bar as high as the density, coloured by the
-- phase; V stands behind it.
return [==[
"use strict";
const scene = JSON.parse(document.getElementById("data").textContent);
const floats = text =>
  new Float32Array(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
const element = id => document.getElementById(id);
const x = floats(scene.x), t = floats(scene.t), re = floats(scene.re), im = floats(scene.im);
const V = floats(scene.V), count = x.length, frames = t.length;
const canvas = element("picture"), slider = element("scrub");
const state = { frame: 0, playing: true };
slider.max = frames - 1;

function draw() {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  canvas.width = w * ratio;
  canvas.height = h * ratio;
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  const across = at => 40 + (w - 60) * (at - x[0]) / (x[count - 1] - x[0]);
  const floor = h - 30, room = h - 50;
  g.strokeStyle = "#bbbbbb";
  g.beginPath();
  for (let j = 0; j < V.length; j++) g.lineTo(across(x[j]), floor - room * V[j]);
  g.stroke();
  const first = Math.floor(state.frame) * count;
  for (let j = 0; j + 1 < count; j++) {
    const a = re[first + j], b = im[first + j], density = a * a + b * b;
    const hue = 180 + 180 * Math.atan2(b, a) / Math.PI, left = across(x[j]);
    g.fillStyle = "hsl(" + hue.toFixed(0) + ", 75%, 50%)";
    const high = room * density / scene.most;
    g.fillRect(left, floor - high, across(x[j + 1]) - left + 0.5, high);
  }
  g.fillStyle = "#444";
  g.font = "13px sans-serif";
  g.fillText("x = " + x[0].toPrecision(4), 40, h - 10);
  g.fillText(x[count - 1].toPrecision(4), w - 60, h - 10);
  element("time").textContent = "t = " + t[Math.floor(state.frame)].toPrecision(4);
  slider.value = Math.floor(state.frame);
}

function toggle() {
  state.playing = !state.playing;
  element("play").textContent = state.playing ? "pause" : "play";
}
element("play").addEventListener("click", toggle);
slider.addEventListener("input", () => { state.frame = +slider.value; draw(); });
window.addEventListener("resize", draw);
window.addEventListener("keydown", event => {
  if (event.key === " ") { event.preventDefault(); toggle(); }
  const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
  if (by) { state.frame = Math.max(0, Math.min(frames - 1, state.frame + by)); draw(); }
});

let last = null;
function tick(now) {
  if (state.playing && last !== null) {
    state.frame = (state.frame + (now - last) * frames / 12000) % frames;
    draw();
  }
  last = now;
  requestAnimationFrame(tick);
}
const given = /frame=(\d+)/.exec(window.location.hash);
if (given) { state.frame = Math.min(frames - 1, +given[1]); state.playing = false; }
draw();
requestAnimationFrame(tick);
]==]
