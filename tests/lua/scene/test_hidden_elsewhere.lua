-- pulses that no step may jump over, where there is no force in coordinates: in an H, on a group, in constraints, in what rolls. Closed forms.
local tap = require "tap"
local dm = require "dm"
local ok, exp, sqrt, pi, sin, cos = tap.ok, math.exp, math.sqrt, math.pi, math.sin, math.cos

local T, COUNT = 10, 2000

-- answers to the tolerance at times that are no closer to the pulse than six widths, and says by how much it may err
local function delivers(what, options, name, at, w, exact)
  options.until_t, options.tolerance = T, options.tolerance or 1e-4
  local times, worst = {}, 0
  for i = 1, COUNT do
    local t = T * i / COUNT
    if math.abs(t - at) > 6 * w then times[#times + 1] = t end
  end
  local run = dm.scene(options):run { at = times }
  local column = run:column(name)
  for i, t in ipairs(times) do worst = math.max(worst, math.abs(column[i] - exact(t))) end
  ok(worst <= options.tolerance and worst <= run.error_estimate, what, ("%.2g, told %.2g"):format(worst, run.error_estimate))
end
local function pulse(at, w) return function(t) return exp(-((t - at) / w) ^ 2) end end

-- H = I + I^2/2, I = (q^2 + p^2)/2: a turn at the rate 1 + I; the pulse adds to p. It is so short that it is a jump
for _, case in ipairs { { 3.7, 3e-5 }, not tap.watched and { 6.1, 1e-5 } or nil } do
  local at, w, jump = case[1], case[2], 0.4
  local f = pulse(at, w)
  local system = dm.system { Q = dm.R(1), H = function(q, p, t)
    local I = (q[1] ^ 2 + p[1] ^ 2) / 2
    return I + I ^ 2 / 2 - jump / (w * sqrt(pi)) * f(t) * q[1]
  end }
  local function turned(q, p, t)
    local angle = (1 + (q ^ 2 + p ^ 2) / 2) * t
    return q * cos(angle) + p * sin(angle), p * cos(angle) - q * sin(angle)
  end
  -- the pulse itself by the midpoint rule in plain Lua: as a jump it would be off by a part of w
  local q, p = turned(0.8, 0.1, at - 7 * w)
  local M = 4000
  local h = 14 * w / M
  local function slope(x, y, t)
    local rate = 1 + (x ^ 2 + y ^ 2) / 2
    return rate * y, -rate * x + jump / (w * sqrt(pi)) * f(t)
  end
  for k = 0, M - 1 do
    local t = at - 7 * w + k * h
    local x, y = slope(q, p, t)
    x, y = slope(q + h / 2 * x, p + h / 2 * y, t + h / 2)
    q, p = q + h * x, p + h * y
  end
  delivers(("a pulse of width %g in an H"):format(w), { system, q = { 0.8 }, p = { 0.1 }, watch = { "q1" }, tolerance = 1e-3 }, "q1", at, 7 * w / 6, function(t)
    if t < at then return (turned(0.8, 0.1, t)) end
    return (turned(q, p, t - at - 7 * w))
  end)
end

-- a body that turns about an axis of its own, and is pushed about it; so in a product, and where H is given
local G = dm.SO(3)
local at, w, jump = 4.3, 2e-4, 0.6
local f = pulse(at, w)
local function push(t) return jump / (w * sqrt(pi)) * f(t) end
local function angle(t) return 0.3 * t + jump * math.max(0, t - at) end
delivers("on SO(3)", { dm.system { Q = G, L = function(_, xi) return xi:dot(xi) / 2 end, force = function(_, _, t) return { 0, 0, push(t) } end },
  q = G:identity(), v = { 0, 0, 0.3 }, watch = { "R12" } }, "R12", at, w, function(t) return -sin(angle(t)) end)
delivers("on SO(3) x R", { dm.system { Q = dm.product(G, dm.R(1)), L = function(q, v, t) return v:dot(v) / 2 + push(t) * q[2][1] end },
  q = { G:identity(), { 0 } }, v = { 0.1, 0, 0, 0.3 }, watch = { x = function(q) return q[2][1] end } }, "x", at, w, angle)

-- q1 is moved, and pulls q2: q2'' = q1
delivers("in a constraint", { dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + q[1] * q[2] end, constraint = function(q, t) return q[1] - push(t) end },
  q = { 0, 0 }, v = { 0, 0.3 }, watch = { "q2" } }, "q2", at, w, angle)

-- y' = b(t) x': the speed stays, of which b/sqrt(1 + b^2) goes across
local B, speed, across = 3, 1, 0
for i = -600, 600 do
  local b = B * exp(-(i / 100) ^ 2)
  across = across + speed * w * b / sqrt(1 + b ^ 2) / 100
end
delivers("in what rolls", { dm.system { Q = dm.R(2), L = function(_, v) return v:dot(v) / 2 end, rolling = function(_, v, t) return v[2] - B * f(t) * v[1] end },
  q = { 0, 0 }, v = { speed, 0 }, watch = { "q2" }, tolerance = 2e-5 }, "q2", at, w, function(t) return t > at and across or 0 end)
tap.done()
