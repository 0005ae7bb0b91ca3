-- Functions of the user give one value: a second one is not dropped in silence, whatever option the
-- function is given for.
local tap = require "tap"
local dm = require "dm"

local R2 = dm.R(2)
local function free(_, v) return v:dot(v) / 2 end
local function system(o)
  local all = { Q = R2, L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }
  for key, value in pairs(o or {}) do all[key] = value end
  return dm.system(all)
end
local plane = system()
local verlet = plane:solver { rule = "verlet", h = 0.1 }
local function run(o)
  o.q, o.v, o.steps = { 1, 0 }, { 0, 1 }, 4
  return verlet:run(o)
end
local function ensemble(o)
  local all = { members = 2, steps = 3, q = { { 1, 0 }, { 2, 0 } }, v = { { 0, 1 }, { 0, 2 } } }
  for key, value in pairs(o) do all[key] = value end
  return verlet:ensemble(all)
end
local function pair(o)
  local all = { Q = R2, h = 0.1, Ld = function(a, b, h) return (b - a):dot(b - a) / (2 * h) end }
  for key, value in pairs(o) do all[key] = value end
  return dm.solver { dm.discrete_lagrangian(all) }:run { q0 = { 1, 0 }, q1 = { 1, 0.1 }, steps = 2 }
end
local turn = dm.action { group = dm.SO(2), on = R2 }
local function frame(o)
  local all = { action = turn, cross_section = function(z) return z[2] end,
    branch = function(z) return z[1] end }
  for key, value in pairs(o) do all[key] = value end
  return dm.moving_frame(all):invariants { { 0.6, 0.8 } }
end
local function root(o)
  local all = { equations = function(y, x) return y ^ 3 + y - x end, start = function(x) return x end }
  for key, value in pairs(o) do all[key] = value end
  return dm.root(all)(2)
end
local function sequence(o)
  local all = { equation = function(y, x) return { x[1] ^ 3 + x[1] - y[1] } end,
    next = function(y, x) return { y[1] + x[1] } end, start = function(y) return { y[1] } end,
    y = { 1 }, unknowns = 1, steps = 3 }
  for key, value in pairs(o) do all[key] = value end
  return dm.sequence(all)
end

-- option -> { the function that is right there, what is made with it }
local takes = {
  ["system L"] = { free, function(f) return system { L = f } end },
  ["system constraint"] = { function(q) return q:dot(q) - 1 end,
    function(f) return system { constraint = f }:constraint { 1, 0 } end },
  ["system rolling"] = { function(_, v) return v[1] - v[2] end,
    function(f) return system { rolling = f }:rolling({ 1, 0 }, { 1, 1 }) end },
  ["system force"] = { function(_, v) return { -v[1], -v[2] } end,
    function(f) return system { force = f }:force({ 1, 0 }, { 1, 1 }) end },
  ["system control"] = { function() return { 1 } end, function(f)
    return system { force = function(_, _, _, u) return { u[1], 0 } end, control = f }
      :control({ 1, 0 }, { 1, 1 })
  end },
  ["system reaction"] = { function(q) return { 1 + q[1] ^ 2, -1 } end, function(f)
    return system { rolling = function(_, v) return v[1] - v[2] end, reaction = f }
      :solver({ rule = "midpoint", h = 0.1 }):step { q = { 1, 0 }, v = { 1, 1 } }
  end },
  ["system L with params"] = { function(q, v, _, p) return v:dot(v) / 2 - p.k * q:dot(q) end,
    function(f) return system { L = f, params = { k = 1 } } end },
  ["system L on hyper-dual numbers"] = { function(q, v) return v:dot(v) / 2 - q:dot(q) end,
    function(f) return system { L = f, derivatives = "hyperdual" }:energy({ 1, 0 }, { 1, 1 }) end },
  ["constraint on a sphere"] = { function(q) return q[3] end, function(f)
    return dm.system({ Q = dm.S(2), L = free, constraint = f }):constraint { 1, 0, 0 }
  end },
  ["Ld"] = { function(a, b, h) return (b - a):dot(b - a) / (2 * h) end,
    function(f) return pair { Ld = f } end },
  ["Ld constraint"] = { function(q) return q[1] - 1 end,
    function(f) return pair { constraint = f } end },
  ["watch"] = { function(q) return q[1] end, function(f) return run { watch = { x = f } } end },
  ["record"] = { function(q) return q[1] end, function(f) return run { record = { x = f } } end },
  ["events"] = { function(q) return q[2] end, function(f) return run { events = { z = f } } end },
  ["ensemble q"] = { function(i) return { i, 0 } end, function(f) return ensemble { q = f } end },
  ["ensemble v"] = { function(i) return { 0, i } end, function(f) return ensemble { v = f } end },
  ["ensemble h"] = { function(i) return 0.1 * i end, function(f) return ensemble { h = f } end },
  ["ensemble watch"] = { function(q) return q[1] end,
    function(f) return ensemble { watch = { x = f } } end },
  ["ensemble vary"] = { function(i) return i end, function(f)
    local L = function(q, v, _, p) return v:dot(v) / 2 - p.k * q:dot(q) end
    return system({ L = L, params = { k = 1 } }):solver({ rule = "verlet", h = 0.1 }):ensemble {
      members = 2, steps = 3, q = { { 1, 0 }, { 2, 0 } }, v = { { 0, 1 }, { 0, 2 } }, vary = { k = f } }
  end },
  ["dm.trace"] = { function(x) return x[1] end, function(f) return dm.trace(f, 2) end },
  ["dm.derivative"] = { function(x) return x[1] ^ 2 end,
    function(f) return dm.derivative(f, 2) { 1, 2 } end },
  ["dm.sum_over"] = { function(x) return x ^ 2 end,
    function(f) return dm.sum_over({ 1, 2, 3 }, f) end },
  ["v:map"] = { function(x) return x ^ 2 end, function(f) return dm.vector({ 1, 2 }):map(f) end },
  ["root equations"] = { function(y, x) return y ^ 3 + y - x end,
    function(f) return root { equations = f } end },
  ["root start"] = { function(x) return x end, function(f) return root { start = f } end },
  ["root branch"] = { function(y) return y end, function(f) return root { branch = f } end },
  ["root stationary"] = { function(y, x) return y ^ 2 / 2 - x * y end, function(f)
    return dm.root { stationary = f, start = function(x) return x end }(2)
  end },
  ["sequence equation"] = { function(y, x) return { x[1] ^ 3 + x[1] - y[1] } end,
    function(f) return sequence { equation = f } end },
  ["sequence next"] = { function(y, x) return { y[1] + x[1] } end,
    function(f) return sequence { next = f } end },
  ["sequence start"] = { function(y) return { y[1] } end,
    function(f) return sequence { start = f } end },
  ["sequence inside"] = { function(_, x) return { x[1] } end,
    function(f) return sequence { inside = f } end },
  ["action map"] = { function(s, q)
    return { math.cos(s) * q[1] - math.sin(s) * q[2], math.sin(s) * q[1] + math.cos(s) * q[2] }
  end, function(f) return dm.action { group = dm.SO(2), on = R2, map = f } end },
  ["action domain"] = { function(z) return z:dot(z) end, function(f)
    return dm.action { group = dm.SO(2), on = R2, domain = f }:act(0.3, { 1, 0 })
  end },
  ["frame section"] = { function(z) return z[2] end,
    function(f) return frame { cross_section = f } end },
  ["frame branch"] = { function(z) return z[1] end, function(f) return frame { branch = f } end },
  ["frame solution"] = { function(z) return -math.atan(z[2], z[1]) end,
    function(f) return frame { solution = f } end },
  ["invariantize"] = { function(z) return z[1] end, function(f)
    return dm.moving_frame({ action = turn, cross_section = function(z) return z[2] end,
      branch = function(z) return z[1] end }):invariantize(f) { 0.6, 0.8 }
  end },
  ["invariant"] = { function(z) return z:dot(z) end, function(f) return turn:invariant(f) end },
  ["curve method"] = { function(x, f, h) return x + h * f(x) end,
    function(f) return dm.curve { method = f, order = 1 } end },
  ["path momentum"] = { function(q) return { -q[2], q[1] } end,
    function(f) return run({}):momentum(f) end },
  ["section g"] = { function(q) return q[2] end, function(f)
    return verlet:section { g = f, q = { 1, 0 }, v = { 0, 1 }, t = 7,
      x = "q1", y = "p1" }
  end },
  ["section x"] = { function(q) return q[2] end, function(f)
    return verlet:section { g = function(q) return q[2] end, q = { 1, 0 }, v = { 0, 1 }, t = 7,
      x = f, y = "p1" }
  end },
  ["routh action"] = { function(s, q)
    return { math.cos(s) * q[1] - math.sin(s) * q[2], math.sin(s) * q[1] + math.cos(s) * q[2] }
  end, function(f)
    return plane:routh { action = f, section = function(x) return { x[1], 0 } end, q = { 1, 0 }, v = { 0, 1 } }
  end },
  ["routh section"] = { function(x) return { x[1], 0 } end, function(f)
    return plane:routh { action = function(s, q)
      return { math.cos(s) * q[1] - math.sin(s) * q[2], math.sin(s) * q[1] + math.cos(s) * q[2] }
    end, section = f, q = { 1, 0 }, v = { 0, 1 } }
  end },
  ["stationary term"] = { function(x) return (x[2] - x[1]) ^ 2 + x[1] ^ 2 end, function(f)
    return dm.stationary { term = f, sites = 5, block = 1, window = 2, x = { 0, 0.1, 0.2, 0.3, 1 },
      given = { true, false, false, false, true } }
  end },
}

-- where a list is meant several values are its entries: here one too many
local entries = { ["frame section"] = "has 2 equations", ["frame branch"] = "branch" }

local names = {}
for name in pairs(takes) do names[#names + 1] = name end
table.sort(names)
for _, name in ipairs(names) do
  local right, make = takes[name][1], takes[name][2]
  local fine, why = pcall(make, right)
  tap.ok(fine, name .. ": a function of one value is taken", why)
  fine, why = pcall(make, function(...) return right(...), -7 end)
  local words = entries[name] or "must return one value"
  local told = not fine and tostring(why):find(words, 1, true)
  tap.ok(told, name .. ": a second value raises", fine and "no error" or why)
end
tap.done()
