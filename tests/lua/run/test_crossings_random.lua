-- random models that move along a curve through a place where constraints cross, and the same without such a place, beside
-- a dip of their rows: masses with zeros on the diagonal, coordinates without any mass, many constraints with a mass that
-- moves, tangent maps. How many runs go over the place without a word, and how many are refused that have none
local tap = require "tap"
local dm = require "dm"

local random = dm.random(11)
local drawn = 0
local function between(a, b)
  drawn = drawn + 1
  return a + (b - a) * random:uniform(drawn, 1)
end
local function list(n, a, b)
  local out = {}
  for i = 1, n do out[i] = between(a, b) end
  return out
end

-- x in [n], each in a unit of its own; all but the first follow it: x_i = a_i x_1 + b_i x_1^2. dip nil: the motion from
-- x_1 = 0 comes to x_1 = 1, where the constraint of the last one vanishes on another branch, too; else it has none
local function model(n, decades, T, dip)
  local a, b, unit, place = list(n, 0.3, 1), list(n, -0.05, 0.05), list(n, -decades, decades), list(n, 0, 0.4)
  for i = 1, n do unit[i] = 10 ^ unit[i] end
  a[1], b[1] = 1, 0
  local function scaled(q)
    local x = {}
    for i = 1, n do x[i] = q[i] / unit[i] end
    return x
  end
  local start = { q = {}, v = {} }
  for i = 1, n do start.q[i], start.v[i] = 0, a[i] * unit[i] end
  return { start = start, system = dm.system { Q = dm.R(n),
    L = function(q, v) return T(scaled(q), scaled(v)) end,
    constraint = function(q)
      local x, g, other = scaled(q), {}, -1
      for i = 2, n do g[i - 1] = x[i] - a[i] * x[1] - b[i] * x[1] ^ 2 end
      for i = 1, n do other = other + place[i] * (x[i] - a[i] - b[i]) end
      other = other + x[1]
      g[n - 1] = g[n - 1] * (dip and other ^ 2 + dip or other)
      return g
    end } }
end

local function regular(n, moving)
  local m, f = list(n, 0.5, 2), list(n, -moving, moving)
  return function(x, v)
    local sum = 0
    for i = 1, n do sum = sum + m[i] * v[i] ^ 2 / 2 * (moving > 0 and 1 + f[i] * dm.sin(x[i]) or 1) end
    return sum
  end
end
local function crossed_masses(moving)
  local m, f = between(0.5, 2), between(-moving, moving)
  return function(x, v) return m * v[1] * v[2] * (moving > 0 and 1 + f * dm.sin(x[1]) or 1) + v[3] ^ 2 / 2 end
end
local function massless(moving)
  local m, f = between(0.5, 2), between(-moving, moving)
  return function(x, v) return m * v[1] ^ 2 * (moving > 0 and 1 + f * dm.sin(x[1]) or 1) / 2 + v[2] ^ 2 / 2 end
end

local function goes(solver, start) return solver:run { q = start.q, v = start.v, steps = start.steps } end
local function tangent(solver, start) return solver:lyapunov { q = start.q, v = start.v, steps = start.steps } end

local all = { "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)", "curve(rk4)" }
local kinds = {
  { "masses with zeros on the diagonal", 12, 3, 1, all, function(i) return crossed_masses(i % 2 * 0.3) end, goes },
  { "a coordinate without mass", 12, 3, 1, all, function(i) return massless(i % 2 * 0.3) end, goes },
  { "20 constraints, a mass that moves", 2, 21, 2, { "midpoint", "gauss(2)", "curve(rk4)" }, function() return regular(21, 0.3) end, goes },
  { "tangent maps", 10, 3, 2, all, function(i) return regular(3, i % 2 * 0.3) end, tangent },
  { "tangent maps by rattle", 10, 3, 2, { "rattle", "yoshida(4, rattle)" }, function() return regular(3, 0) end, tangent },
}
for _, kind in ipairs(kinds) do
  local name, models, n, decades, rules, mass, run = table.unpack(kind)
  local count = { runs = 0, over = 0, otherwise = 0, refused = 0 }
  for i = 1, models do
    for _, dip in ipairs { false, 0.05 } do
      local made = model(n, decades, mass(i), dip or nil)
      for _, rule in ipairs(rules) do
        local h = between(0.02, 0.09)
        made.start.steps = math.ceil(1.9 / h)
        local fine, failure = pcall(function() return run(made.system:solver { rule = rule, h = h }, made.start) end)
        local told = not fine and tostring(failure):find("inside of this step", 1, true)
        count.runs = count.runs + 1
        if dip then count.refused = count.refused + (fine and 0 or 1)
        else count.over, count.otherwise = count.over + (fine and 1 or 0), count.otherwise + (fine and 0 or told and 0 or 1) end
        if fine ~= (dip ~= false) or not fine and not told then print(("# %s: model %d, %s, h = %g: %s"):format(name, i, rule, h, failure)) end
      end
    end
  end
  tap.ok(count.over == 0 and count.otherwise == 0, ("%s: of %d runs none goes over a crossing"):format(name, count.runs), count)
  tap.ok(count.refused == 0, name .. ": none is refused where there is none", count)
end
tap.done()
