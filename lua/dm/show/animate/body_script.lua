--- The part of the script of an animated page that draws rigid bodies: convex solids, so that the
-- faces that look at the eye hide all others of theirs; bodies from the farthest to the nearest.
return [==[
// ---- bodies ----

// x, y, z of a body turned by the unit quaternion (w, a, b, c) and moved
function carried(pose, x, y, z) {
  const [w, a, b, c, px, py, pz] = pose;
  const s = 2 * (b * z - c * y), t = 2 * (c * x - a * z), u = 2 * (a * y - b * x);
  return [x + w * s + b * u - c * t + px, y + w * t + c * s - a * u + py,
    z + w * u + a * t - b * s + pz];
}

// a body in this frame, in pixels: its vertices, origin, ends of its axes, depth
function placed(body, index, frame, see) {
  const pose = body.poses.subarray(7 * frame, 7 * frame + 7), vertices = [];
  const centre = [0, 0, 0], v = body.vertices;
  for (let i = 0; i < v.length; i += 3) {
    vertices.push(see(...carried(pose, v[i], v[i + 1], v[i + 2])));
    vertices[i / 3].forEach((x, k) => { centre[k] += 3 * x / v.length; });
  }
  const origin = see(pose[4], pose[5], pose[6]);
  const tips = [0, 1, 2].map(k => see(...carried(pose, ...[0, 1, 2].map(i =>
    i === k ? body.reach[k] : 0))));
  return { body, index, vertices, centre, origin, tips, depth: centre[2] };
}

// outward normal of a face in pixels, of length 1
function normalOf(corners, centre) {
  const [p, q, r] = [corners[0], corners[1], corners[2]];
  const last = corners[corners.length - 1];
  const a = r.map((x, k) => x - p[k]), b = last.map((x, k) => x - q[k]);
  if (corners.length === 3) b.splice(0, 3, ...q.map((x, k) => x - p[k]));
  const n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const size = Math.hypot(...n) || 1;
  const out = corners[0].reduce((sum, x, k) =>
    sum + n[k] * (x + corners[1][k] + r[k] - 3 * centre[k]), 0);
  return n.map(x => (out < 0 ? -x : x) / size);
}

// the colour of a body, paler where tinted, brighter where it looks up and left
function shade(index, tint, normal) {
  const text = colour(index), light = 0.5 * normal[2] - 0.5 * normal[1] - 0.25 * normal[0];
  const pale = (tint ? 0.72 : 0.3) + 0.22 * light;
  const part = k => {
    const x = parseInt(text.slice(1 + 2 * k, 3 + 2 * k), 16);
    return Math.round(Math.max(0, Math.min(255, x + (255 - x) * pale)));
  };
  return "rgb(" + [0, 1, 2].map(part).join(",") + ")";
}

function drawFaces(g, placed) {
  const { body, vertices } = placed;
  g.lineWidth = 0.7;
  body.faces.forEach((face, i) => {
    const corners = face.map(k => vertices[k]), normal = normalOf(corners, placed.centre);
    if (normal[2] <= 0) return;
    g.beginPath();
    corners.forEach((at, k) => {
      if (k === 0) g.moveTo(at[0], at[1]); else g.lineTo(at[0], at[1]);
    });
    g.closePath();
    g.fillStyle = g.strokeStyle = shade(placed.index, body.tints[i], normal);
    g.fill();
    g.stroke(); // its own colour closes the seams
  });
}

const AXES = ["#c22", "#292", "#22c"];

// those axes of a body that point towards the eye, or away from it
function drawBodyAxes(g, placed, near) {
  const from = placed.origin;
  g.lineWidth = 2;
  placed.tips.forEach((tip, k) => {
    if ((tip[2] >= from[2]) !== near) return;
    g.strokeStyle = AXES[k];
    g.beginPath();
    // inside the body the axis is hidden: seen from the surface on where it comes to the eye
    const part = near ? 1 / 1.4 : 0;
    g.moveTo(...[0, 1].map(i => from[i] + part * (tip[i] - from[i])));
    g.lineTo(tip[0], tip[1]);
    g.stroke();
  });
}

function drawBodies(g, bodies) {
  const order = bodies.slice().sort((a, b) => a.depth - b.depth);
  for (const one of order) {
    drawBodyAxes(g, one, false);
    drawFaces(g, one);
    drawBodyAxes(g, one, true);
  }
}

]==]
