-- What changes in the params of a system after system:routh changes in the shape, whatever members
-- vary; the other road is the unreduced system with these params, by the same rule.
local dm = require "dm"
local tap = require "tap"
local ok, near = tap.ok, tap.near

-- a planar spring with drag along r; theta is cyclic. `bend` is a table
local function spring(own)
  local params = { k = 1, c = 0.1, bend = { 0.5 } }
  for name, value in pairs(own or {}) do params[name] = value end
  return dm.system { Q = dm.R(2), coordinates = { "theta", "r" }, params = params,
    L = function(q, v, _, p)
      return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 - p.k * q[2] ^ 2 / 2 - p.bend[1] * q[2] ^ 4
    end,
    force = function(_, v, _, p) return { 0, -p.c * v[2] } end }
end
-- without a force, r' and theta' apart: kicks and drifts have parameters as inputs
local function free(own)
  local params = { k = 1, m = 2 }
  for name, value in pairs(own or {}) do params[name] = value end
  return dm.system { Q = dm.R(2), coordinates = { "theta", "r" }, params = params,
    L = function(q, v, _, p)
      return (p.m * v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 - p.k * q[2] ^ 2
    end }
end
-- the same in the plane, reduced by its rotations
local function plane(own)
  local params = { k = 1, m = 2 }
  for name, value in pairs(own or {}) do params[name] = value end
  return dm.system { Q = dm.R(2), params = params, L = function(q, v, _, p)
    return p.m * v:dot(v) / 2 - p.k * q:dot(q)
  end }
end
local TURN = { action = function(a, q)
  return { math.cos(a) * q[1] - math.sin(a) * q[2], math.sin(a) * q[1] + math.cos(a) * q[2] }
end, section = function(x) return { x[1], 0 } end, mu = 0.7 }

local STEPS = 30
-- r at the end, with theta' = mu/r^2 at the start (mu/(m r^2) in the plane), by the unreduced system
local function by_hand(make, own, mu, rule)
  local system = make(own)
  local start = make == plane and { q = { 1, 0 }, v = { 0.1, mu / (own.m or 2) } }
    or { q = { 0, 1 }, v = { mu, 0.1 } }
  start.steps = STEPS
  local path = system:solver { rule = rule, h = 0.05 }:run(start)
  local q = path.q[STEPS + 1]
  return make == plane and q:norm() or q[2]
end

local function members(shape, rule, vary)
  return shape:solver { rule = rule, h = 0.05 }:ensemble { members = 3, steps = STEPS,
    q = function() return { 1 } end, v = function() return { 0.1 } end, vary = vary }
end

-- the members' r against that of the unreduced system with the values set, and varied
local function compare(what, shape, case, set, vary)
  local e, worst = members(shape, case.rule, vary), 0
  for i = 1, 3 do
    local own, mu = {}, shape.params.mu
    for name, value in pairs(set) do own[name] = value end
    for name, values in pairs(vary or {}) do
      if name == "mu" then mu = values[i] else own[name] = values[i] end
    end
    worst = math.max(worst, math.abs(e.q[i][1] - by_hand(case.make, own, mu, case.hand or case.rule)))
  end
  near(worst, 0, case.bar or 1e-13, what)
end

-- kicks and drifts do not step the unreduced system, and gauss(5) in the plane is another rule than
-- on r: there the bar is that of the step, far below what params do
for _, case in ipairs {
  { name = "a force", make = spring, rule = "gauss(2)", reduce = { cyclic = { "theta" }, mu = 0.7 } },
  { name = "kicks and drifts", make = free, rule = "blanes-moan(6)", hand = "gauss(4)", bar = 1e-7,
    reduce = { cyclic = { "theta" }, mu = 0.7 } },
  { name = "an action", make = plane, rule = "gauss(5)", bar = 1e-8, reduce = TURN },
} do
  for _, where in ipairs { "system", "raw table", "shape", "both" } do
    local system = case.make()
    local raw = system.given.params
    local shape = system:routh(case.reduce)
    if where == "system" then system.params.k = 2 end
    if where == "raw table" then raw.k = 2 end
    if where == "both" then system.params.k = 3 end
    if where == "shape" or where == "both" then shape.params.k = 2 end
    local what = case.name .. ", k set in " .. where .. ": "
    compare(what .. "all alike", shape, case, { k = 2 })
    compare(what .. "members vary mu", shape, case, { k = 2 }, { mu = { 0.5, 0.6, 0.7 } })
    -- one of them has the k that was there at the reduction
    compare(what .. "members vary k", shape, case, {}, { k = { 1, 0.6, 2 } })
    ok(shape.params.k == 2 and shape.params.mu == 0.7, what .. "params of the shape")
    shape.params.mu = 0.6
    compare(what .. "mu set in the shape, too", shape, case, { k = 2 })
  end
end

-- what is no number: a table among the params, replaced in the system or in the shape
for _, where in ipairs { "system", "shape" } do
  local system = spring()
  local shape = system:routh { cyclic = { "theta" }, mu = 0.7 }
  local case = { make = spring, rule = "gauss(2)" }
  compare("before", shape, case, {}, { mu = { 0.5, 0.6, 0.7 } })
  local holder = where == "system" and system or shape
  holder.params.bend = { 0.9 }
  near(shape:amended_potential { 1 }, 0.5 + 0.9 + 0.7 ^ 2 / 2, 1e-15, "bend in the potential, " .. where)
  compare("bend, " .. where, shape, case, { bend = { 0.9 } })
  compare("bend and k, " .. where, shape, case, { bend = { 0.9 } }, { k = { 1, 2, 3 } })
end

-- a term that L does not have at the points that were looked at: its slope is seen all the same
do
  local system = free { k = 0 }
  local shape = system:routh { cyclic = { "theta" }, mu = 1 }
  near(shape:amended_potential { 2 }, 1 / 8, 1e-15, "no spring")
  system.params.k = 1
  near(shape:amended_potential { 2 }, 4 + 1 / 8, 1e-15, "a spring")
  near(shape:lift({ 2 }, { 0 })[1], 0, 0, "theta")
end

-- a shape of a shape, and another momentum of it
do
  local params = { k = 1 }
  local system = dm.system { Q = dm.R(3), coordinates = { "a", "b", "r" }, params = params,
    L = function(q, v, _, p)
      return (v[3] ^ 2 + q[3] ^ 2 * v[1] ^ 2 + v[2] ^ 2 * q[3] ^ 4) / 2 - p.k * q[3] ^ 2
    end }
  local outer = system:routh { cyclic = { "a" }, mu = 1 }
  local inner = outer:routh { cyclic = { "b" }, mu = 2 }
  local other = inner:at_momentum(3)
  params.k = 5
  near(inner:amended_potential { 1 }, 5 + 1 / 2 + 2, 1e-14, "a shape of a shape")
  near(other:amended_potential { 1 }, 5 + 1 / 2 + 4.5, 1e-14, "at another momentum")
  ok(inner.params.k == 5 and outer.params.k == 5, "params of both")
end

-- params of the shape that a script holds on to
do
  local system = spring()
  local shape = system:routh { cyclic = { "theta" }, mu = 0.7 }
  local held = shape.params
  system.params.k = 2
  ok(held.k == 2, "what is held is of now", held.k)
  system.params.k = 3
  held.k = 2 -- which is what the shape had before
  ok(held.k == 2 and shape.params.k == 2, "and a value that is set there is its own", held.k)
  near(shape:amended_potential { 1 }, 1 + 0.5 + 0.7 ^ 2 / 2, 1e-15, "in the potential, too")
  system.params.c = 7
  local text, listed = dm.pretty(held), {}
  for name, value in pairs(held) do listed[name] = value end
  ok(text:find("c = 7", 1, true) and listed.c == 7 and listed.mu == 0.7, "shown and listed", text)
  ok(dm.system { Q = dm.R(1), params = held, L = function(_, v, _, p)
    return p.k * v[1] ^ 2
  end }.params == held, "given to another system")
  local fine, why = pcall(function() held.mu = {} end)
  ok(not fine and not why:find("lua/dm", 1, true) and why:find("a number, got table", 1, true),
    "a table for a momentum", why)
end

-- the reason of a failure names the coordinate where params of the shape were set
do
  local shape = free():routh { cyclic = { "theta" }, mu = 0.7 }
  local function why(mu)
    shape.params.mu = mu
    local fine, failure = pcall(function()
      return shape:solver { rule = "gauss(1)", h = 0.5 }:run { q = { 0.2 }, v = { -40 }, steps = 50 }
    end)
    return not fine and type(failure) == "table" and failure.reason, tostring(failure)
  end
  local first, text = why(0.7)
  local later, other = why(0.1)
  ok(first == "pole" or first == "collapse", "the run over the pole fails", text)
  ok(later == first and other:find("'?r'?") ~= nil, "with the same reason at another momentum", other)
end
tap.done()
