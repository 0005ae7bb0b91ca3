-- dm.step: the declared order, measured where it can be, and what is said where it cannot
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local vector = dm.vector

local function system(k)
  return dm.system { Q = dm.R(2), L = function(q, v)
    return v:dot(v) / 2 - k * (q:norm() - 1) ^ 2 / 2 - q[2]
  end }
end
local function pieces(x, d, k)
  local out = {}
  for i = 1, d do out[i] = x[(k - 1) * d + i] end
  return vector(out)
end
-- Gauss with two stages; theta: 1/6 sqrt(3) is the one of order 4
local function gauss(d, theta, order)
  local A = { { 0.25, 0.25 - theta }, { 0.25 + theta, 0.25 } }
  local function flat(stages)
    local out = {}
    for _, stage in ipairs(stages) do
      for i = 1, d do out[#out + 1] = stage[i] end
    end
    return out
  end
  return dm.step { name = "gauss by hand", unknowns = 4 * d, order = order,
    start = function(y, _, m)
      local v, f = m.H_p(y.q, y.p, y.t), -m.H_q(y.q, y.p, y.t)
      return flat { v, f, v, f }
    end,
    equation = function(y, x, h, m)
      local out = {}
      for s = 1, 2 do
        local q, p = y.q, y.p
        for j = 1, 2 do
          q = q + pieces(x, d, 2 * j - 1) * (h * A[s][j])
          p = p + pieces(x, d, 2 * j) * (h * A[s][j])
        end
        local t = y.t + h * (A[s][1] + A[s][2])
        out[#out + 1] = pieces(x, d, 2 * s - 1) - m.H_p(q, p, t)
        out[#out + 1] = pieces(x, d, 2 * s) + m.H_q(q, p, t)
      end
      return flat(out)
    end,
    next = function(y, x, h)
      return { q = y.q + (pieces(x, d, 1) + pieces(x, d, 3)) * (h / 2),
        p = y.p + (pieces(x, d, 2) + pieces(x, d, 4)) * (h / 2) }
    end }
end
local right = math.sqrt(3) / 6

-- the solver after a run of a step, and what its text says of the order
local function said(solver, start)
  start = start or { q = { 1, 0 }, v = { 0, 0.3 } }
  solver:run { q = start.q, v = start.v, p = start.p, steps = 1 }
  return tostring(solver):match "order (.-), h ="
end

---- orders that are had, at all steps: rounding, and oscillations that they do not resolve ----

for _, h in ipairs { 1e-9, 1e-6, 1e-3, 0.1, 1 } do
  local text = said(system(1):solver { rule = gauss(2, right, 4), h = h })
  ok(text:find "^4 %(measured: [34]%.%d%)", ("order 4 at h = %g: %s"):format(h, text))
end
-- a forced spring: at steps of many of its periods the error is that of the stages, where the
-- tangent map of Gauss is near 1 again
local forced = dm.system { Q = dm.R(1), L = function(q, v, t)
  return v[1] ^ 2 / 2 - 5e9 * (q[1] - dm.cos(t)) ^ 2
end }
for _, case in ipairs { { 0.1, 1 }, { 0.1, 1.1 }, { 0.3, 1 }, { 1, 1 } } do
  local text = said(forced:solver { rule = gauss(1, right, 4), h = case[1] },
    { q = { case[2] }, v = { 0 } })
  ok(text:find "^4 %(measured: [34]", "shorter steps tell more than the order of stages: " .. text)
end
local stiff = said(system(1e8):solver { rule = gauss(2, right, 4), h = 0.01 })
ok(stiff:find "^4 %(measured: [34]", "a spring of 1e4 that the step does not resolve: " .. stiff)
ok(said(system(1e4):solver { rule = gauss(2, right, 4), h = 0.01 }):find "measured: [34]",
  "a stiff spring at a step that resolves it")
local solver = system(1):solver { rule = gauss(2, right, 4), h = 0.1 }
ok(tostring(solver):find "declared, to be measured in the first run", "what is said before")

---- and those that are not ----

for _, h in ipairs { 1e-9, 1e-6, 1e-3, 0.1, 1 } do
  raises("declares order 4, and from this start it has order", said,
    system(1):solver { rule = gauss(2, 0.2, 4), h = h })
end
raises("it has order 2.0", said, system(1e4):solver { rule = gauss(2, 0.2, 4), h = 0.01 })
ok(said(system(1):solver { rule = gauss(2, 0.2, 2), h = 0.1 }):find "^2 %(measured: ",
  "as it is, it is taken")
-- at rest at the top nothing moves: starts near it tell
local top = { q = { 0, -1 - 1 }, v = { 0, 0 } }
raises("declares order 4", said, system(1):solver { rule = gauss(2, 0.2, 4), h = 0.1 }, top)
local wrong = system(1):solver { rule = gauss(2, 0.2, 4), h = 0.1 }
raises("declares order 4", wrong.ensemble, wrong, { members = 2, steps = 1,
  q = function(i) return { i, 0 } end, v = function() return { 0, 0.3 } end })

-- where runs pass a place at which V is not smooth nothing is refused
local kink = dm.system { Q = dm.R(1), L = function(q, v)
  return v[1] ^ 2 / 2 - q[1] ^ 4 - dm.where(q[1], 0, 30 * q[1])
end }
for _, x in ipairs { 0, 0.0437, -0.0437, 0.13 } do
  local text = said(kink:solver { rule = gauss(1, right, 4), h = 0.1 }, { q = { x }, v = { -1 } })
  ok(text:find "^4", "a start at a kink refuses nothing: " .. text)
end

-- free motion is exact, whatever the rule
local free = dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end }
ok(said(free:solver { rule = gauss(2, 0.2, 4), h = 0.1 }):find "not measured: .*round%-off",
  "where all ends are exact it is said that nothing was measured")

---- on a group, where a start is an element ----

local G = dm.SO(3)
local heavy = dm.system { Q = G, L = function(R, w)
  return (w[1] ^ 2 + 1.2 * w[2] ^ 2 + 0.6 * w[3] ^ 2) / 2 - R[3][3]
end }
local function euler(order)
  return dm.step { unknowns = 3, order = order,
    start = function(y, h, m) return m.H_p(y.q, y.p, y.t) * h end,
    equation = function(y, x, h, m) return x - m.H_p(y.q, y.p, y.t) * h end,
    next = function(y, x, h, m)
      return { q = y.q * G:exp(x), p = G:coAd(G:exp(-x), y.p - m.H_q(y.q, y.p, y.t) * h) }
    end }
end
local tilt = { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } }
for _, h in ipairs { 1e-6, 0.1 } do
  raises("declares order 4, and from this start it has order", said,
    heavy:solver { rule = euler(4), h = h }, tilt)
end
ok(said(heavy:solver { rule = euler(1), h = 0.1 }, tilt):find "^1 %(measured: ", "order 1 as it says")
raises("declares order 2", said, heavy:solver { rule = euler(2), h = 0.1 },
  { q = G:identity(), p = { 0, 0, 1.5 } })

tap.done()
