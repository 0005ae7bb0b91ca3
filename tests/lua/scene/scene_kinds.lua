-- Kinds of random models for scenes. Lagrangian and accelerations are written side by side, by hand: c[i] is the acceleration of coordinate i in C,
-- of the state y = (q, v) and t; before: C in front of it; start, states: the reference in other coordinates; watched: C of what is watched, in place
-- of y[0]; windows: times between which something is narrow.
local dm = require "dm"
local M = {}

local cos, sin, exp, sqrt, tanh = math.cos, math.sin, math.exp, math.sqrt, dm.tanh

-- a text in which every # is the next number
local function C(text, ...)
  local list, at = { ... }, 0
  return (text:gsub("#", function()
    at = at + 1
    return ("(%.17gL)"):format(list[at])
  end))
end

-- one of a hundred to a millionth
local function tolerance() return 10 ^ -math.random(3, 6) end

---- each: r(a, b) is a random number ----

-- one to three, coupled: forcing, drag, a pulse in t
local function oscillators(r)
  local n = math.random(3)
  local m, w, a, c, f, o = {}, {}, r(0, 1), r(0, 0.4), r(0, 0.4), r(0.5, 3)
  local drag, pulse = math.random(3) == 1 and r(0.01, 0.1) or 0, math.random(2) == 1
  local at, width, push = r(2, 9), 10 ^ r(-4.5, -1.5), pulse and r(0.05, 0.3) or 0
  for i = 1, n do m[i], w[i] = r(0.5, 2), r(0.5, 2) end
  local text, q, v = {}, {}, {}
  for i = 1, n do
    q[i], v[i] = r(-1, 1), r(-0.5, 0.5)
    local near = {}
    if i > 1 then near[#near + 1] = ("y[%d]"):format(i - 2) end
    if i < n then near[#near + 1] = ("y[%d]"):format(i) end
    local x = ("y[%d]"):format(i - 1)
    text[i] = C(("(-#*X - #*X*X*X - #*sinl(X) - #*(%s)%s - #*y[%d])/#"):gsub("X", x):format(#near > 0 and table.concat(near, "+") or "0",
      i == 1 and C("+ #*cosl(#*t) + #*expl(-((t-#)/#)*((t-#)/#))", f, o, push / width, at, width, at, width) or "", n + i - 1), w[i], a, a / 2, c, drag, m[i])
  end
  return { kind = "oscillators", n = n, q = q, v = v, T = 10, c = text, tolerance = tolerance(), windows = pulse and { { at - 8 * width, at + 8 * width } },
    L = function(x, y, t)
      local L = f * cos(o * t) * x[1] + push / width * exp(-((t - at) / width) ^ 2) * x[1]
      for i = 1, n do L = L + m[i] / 2 * y[i] ^ 2 - w[i] / 2 * x[i] ^ 2 - a / 4 * x[i] ^ 4 + a / 2 * cos(x[i]) end
      for i = 1, n - 1 do L = L - c * x[i] * x[i + 1] end
      return L
    end, force = drag > 0 and function(_, y) return -drag * y end or nil }
end

local function passages(r)
  local e, mu, weak = r(0, 0.95), r(0.5, 2), r(0, 0.05)
  return { kind = "close passages", n = 2, q = { -(1 + e), 0 }, v = { 0, -sqrt(mu * (1 - e) / (1 + e)) }, T = r(5, 25), tolerance = tolerance(),
    before = "R d = sqrtl(y[0]*y[0] + y[1]*y[1]);", c = { C("-#*y[0]/(d*d*d) - #*y[0]", mu, weak), C("-#*y[1]/(d*d*d) - #*y[1]", mu, 2 * weak) },
    L = function(q, v) return v:dot(v) / 2 + mu / q:norm() - weak * (q[1] ^ 2 / 2 + q[2] ^ 2) end }
end

-- a constraint: the reference is in the angle
local function rods(r)
  local g, th, om, o = r(1, 10), r(-2, 2), r(-1, 1), r(0, 0.5)
  return { kind = "a rod", n = 2, states = 1, q = { sin(th), -cos(th) }, v = { om * cos(th), om * sin(th) }, start = { th, om }, T = r(3, 10),
    tolerance = tolerance(), c = { C("-#*sinl(y[0]) + #*cosl(t)*cosl(y[0])", g, o) }, watched = "sinl(y[0])",
    constraint = function(q) return q[1] ^ 2 + q[2] ^ 2 - 1 end, L = function(q, v, t) return v:dot(v) / 2 - g * q[2] + o * cos(t) * q[1] end }
end

-- a narrow pulse that is small beside a large force
local function beside(r)
  local g, at, w = r(100, 1000), r(2, 8), 10 ^ r(-4, -1.5)
  local A = r(0.005, 0.08) * g
  return { kind = "a pulse beside a large force", n = 1, q = { 0 }, v = { r(1, 5) }, T = 10, tolerance = 1e-4, windows = { { at - 8 * w, at + 8 * w } },
    c = { C("-# + #*expl(-((t-#)/#)*((t-#)/#))", g, A, at, w, at, w) },
    L = function(q, v, t) return v[1] ^ 2 / 2 - g * q[1] + A * exp(-((t - at) / w) ^ 2) * q[1] end }
end

-- the same in a factor, and inside a function
local function factors(r)
  local k, at, w, b, inside = r(1, 9), r(2, 8), 10 ^ r(-4, -1.5), r(0.02, 0.09), math.random(2) == 1
  local pulse = C("#*expl(-((t-#)/#)*((t-#)/#))", b, at, w, at, w)
  return { kind = inside and "a pulse in an angle" or "a pulse in a factor", n = 1, q = { r(-1, 1) }, v = { r(-1, 1) }, T = 10, tolerance = tolerance(),
    windows = { { at - 8 * w, at + 8 * w } }, c = { inside and C("-#*sinl(y[0] - %s)", k):format(pulse) or C("-#*(1 + %s)*y[0]", k):format(pulse) },
    L = function(q, v, t)
      local p = b * exp(-((t - at) / w) ^ 2)
      return v[1] ^ 2 / 2 + (inside and k * cos(q[1] - p) or -k / 2 * (1 + p) * q[1] ^ 2)
    end }
end

-- two jumps that leave a plateau between them
local function plateaus(r)
  local at, long, w, A, g = r(2, 8), 10 ^ r(-3, -1), 10 ^ r(-4, -2), r(0.01, 2), r(1, 100)
  return { kind = "a plateau", n = 1, q = { r(-1, 1) }, v = { 0 }, T = 10, tolerance = tolerance(), windows = { { at - 20 * w, at + 20 * w },
    { at + long - 20 * w, at + long + 20 * w } }, c = { C("-#*sinl(y[0]) + #*(tanhl((t-#)/#) - tanhl((t-#)/#))", g, A, at, w, at + long, w) },
    L = function(q, v, t) return v[1] ^ 2 / 2 + g * cos(q[1]) + A * (tanh((t - at) / w) - tanh((t - at - long) / w)) * q[1] end }
end

-- a wall in q, also where the motion turns
local function walls(r)
  local w, A = 10 ^ r(-3, -1), r(0.01, 0.6)
  local x = math.random(2) == 1 and 1 + r(-3, 1) * w or r(-1, 1)
  return { kind = "a wall", n = 1, q = { 0.2 }, v = { sqrt(0.96) }, T = 10, tolerance = tolerance(),
    before = C("R d = (y[0] - #)/#;", x, w), c = { C("-y[0] + 2*#*d*expl(-d*d)", A / w) },
    L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 - A * exp(-((q[1] - x) / w) ^ 2) end }
end

-- a pendulum on a stiff spring, more or less excited
local function springs(r)
  local k, th, x = 10 ^ r(2, 5), r(-1, 1), 10 ^ r(-6, -1)
  return { kind = "a stiff spring", n = 2, q = { (1 + x) * sin(th), -(1 + x) * cos(th) }, v = { 0, 0 }, T = r(1, 5), tolerance = tolerance(),
    before = "R d = sqrtl(y[0]*y[0] + y[1]*y[1]);", c = { C("-#*(d-1)*y[0]/d", k), C("-#*(d-1)*y[1]/d - 9.81L", k) },
    L = function(q, v) return v:dot(v) / 2 - k / 2 * (q:norm() - 1) ^ 2 - 9.81 * q[2] end }
end

-- a symmetry that is nearly one: a hill in the plane, whose top amplifies what is not
local function hills(r)
  local s = 10 ^ r(-12, -2)
  return { kind = "a hill", n = 2, q = { 1e-3, 0 }, v = { 0, r(1e-4, 1e-3) }, T = r(4, 9), tolerance = tolerance(), before = "R d = 1 - y[0]*y[0] - y[1]*y[1];",
    c = { "y[0]*d", C("y[1]*(d + #)", s) }, L = function(q, v)
      local square = q:dot(q)
      return v:dot(v) / 2 + square / 2 - square ^ 2 / 4 + s / 2 * q[2] ^ 2
    end }
end

-- modes that exchange their energy slowly, or hardly
local function modes(r)
  local w, c, a = r(0.8, 1.2), 10 ^ r(-6, -1), 10 ^ r(-5, 0)
  local u = w * (1 + 10 ^ r(-6, -1))
  return { kind = "two modes", n = 2, q = { 0, 1 }, v = { 0, 0 }, T = r(10, 60), tolerance = tolerance(),
    c = { C("-#*y[0] - #*y[1] - #*y[0]*y[0]*y[0]", w * w, c, a), C("-#*y[1] - #*y[0] - #*y[1]*y[1]*y[1]", u * u, c, a) },
    L = function(q, v)
      return v:dot(v) / 2 - w * w / 2 * q[1] ^ 2 - u * u / 2 * q[2] ^ 2 - c * q[1] * q[2] - a / 4 * (q[1] ^ 4 + q[2] ^ 4)
    end }
end

-- three scales of time
local function scales(r)
  local a, b, d, c = r(0.5, 2), r(10, 40), r(100, 500), r(0, 1)
  return { kind = "three scales", n = 3, q = { r(-1, 1), r(-1, 1) / b, r(-1, 1) / d }, v = { 0, r(-1, 1), 0 }, T = r(2, 6), tolerance = tolerance(),
    c = { C("-#*y[0] - #*y[1]*y[2]", a * a, c), C("-#*y[1] - #*y[0]*y[2]", b * b, c), C("-#*y[2] - #*y[0]*y[1]", d * d, c) },
    L = function(q, v) return v:dot(v) / 2 - a * a / 2 * q[1] ^ 2 - b * b / 2 * q[2] ^ 2 - d * d / 2 * q[3] ^ 2 - c * q[1] * q[2] * q[3] end }
end

-- friction that is narrow in v, a mass that varies, a bump in a magnetic field
local function clutches(r)
  local d, u, w = r(0.1, 3), r(-0.9, 0.9), 10 ^ r(-2.5, -1)
  return { kind = "a clutch", n = 1, q = { 1 }, v = { 0 }, T = 10, tolerance = tolerance(), before = C("R d = (y[1] - #)/#;", u, w),
    c = { C("-y[0] - #*expl(-d*d)", d) }, L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end,
    force = function(_, v) return { -d * exp(-((v[1] - u) / w) ^ 2) } end }
end

local function pendulums(r)
  local g, c = r(1, 10), r(0.1, 0.9)
  return { kind = "two pendulums", n = 2, q = { r(-1.5, 1.5), r(-1.5, 1.5) }, v = { r(-1, 1), r(-1, 1) }, T = r(3, 6), tolerance = tolerance(),
    before = C("R C = #*cosl(y[0]-y[1]), S = #*sinl(y[0]-y[1]), a = -S*y[3]*y[3] - 2*#*sinl(y[0]), b = S*y[2]*y[2] - #*sinl(y[1]), D = 2 - C*C;", c, c, g, g),
    c = { "(a - C*b)/D", "(2*b - C*a)/D" },
    L = function(q, v) return v[1] ^ 2 + v[2] ^ 2 / 2 + c * v[1] * v[2] * cos(q[1] - q[2]) + g * (2 * cos(q[1]) + cos(q[2])) end }
end

local function bumps(r)
  local A, w, x, y, B = r(0.01, 0.3), 10 ^ r(-2.5, -0.7), r(-0.7, 0.7), r(-0.7, 0.7), r(-2, 2)
  return { kind = "a bump", n = 2, q = { 1, 0 }, v = { r(-0.3, 0.3), r(0.2, 1) }, T = 10, tolerance = tolerance(),
    before = C("R a = y[0]-#, b = y[1]-#, E = 2*#*expl(-(a*a+b*b)/#);", x, y, A / w ^ 2, w ^ 2), c = { C("-y[0] + a*E + #*y[3]", B), C("-y[1] + b*E - #*y[2]", B) },
    L = function(q, v)
      return v:dot(v) / 2 - q:dot(q) / 2 - A * exp(-((q[1] - x) ^ 2 + (q[2] - y) ^ 2) / w ^ 2) + B / 2 * (q[1] * v[2] - q[2] * v[1])
    end }
end

local KINDS = { oscillators, beside, passages, rods, factors, springs, walls, modes, plateaus, hills, oscillators, scales, clutches, pendulums, bumps }

--- `count` models by a seed.
function M.make(count, seed)
  math.randomseed(seed)
  local function r(a, b) return a + (b - a) * math.random() end
  local out = {}
  for k = 1, count do out[k] = KINDS[(k - 1) % #KINDS + 1](r) end
  return out
end

return M
