-- Does it matter how a top is written down? A heavy top of 15 kg, spun at 150 rad/s about the axis to its pivot (Hante 2018, after
-- Bruels, Cardona and Arnold 2012): as rotations about the pivot on SO(3), as a body on SO(3) x R^3 or on SE(3) whose pivot is held
-- by a constraint. The discrete equations differ, their motion converges to one, at order 2 by lie(1) and 4 by lie(2).
local dm = require "dm"
local log = math.log
local picture = (arg and arg[1] or ".") .. "/hante_top.png"

local m, I, g, X = 15, { 0.234375, 0.46875, 0.234375 }, 9.81, dm.vector { 0, 1, 0 }
local G, E = dm.SO(3), dm.SE(3)
local W = dm.vector { 0, 150, -4.61538 }
local function turning(w) return (I[1] * w[1] ^ 2 + I[2] * w[2] ^ 2 + I[3] * w[3] ^ 2) / 2 end
local V = W:cross(X)

local forms = {
  { name = "SO(3)", q = G:identity(), v = W, place = function(R) return R * X end,
    system = dm.system { Q = G, L = function(R, w)
      local u = w:cross(X)
      return turning(w) + m / 2 * u:dot(u) - m * g * R[3][2]
    end } },
  { name = "SO(3) x R^3", q = { G:identity(), X }, v = { W[1], W[2], W[3], V[1], V[2], V[3] }, place = function(q) return q[2] end,
    system = dm.system { Q = dm.product(G, dm.R(3)), L = function(q, v)
      return turning(v) + m / 2 * (v[4] ^ 2 + v[5] ^ 2 + v[6] ^ 2) - m * g * q[2][3]
    end, constraint = function(q) return q[2] - q[1] * X end } },
  { name = "SE(3)", q = dm.matrix { { 1, 0, 0, 0 }, { 0, 1, 0, 1 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } }, v = { V[1], V[2], V[3], W[1], W[2], W[3] },
    place = function(q) return dm.vector { q[1][4], q[2][4], q[3][4] } end,
    system = dm.system { Q = E, L = function(q, v)
      return turning { v[4], v[5], v[6] } + m / 2 * (v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) - m * g * q[3][4]
    end, constraint = function(q)                              -- the pivot in the axes of the body
      return { q[1][1] * q[1][4] + q[2][1] * q[2][4] + q[3][1] * q[3][4], q[1][2] * q[1][4] + q[2][2] * q[2][4] + q[3][2] * q[3][4] - 1,
        q[1][3] * q[1][4] + q[2][3] * q[2][4] + q[3][3] * q[3][4] }
    end } },
}

local t = 0.25
local function finish(form, rule, n)
  local path = form.system:solver { rule = rule, h = t / n }:run { q = form.q, v = form.v, steps = n, every = n // 64 }
  if form.system.given.constraint then assert(path:worst "constraint" < 1e-12, "the pivot is held") end
  return path, form.place(path.q[#path])
end
local _, exact = finish(forms[1], "gauss(6)", 1024)
local lines = { log = "xy", style = "linespoints", xlabel = "steps a second", ylabel = "error of the place, m", title = "error after 0.25 s" }
for _, row in ipairs { { "lie(1)", 2, 0.1 }, { "lie(2)", 4, 0.25 } } do
  for _, form in ipairs(forms) do
    local ns, errors = { 128, 256, 512 }, {}
    for k, n in ipairs(ns) do
      local _, x = finish(form, row[1], n)
      errors[k] = (x - exact):norm()
      ns[k] = n / t
    end
    local order = log(errors[2] / errors[3], 2)
    print(("%-12s %s: %.1e %.1e %.1e m, order %.2f"):format(form.name, row[1], errors[1], errors[2], errors[3], order))
    assert(math.abs(order - row[2]) < row[3], "order of " .. row[1] .. " on " .. form.name)
    lines[#lines + 1] = { x = ns, y = errors, name = form.name .. ", " .. row[1] }
  end
end
local path = forms[1].system:solver { rule = "lie(2)", h = 1 / 2048 }:run { q = G:identity(), v = W, t = 2 }
assert(path:drift "energy".largest / path:energy()[1] < 1e-7, "its energy stays in a band")
print("picture  " .. dm.figure { { { x = path:column "R12", y = path:column "R32" }, xlabel = "x", ylabel = "z", title = "centre of mass, 2 s" }, lines,
  title = "Hante's heavy top", file = picture })
