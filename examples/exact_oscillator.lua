-- Your own discrete Lagrangian: can a rule follow an oscillator exactly, whatever its step?
-- The action of L = (v^2 - w^2 q^2)/2 along the true motion from q0 to q1 is known in closed form,
--   Ld(q0, q1) = w / (2 sin w h) ((q0^2 + q1^2) cos w h - 2 q0 q1)   (Marsden and West 2001),
-- and its discrete Euler-Lagrange equations walk on the true solution. The midpoint Ld is only near it.
local dm = require "dm"
local sin, cos, abs, max = math.sin, math.cos, math.abs, math.max
local picture = (arg and arg[1] or ".") .. "/exact_oscillator.png"

local w, h, steps = 1.5, 1.0, 1000
local start = { q = { 1 }, p = { 0 }, steps = steps }

local exact = dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = function(q0, q1)
  return w / (2 * sin(w * h)) * ((q0:dot(q0) + q1:dot(q1)) * cos(w * h) - 2 * q0:dot(q1))
end }
local midpoint = dm.discrete_lagrangian { Q = dm.R(1), h = h, Ld = function(q0, q1)
  local q, v = (q0 + q1) / 2, (q1 - q0) / h
  return h * (v:dot(v) - w ^ 2 * q:dot(q)) / 2
end }

local function run(Ld, frequency)
  local path = dm.solver { Ld }:run(start)
  local q, worst = path:column "q1", 0
  for i = 1, #path do worst = max(worst, abs(q[i] - cos(frequency * path.t[i]))) end
  return path, worst
end
-- the midpoint rule oscillates too, but with tan(w' h / 2) = w h / 2
local slower = 2 / h * math.atan(w * h / 2)
local a, exact_error = run(exact, w)
local b, midpoint_error = run(midpoint, slower)
print(("exact Ld: off the true motion by %.0e after %d steps of w h = %g"):format(exact_error, steps, w * h))
print(("midpoint Ld: a motion of frequency %.6f, off by %.0e; the true one is %g"):format(slower, midpoint_error, w))
assert(exact_error < 1e-11, "the exact discrete Lagrangian walks on the true solution")
assert(midpoint_error < 1e-11, "the midpoint one on a slower one")

local t, q, ta, qa, qb = {}, {}, {}, {}, {}
for i = 1, 400 do t[i], q[i] = (i - 1) * 0.06, cos(w * (i - 1) * 0.06) end
for i = 1, 24 do ta[i], qa[i], qb[i] = a.t[i], a.q[i][1], b.q[i][1] end
print("picture  " .. dm.plot({ { x = t, y = q, name = "true motion" },
    { x = ta, y = qa, name = "exact Ld", style = "points" }, { x = ta, y = qb, name = "midpoint Ld", style = "points" } },
  { title = "An oscillator at w h = 1.5", xlabel = "t", ylabel = "q", size = { 900, 380 }, file = picture }))
