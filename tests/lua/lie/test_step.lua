-- dm.step: rules from three Lua functions, on R^n and on groups
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local vector, abs, max = dm.vector, math.abs, math.max

local function far(a, b)
  if type(b) == "number" then return abs(a - b) end
  local worst = 0
  for i = 1, #b do worst = max(worst, far(a[i], b[i])) end
  return worst
end
local function finish(system, rule, h, steps, start)
  local path = system:solver { rule = rule, h = h }
    :run { q = start.q, p = start.p, v = start.v, steps = steps, every = steps }
  return path.q[#path], path.p[#path]
end

local G = dm.SO(3)
local one = G:identity()
local function top(I, mgl)
  return dm.system { Q = G, L = function(R, W)
    return (I[1] * W[1] ^ 2 + I[2] * W[2] ^ 2 + I[3] * W[3] ^ 2) / 2 - mgl * R[3][3]
  end }
end
local free, spin = top({ 1, 2, 3 }, 0), { q = one, p = { 0.9, 0.3, 1.2 } }
local heavy, tilt = top({ 1, 1.2, 0.6 }, 1), { q = G:exp { 0.4, 0, 0 }, p = { 0.2, 0.1, 1.5 } }

---- lie(1) of a free body, written by a user ----

local function times_I(x) return vector { x[1], 2 * x[2], 3 * x[3] } end
local options = { name = "by hand", unknowns = 3, order = 2,
  start = function(y, h) return { h * y.p[1], h * y.p[2] / 2, h * y.p[3] / 3 } end,
  equation = function(y, x, h) return G:dexpinv(-x, times_I(x) / h) - y.p end,
  next = function(y, x, h)
    return { q = G:compose(y.q, G:exp(x)), p = G:dexpinv(x, times_I(x) / h) }
  end }
local mine = dm.step(options)
local g, p = finish(free, mine, 0.1, 100, spin)
local R, P = finish(free, "lie(1)", 0.1, 100, spin)
ok(far(g, R) < 1e-13 and far(p, P) < 1e-13, "lie(1) of a free body by hand")
ok(mine.order == 2 and mine.name:find "by hand", "name and order")

-- coordinates of what `next` gives are those of an element, however long: errors of |q| grew by a
-- constant factor a step, as the quaternion of c R has other errors than that of R
for _, Q in ipairs { G, dm.SE(3), dm.product(G, dm.SU(2)) } do
  local d, v = Q.dimension, {}
  for i = 1, d do v[i] = 0.02 * i end
  local drifting = dm.step { unknowns = d, order = 1, start = function(y, h) return y.p * h end,
    equation = function(y, x, h) return x - y.p * h end,
    next = function(y, x)
      local f = Q:exp(x)
      return { q = Q:compose(y.q, f), p = Q:coAd(Q:inverse(f), y.p) }
    end }
  local long = dm.system { Q = Q, L = function(_, x) return x:dot(x) / 2 end }
    :solver { rule = drifting, h = 0.02 }:run { q = Q:identity(), v = v, steps = 4e4, every = 4e4 }
  local J = long:momentum(Q)
  ok((J[2] - J[1]):norm() < 1e-11, "spatial momentum of 40000 own steps on " .. tostring(Q))
  if Q == G then
    local R = long.q[2]
    ok(far(R:transpose() * R, one) < 1e-14, "and R^T R - 1")
  end
end

local solver = free:solver { rule = mine, h = 0.1 }
local path, jump = solver:run { q = one, p = spin.p, steps = 300 }, 0
for c = 2, 5 do
  local x = path:column(path.columns[c])
  for i = 2, #x do jump = max(jump, abs(x[i] - x[i - 1])) end
end
ok(jump < 0.1, "coordinates do not change sign")
local file = os.tmpname()
solver:run { q = one, p = spin.p, steps = 7 }:checkpoint(file)
near(far(dm.resume(file, free, { rule = mine }):run { steps = 3 }.p[4], path.p[11]), 0, 0,
  "a checkpoint")
os.remove(file)
local cloud = solver:ensemble { members = 3, steps = 10, q = function() return one end,
  p = function(i) return { 0.9, 0.3 * i, 1.2 } end }
near(far(cloud.p[1], path.p[11]), 0, 0, "a member of an ensemble")
local half = solver:run { q = one, p = spin.p, steps = 100,
  events = { half = function(r) return r[1][1] - 0.5 end } }
near(half.events[1].q[1][1], 0.5, 1e-14, "an event")

---- functions of the system ----

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local midpoint = dm.step { unknowns = 4, order = 2,
  start = function(y) return { y.q[1], y.q[2], y.p[1], y.p[2] } end,
  equation = function(y, x, h, m)
    local q1, p1 = vector { x[1], x[2] }, vector { x[3], x[4] }
    local q, mu = (y.q + q1) * 0.5, (y.p + p1) * 0.5
    local a, b = q1 - y.q - m.H_p(q, mu, y.t) * h, p1 - y.p + m.H_q(q, mu, y.t) * h
    return { a[1], a[2], b[1], b[2] }
  end,
  next = function(_, x) return { q = { x[1], x[2] }, p = { x[3], x[4] } } end }
local start = { q = { 0.8, 0 }, v = { 0, 1.2 } }
ok(far(finish(kepler, midpoint, 0.05, 100, start),
  finish(kepler, "midpoint", 0.05, 100, start)) < 1e-13, "the midpoint rule by m.H_q and m.H_p")

local euler = dm.step { unknowns = 3, order = 1,
  start = function(y, h, m) return m.H_p(y.q, y.p, y.t) * h end,
  equation = function(y, x, h, m) return x - m.H_p(y.q, y.p, y.t) * h end,
  next = function(y, x, h, m)
    return { q = y.q * G:exp(x), p = G:coAd(G:exp(-x), y.p - m.H_q(y.q, y.p, y.t) * h) }
  end }
near(heavy:solver { rule = euler, h = 0.02 }
  :measured_order { q = tilt.q, p = tilt.p, t = 1 }.order, 1, 0.05,
  "Euler's rule on a group by m, order measured")
near(free:solver { rule = mine, h = 0.1 }
  :measured_order { q = one, p = spin.p, t = 2 }.order, 2, 0.05,
  "the order of a step is measured")

-- members of an ensemble on a group have params of their own: all had those of the system
local function hung(k)
  return dm.system { Q = G, params = { k = k }, L = function(R, W, _, P)
    return (W[1] ^ 2 + 1.2 * W[2] ^ 2 + 0.6 * W[3] ^ 2) / 2 - P.k * R[3][3]
  end }
end
local varied = hung(1):solver { rule = euler, h = 0.05 }:ensemble { members = 3, steps = 20,
  q = function() return tilt.q end, p = function() return tilt.p end, vary = { k = { 1, 2, 5 } } }
for i, k in ipairs { 1, 2, 5 } do
  local _, last = finish(hung(k), euler, 0.05, 20, tilt)
  near(far(varied.p[i], last), 0, 0, ("a member with k = %d on a group"):format(k))
end

---- what a step adds ----

-- 10^5 times 0.1: rounded sums are off by 2e-8
local line = dm.system { Q = dm.R(1), L = function(_, v) return v:dot(v) / 2 end }
local function drift(sums)
  return dm.step { unknowns = 1, order = 2, sums = sums,
    start = function() return { 0 } end, equation = function(y, x, h) return { x[1] - h * y.p[1] } end,
    next = function(y, x)
      if sums then return { q = { x[1] }, p = { 0 } } end
      return { q = { y.q[1] + x[1] }, p = y.p }
    end }
end
local along = line:solver { rule = drift(true), h = 0.1 }:run { q = { 0 }, p = { 1 },
  steps = 100000, every = 50000 }
near(along.q[3][1], 10000, 2e-12, "what a step adds is summed with low-order parts")
local plain = line:solver { rule = drift(false), h = 0.1 }:run { q = { 0 }, p = { 1 },
  steps = 100000, every = 100000 }
ok(math.abs(plain.q[2][1] - 10000) > 1e-9, "as it is not without `sums`")
along:checkpoint(file)
near(dm.resume(file, line, { rule = drift(true) }):run { steps = 50000, every = 50000 }.q[2][1],
  15000, 4e-12, "and a checkpoint has the low-order parts")
os.remove(file)
raises("'sums' must be true or false", dm.step, { unknowns = 1, order = 1, sums = 3,
  start = function() return { 0 } end, equation = function() return { 0 } end, next = function() return {} end })

---- refusals ----

raises("made by dm.step", free.solver, free, { rule = "step", h = 0.1 })
raises("'equation' must be a function", dm.step, { unknowns = 3, order = 2 })
raises("'unknowns'", dm.step, { order = 2 })
local function with(key, value)
  local out = {}
  for k, v in pairs(options) do out[k] = v end
  out[key] = value
  return dm.step(out)
end
raises("table { q =, p = }", finish, free, with("next", function(y) return y.q end), 0.1, 1, spin)
raises("returned 'E', which is neither of q, p, t nor one of 'parts'", finish, free,
  with("next", function(y) return { q = y.q, p = y.p, E = 1 } end), 0.1, 1, spin)
raises("must return", finish, free, with("equation", function() return { 1 } end), 0.1, 1, spin)
raises("breaks condition 1 of 'inside'", finish, free, with("inside", function(_, x)
  return { 0.01 - x[3] }
end), 0.1, 5, spin)

tap.done()
