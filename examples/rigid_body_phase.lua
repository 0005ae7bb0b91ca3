-- By what angle has a free body turned about its momentum, step by step? The turn of the run splits exactly into a dynamic part
-- and minus the area that the body momentum has gone around (Leok 4.1, 4.8): not after a period alone, but at every row.
local dm = require "dm"
local sin, pi, abs, atan, cos = math.sin, math.pi, math.abs, math.atan, math.cos
local picture = (arg and arg[1] or ".") .. "/rigid_body_phase.png"

local G, T = dm.SO(3), 15.22285740158978 -- the period of the body momentum, by elliptic functions
local function run(n, periods)
  local body = dm.lagrange_poincare { group = G, h = T / n, name = "free body", l = function(f, h)
    local w = G:cayleyinv(f) / h
    return h * (w[1] ^ 2 + 1.6 * w[2] ^ 2 + 2.5 * w[3] ^ 2) / 2
  end }
  return body:solver():run { mu = { 0.5, 0.4, 1.2 }, steps = n * periods }
end

-- the sum is exact for the discrete run, whatever the step is
local coarse, fine = run(50, 1):phases(), run(400, 1):phases()
for _, p in ipairs { coarse, fine } do
  local last = #p.total
  local defect = abs(p.total[last] - p.dynamic[last] - p.geometric[last])
  print(("%3d steps: %s; the sum is off by %.0e"):format(last - 1, tostring(p), defect))
  assert(defect < 1e-11, "total = dynamic + geometric")
end
-- Montgomery's formula, of the continuous motion: the error falls by 4 when steps are halved
local errors = {}
for k, n in ipairs { 200, 400 } do
  local p = run(n, 1):phases()
  local off = p.total[n + 1] - 3.140263738475
  errors[k] = abs(atan(sin(off), cos(off)))
end
print(("against Montgomery's angle: %.1e, then %.1e with half the step"):format(errors[1], errors[2]))
assert(abs(errors[1] / errors[2] - 4) < 0.1, "of order 2")

local motion = run(100, 3)
local full, p, t = motion:reconstruct { g = G:exp { 0.3, -0.2, 0.5 } }, motion:phases(), motion.path:column "t"
full.path:animate(picture:gsub("png$", "html"), { title = "a free body and its phases", frames = 300,
  draw = function(R)
    local points = { { 0, 0, 0 } }
    for i = 1, 3 do points[i + 1] = { R[1][i] * (1.4 - 0.3 * i), R[2][i] * (1.4 - 0.3 * i), R[3][i] * (1.4 - 0.3 * i) } end
    return { points = points, rods = { { 1, 2 }, { 1, 3 }, { 1, 4 } } }
  end })
local x, y = {}, {}
for k = 1, #motion do x[k], y[k] = motion.mu[k][1], motion.mu[k][2] end
print("picture  " .. dm.figure { { { x = x, y = y, name = "" }, equal = true, xlabel = "mu1", ylabel = "mu2", title = "body momentum, from above" },
  { { x = t, y = p.total, name = "total" }, { x = t, y = p.dynamic, name = "dynamic" }, { x = t, y = p.geometric, name = "geometric" },
    xlabel = "t", ylabel = "turn about J", title = ("%.1f turns in three periods"):format(p.total[#motion] / (2 * pi)) },
  file = picture, size = { 1100, 480 }, title = "Phases of a free body" })
