--- The part of an animated page's script that draws quantities over time.
return [==[
// ---- quantities ----

function range(plot) {
  let lo = Infinity, hi = -Infinity;
  for (const line of plot.lines) {
    for (const y of line.y) {
      lo = Math.min(lo, y);
      hi = Math.max(hi, y);
    }
  }
  return lo < hi ? [lo, hi] : [lo - 1, hi + 1];
}

const LEFT = 78, TOP = 20, BOTTOM = 8;

function digits(y) {
  if (y === 0) return "0";
  return Math.abs(y) < 1e-3 || Math.abs(y) >= 1e5 ? y.toExponential(1) : y.toPrecision(3);
}

// names of the lines without what all of them begin with, cut to the room beside the plot's name
function namesOf(plot, g, room) {
  let names = plot.lines.map(line => line.name);
  const head = (/^.*?: /.exec(names[0]) || [""])[0];
  const shared = names.every(name => name.startsWith(head));
  if (shared) names = names.map(name => name.slice(head.length));
  const width = () => names.reduce((sum, name) => sum + g.measureText(name).width + 14, 0);
  while (width() > room && names.some(name => name.length > 2)) {
    const longest = names.reduce((best, name, i) => name.length > names[best].length ? i : best, 0);
    names[longest] = names[longest].slice(0, -2) + "\u2026";
  }
  return names;
}

function drawPlot(plot) {
  const g = clear(plot.canvas);
  const w = plot.canvas.clientWidth - LEFT - 10, h = plot.canvas.clientHeight - TOP - BOTTOM;
  const [lo, hi] = plot.range;
  const across = t => LEFT + w * (t - first) / (last - first || 1);
  const up = y => TOP + h * (1 - 0.08 - 0.84 * (y - lo) / (hi - lo));
  g.strokeStyle = "#ccc";
  g.strokeRect(LEFT, TOP, w, h);
  g.fillStyle = "#333";
  g.font = "12px sans-serif";
  g.textAlign = "left";
  g.fillText(plot.name, LEFT, 14);
  const names = namesOf(plot, g, w - g.measureText(plot.name).width);
  g.textAlign = "right";
  for (const y of [lo, hi]) g.fillText(digits(y), LEFT - 6, up(y) + 4);
  let right = LEFT + w - 4; // of the names, from the last to the first
  for (let i = plot.lines.length - 1; i >= 0 && plot.lines.length > 1; i--) {
    g.fillStyle = colour(i);
    g.fillText(names[i], right, 14);
    right -= g.measureText(names[i]).width + 14;
  }
  plot.lines.forEach((line, i) => {
    g.strokeStyle = colour(i);
    g.lineWidth = 1.3;
    g.beginPath();
    for (let k = 0; k < line.t.length; k++) {
      const x = across(line.t[k]), y = up(line.y[k]);
      if (k === 0) g.moveTo(x, y); else g.lineTo(x, y);
    }
    g.stroke();
  });
  g.strokeStyle = "#d33";
  g.lineWidth = 1;
  g.beginPath();
  g.moveTo(across(state.t), TOP);
  g.lineTo(across(state.t), TOP + h);
  g.stroke();
}

]==]
