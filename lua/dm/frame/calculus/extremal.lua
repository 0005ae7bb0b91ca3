--- The curve of an extremal: E(L) = 0 solved for the highest derivatives of the invariants, stepped
-- together with the frame g = rho^-1, g' = -g R. First-order equations y' = f(y) are those of H =
-- p . f(y), so that any rule of stages steps them.
local core = require "dm.core"
local groups = require "dm.group"
local F = require "dm.frame.calculus.field"
local flats = require "dm.group.flat"
local lists = require "dm.base.lists"
local normal = require "dm.frame.calculus.normal"
local option = require "dm.base.options"
local variation = require "dm.frame.calculus.variation"

local M = {}

local WHERE = "calculus:extremal"

-- the highest derivative of every named invariant in the equations
local function orders_of(C, E)
  local out = {}
  for j = 1, #C.named do out[j] = -1 end
  for _, e in ipairs(E) do
    for _, info in pairs(e:uses()) do
      if info.invariant then out[info.invariant] = math.max(out[info.invariant], info.place - 1) end
    end
  end
  return out
end

-- expressions of the highest derivatives that E = 0 gives
local function solved(C, E, orders)
  local unknowns, n = {}, 0
  for j, m in ipairs(orders) do
    if m < 0 then
      option.fail(WHERE, "L leaves %s free: its equations do not contain it", C.named[j].name)
    end
    n = n + 1
    unknowns[n] = normal.invariant(C, j, m + 1)
  end
  if n ~= #E then
    option.fail(WHERE, "there are %d equations for %d invariants", #E, n)
  end
  local A, B = {}, {}
  for i, e in ipairs(E) do
    A[i], B[i] = {}, {}
    local rest = e
    for j, x in ipairs(unknowns) do
      local v = next(x:uses())
      A[i][j] = F.partial(e, v)
      rest = rest - A[i][j] * x
      for v2 in pairs(A[i][j]:uses()) do
        for _, y in ipairs(unknowns) do
          if next(y:uses()) == v2 then
            option.fail(WHERE, "E(L) is not linear in the highest derivatives: %s", tostring(e))
          end
        end
      end
    end
    B[i][1] = -rest
  end
  local x = normal.solve(A, B)
  if not x then
    option.fail(WHERE, "E(L) = 0 cannot be solved for the highest derivatives: is L degenerate?")
  end
  local out = {}
  for j = 1, n do out[j] = F.reduced(x[j][1]) end
  return out
end

-- the start of every invariant: as many numbers as its equation has orders
local function start_of(C, given, orders)
  if type(given) ~= "table" then
    option.fail(WHERE, "option 'start' must be a table such as { %s = { ... } }", C.named[1].name)
  end
  for name in pairs(given) do C.find(name, WHERE) end
  local out = {}
  for j, row in ipairs(C.named) do
    local list, m = given[row.name], orders[j]
    if type(list) == "number" then list = { list } end
    if list == nil and m == 0 then list = {} end
    if list == nil or lists.count(list) ~= m then
      local words = {}
      for i = 1, m do words[i] = C.word(row.name, i) end
      option.fail(WHERE, "start.%s must have %d number%s, %s (got %s)", row.name, m, m == 1 and ""
        or "s",
        table.concat(words, ", "), lists.got(list))
    end
    for i = 1, m do
      if type(list[i]) ~= "number" or not (math.abs(list[i]) < math.huge) then
        option.fail(WHERE, "start.%s[%d] must be a finite number", row.name, i)
      end
      out[#out + 1] = list[i]
    end
  end
  return out
end

-- values of all variables in formulas of the invariants, from y: D^k kappa_j is y[first[j] + k]
local function reader(C, first, orders, tops)
  return function(y)
    local known = {}
    local function at(_, info)
      local j, place = info.invariant, info.place
      local key = j * 1000 + place
      if not known[key] then
        if place <= orders[j] then
          known[key] = y[first[j] + place]
        elseif place == orders[j] + 1 then
          known[key] = F.map(tops[j], at)
        else
          error("an extremal's frame needs derivatives beyond its equations", 0)
        end
      end
      return known[key]
    end
    return at
  end
end

-- d/ds of the flat coordinates of g = rho^-1: g near(-e R), by e; coordinates without a branch
local function frame_rate(kit, place, width)
  local r = kit.dimension
  local slope = core.derivative(function(e, y)
    return core.vector(place.carry(y, place.near(e)))
  end, r, width)
  return function(y, R)
    local J, out = slope(core.zeros(r), y), {}
    for i = 1, width do
      out[i] = 0
      for a = 1, r do out[i] = out[i] - J[i][a] * R[a] end
    end
    return out
  end
end

-- R^a and the normalized point, which may need one derivative more than the state has
local function right_side(C, orders, tops, first, m, kit, place, width)
  local read, rate = reader(C, first, orders, tops), frame_rate(kit, place, width)
  local R = {}
  for a = 1, C.r do R[a] = normal.rate(C, 1, a) end
  return function(y)
    local at, out, turn = read(y), {}, {}
    for j in ipairs(C.named) do
      for k = 1, orders[j] do
        out[first[j] + k] = k < orders[j] and y[first[j] + k + 1] or F.map(tops[j], at)
      end
    end
    for a = 1, C.r do turn[a] = F.map(R[a], at) end
    local g = {}
    for i = 1, width do g[i] = y[m + i] end
    for i, x in ipairs(rate(core.vector(g), turn)) do out[m + i] = x end
    return out
  end, read
end

local KNOWN = { "L", "start", "frame", "length", "steps", "rule" }

local function check(C, o)
  option.check(o, KNOWN, WHERE, "{ L =, start =, length =, steps = }")
  if C.p ~= 1 then option.fail(WHERE, "is for curves, not for %d independent variables", C.p) end
  option.need(o, "L", WHERE, "a function of the invariants")
  option.need(o, "start", WHERE, "the invariants at the start, { kappa = { kappa, kappa_s } }")
  option.need(o, "length", WHERE, "how far the curve goes, a number > 0")
  return option.positive(o, "length", WHERE, "how far the curve goes, a number"),
    option.whole(o, "steps", WHERE, 1, nil, 100)
end

-- rows of the run as points, invariants and elements
local function curve_of(C, path, data)
  local points, frames, columns = {}, {}, {}
  for j, row in ipairs(C.named) do columns[row.name] = j end
  local values = {}
  for name in pairs(columns) do values[name] = {} end
  for k = 1, #path do
    local y = path.q[k]
    local at, g = data.read(y), {}
    for i = 1, data.width do g[i] = y[data.m + i] end
    local element = data.place.element(data.place.tidy(g))
    local z = {}
    for i = 1, C.n do
      local e = normal.entry(C, i)
      z[i] = F.map(e, at) + 0.0
    end
    local point = C.action.map(element, core.vector(z))
    points[k], frames[k] = core.vector(point):totable(), element
    for name, j in pairs(columns) do
      values[name][k] = at(nil, { invariant = j, place = 1 })
    end
  end
  local out = { points = core.matrix(points), frame = frames, path = path, s = path:column "t" }
  for name, list in pairs(values) do out[name] = core.vector(list) end
  return out
end

--- calculus:extremal{...}: see init.lua.
function M.run(C, L_of, o)
  local length, steps = check(C, o)
  local E = variation.euler_lagrange(C, L_of(C, o.L))
  local orders = orders_of(C, E)
  local tops, first, m = solved(C, E, orders), {}, 0
  for j in ipairs(C.named) do first[j], m = m, m + orders[j] end
  local start = start_of(C, o.start, orders)
  local kit = groups.kit(C.action.group)
  local g = o.frame == nil and kit.identity() or groups.element(C.action.group, o.frame)
  local place = flats.of(kit)
  local flat = place.flat(g)
  for i = 1, #flat do start[m + i] = flat[i] end
  local f, read = right_side(C, orders, tops, first, m, kit, place, #flat)
  local n = #start
  local system = core.system { Q = core.R(n), H = function(y, p)
    local sum = 0
    for i, x in ipairs(f(y)) do sum = sum + p[i] * x end
    return sum
  end, name = "extremal" }
  local path = system:solver { rule = o.rule or "gauss(4)", h = length / steps }
    :run { q = start, p = core.zeros(n), steps = steps }
  return curve_of(C, path, { read = read, m = m, width = #flat, place = place })
end

return M
