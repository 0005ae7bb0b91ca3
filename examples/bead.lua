-- A bead slides on a spring along a rod that is fixed in a free body: how does it shake the body? The bead's place and the body
-- momentum are all that the reduced equations know (Leok 4.7.1); the attitude comes back by multiplying up f_k = g_k^-1 g_k+1.
local dm = require "dm"
local picture = (arg and arg[1] or ".") .. "/bead.png"

local G = dm.SO(3)
local system = dm.system { name = "bead in a body", Q = dm.product(dm.R(1), G), L = function(q, v)
  local x, u, w = q[1][1], v[1], { v[2], v[3], v[4] }
  return ((1 + x ^ 2) * w[1] ^ 2 + (1.75 + x ^ 2) * w[2] ^ 2 + 2.25 * w[3] ^ 2) / 2 - x / 2 * w[1] * w[3] - u / 2 * w[2] + u ^ 2 / 2 - x ^ 2
end }
local reduced = system:reduce { group = G, rule = "lie(2)", h = 0.05 }
local R0, J = G:exp { 0.3, -0.2, 0.5 }, dm.vector { 0.7, -0.3, 1.1 }
local run = reduced:solver():run { x = 0.4, p = 0.1, g = R0, momentum = J, steps = 1000 }

-- the same steps as without reduction, and the momentum in space to round-off
local full = system:solver { rule = "lie(2)", h = 0.05 }
  :run { q = { { 0.4 }, R0 }, p = { 0.1, table.unpack(G:coAd(G:inverse(R0), J):totable()) }, steps = 1000 }
local back, worst, drift = run:reconstruct { g = R0 }, 0, 0
for k = 1, 1001 do
  worst = math.max(worst, math.abs(full.q[k][1][1] - run.x[k][1]), G:distance(full.q[k][2], back.g[k]))
  drift = math.max(drift, (G:coAd(back.g[k], run.mu[k]) - J):norm())
end
print(("1000 steps: reduced and unreduced differ by %.0e, J moves by %.0e"):format(worst, drift))
assert(worst < 1e-10 and drift < 1e-12, "reduction loses nothing")

-- where it could rest: relative equilibria, with the bead where spring and turn balance
local level = system:routh { group = G, mu = J }
local rests = level:relative_equilibria { x = 0, spread = 0.5, starts = 60 }
for _, e in ipairs(rests) do
  print(("bead at %+.4f, momentum (%.4f, %.4f, %.4f), energy %.6f%s"):format(e.x[1], e.nu[1], e.nu[2], e.nu[3], e.energy, e.stable and ", stable" or ""))
end
local E = system:energy({ { 0.4 }, R0 }, full:velocity(1), 0)
assert(rests[1].stable and rests[1].energy < E, "the run has more energy than the stable motion")

back.path:animate(picture:gsub("png$", "html"), { title = "a bead in a free body", frames = 300, t = { 0, 25 },
  draw = function(q)
    local R, x, points = q[2], q[1][1], {}
    for i, corner in ipairs { { -1, 0, 0 }, { 1, 0, 0 }, { 0, -0.8, 0 }, { 0, 0.8, 0 }, { 0, 0, -0.6 }, { 0, 0, 0.6 }, { x, 0, 0 } } do
      points[i] = { (R * dm.vector(corner))[1], (R * dm.vector(corner))[2], (R * dm.vector(corner))[3] }
    end
    return { points = points, rods = { { 1, 2 }, { 3, 4 }, { 5, 6 } } }
  end })
local t, x, mu = run.path:column "t", {}, { {}, {}, {} }
for k = 1, 1001 do
  x[k] = run.x[k][1]
  for i = 1, 3 do mu[i][k] = run.mu[k][i] end
end
print("picture  " .. dm.figure { { { x = t, y = x, name = "" }, xlabel = "t", ylabel = "x", title = "place of the bead" },
  { { x = t, y = mu[1], name = "mu1" }, { x = t, y = mu[2], name = "mu2" }, { x = t, y = mu[3], name = "mu3" }, xlabel = "t", title = "body momentum" },
  file = picture, size = { 1100, 480 }, title = "A bead in a free body" })
