-- a Lagrangian with sums that itself runs, compares or solves something that has sums: none is taken for another
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local N, n = 40, 20

local function square(x) return x ^ 2 / 2 end
local function cube(x) return dm.sum_over(x, function(y) return y ^ 3 end) end
local function chain(q, v) return dm.sum_over(v, square) - dm.sum_over(q, square) end
local place = {}
for i = 1, n do place[i] = i / 10 end
local inner = dm.system { Q = dm.R(n), L = chain }
local few = 4 -- hyper-dual numbers call L for every pair of coordinates
local slow = dm.system { Q = dm.R(few), L = chain, derivatives = "hyperdual" }
local function run(system, rule, more)
  local options = { q = place, v = place, steps = 3, every = 3 }
  for key, value in pairs(more or {}) do options[key] = value end
  return system:solver({ rule = rule, h = 0.1 }):run(options)
end
local outside = {} -- log(0) is no start
for _, bodies in ipairs { 3, n } do
  outside[bodies] = dm.system { Q = dm.R(bodies), L = function(q, v) return dm.sum_over(v, square) - dm.sum_over(q, math.log) end }
end
local function fails(bodies)
  local q = {}
  for i = 1, bodies do q[i] = i - 1 end
  return pcall(run, outside[bodies], "verlet", { q = q, v = q }) and 1 or 0.5
end

local inside = { -- what is called in the middle of L, and gives a number
  watch = function() return run(inner, "verlet", { watch = { V = cube } }):column("V")[2] end,
  events = function() return run(inner, "verlet", { events = { V = cube } }).q[2][1] end,
  ["a numeric sum"] = function() return cube(dm.vector(place)) end,
  derivative = function() return dm.derivative(cube, n)(place)[1] end,
  ensemble = function()
    return inner:solver({ rule = "verlet", h = 0.1 }):ensemble({ members = 3, q = function() return place end, v = function() return place end, steps = 3,
      watch = { V = cube } }).q[2][1]
  end,
  ["an implicit rule"] = function() return run(inner, "midpoint").q[2][1] end,
  ["hyper-dual numbers"] = function()
    local q = table.move(place, 1, few, 1, {})
    return run(slow, "verlet", { q = q, v = q }).q[2][1]
  end,
  ["a start that is refused, of few bodies"] = function() return fails(3) end,
  ["a start that is refused, of many bodies"] = function() return fails(n) end,
}
local q0, v0 = {}, {}
for i = 1, N do q0[i], v0[i] = math.sin(i), math.cos(i) end
local function outer(factor)
  local system = dm.system { Q = dm.R(N), L = function(q, v)
    local T = dm.sum_over(v, square)
    local k = factor(q) / 10
    local V = dm.sum_over(q, k, function(x, c) return c * x ^ 2 / 2 end) + dm.sum_over(q, function(x) return x ^ 4 / 40 end)
    return T - V - dm.sum_over(q, function(x, y) return (x - y) ^ 2 / 2 end, { shift = 1 })
  end }
  local fine, path = pcall(run, system, "verlet", { q = q0, v = v0 })
  return fine and path.q[2] or path
end
for name, call in pairs(inside) do
  local k = call()
  local got = outer(call)
  ok(got == outer(function() return k end), "around " .. name .. ": the same bits as with its number", got)
end

-- a root in L, of equations with sums, before the sums of L: the same as its closed form
for _, bodies in ipairs { 3, n } do
  local w = {}
  for i = 1, bodies do w[i] = i / 10 end
  local root = dm.root { start = 0.1, equations = function(y, x) return dm.sum_over(w, y, x, function(c, a, b) return c * (a - b) end) end }
  local got, want = outer(function(q) return root(q[1]) end), outer(function(q) return q[1] end)
  ok(type(got) == "userdata" and (got - want):norm() < 1e-13, ("a root of sums over %d bodies"):format(bodies), got)
end
tap.done()
