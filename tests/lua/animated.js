// node animated.js PAGE T ... - opens a page of dm.animate without a browser: canvases that count what is drawn and refuse
// what is not a finite number. Prints, for every T, the frame of each path and the points that the script has for it.
"use strict";
const fs = require("fs"), vm = require("vm");
const page = fs.readFileSync(process.argv[2], "utf8");
const data = /<script type="application\/json" id="data">([^]*?)<\/script>/.exec(page)[1];
const script = /<script>\n([^]*?)<\/script>/.exec(page)[1];
if (/https?:|src=|@import|url\(/.test(page)) throw new Error("the page asks the network");

const drawn = { calls: 0, arcs: 0, lines: 0 };
const context = new Proxy({}, {
  get: (own, name) => name in own ? own[name] : (...all) => {
    drawn.calls++;
    if (name === "arc") drawn.arcs++;
    if (name === "lineTo") drawn.lines++;
    for (const x of all) if (typeof x === "number" && !Number.isFinite(x)) throw new Error(name + " of " + x);
    return { width: 10 };
  },
  set: (own, name, value) => { own[name] = value; return true; },
});
const made = {};
const element = id => ({ id, value: "0", textContent: id === "data" ? data : "", clientWidth: 600, clientHeight: 400, on: {},
  appendChild() {}, setAttribute(name, value) { this[name] = value; }, getContext: () => context,
  addEventListener(name, f) { this.on[name] = f; } });
const body = element("body");
const document = { body, getElementById: id => made[id] || (made[id] = element(id)), createElement: element };
const listeners = {};
const window = { devicePixelRatio: 2, location: { hash: "" }, addEventListener: (name, f) => { listeners[name] = f; } };
let next = null;
const sandbox = { document, window, atob, console, requestAnimationFrame: f => { next = f; } };
vm.createContext(sandbox);
vm.runInContext(script + "\nglobalThis.scene = scene; globalThis.state = state; globalThis.go = go;", sandbox);

for (let now = 0; now < 500; now += 50) next(now); // it plays by itself
if (!(sandbox.state.t > sandbox.scene.paths[0].t[0])) throw new Error("it does not move");
listeners.keydown({ key: " ", preventDefault() {} });
const stood = sandbox.state.t;
next(600);
if (sandbox.state.t !== stood) throw new Error("space does not stop it");
for (const name of ["pointermove", "pointerup", "resize"]) listeners[name]({ clientX: 10, clientY: 10 });
sandbox.state.azimuth += 1;
for (const t of process.argv.slice(3)) {
  sandbox.go(Number(t));
  sandbox.scene.paths.forEach((path, i) => {
    const at = path.frame * path.points * sandbox.scene.dim;
    console.log(i + 1, path.frame + 1, path.t[path.frame], ...path.xyz.slice(at, at + path.points * sandbox.scene.dim));
  });
}
for (const plot of sandbox.scene.plots) {
  for (const line of plot.lines) console.log("plot", plot.name + ":", line.t.length, line.y[0], line.y[line.y.length - 1]);
}
console.log("drawn", drawn.arcs > 0 && drawn.lines > 0 && drawn.calls > 100 ? "yes" : JSON.stringify(drawn));
