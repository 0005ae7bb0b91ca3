--- Spaces of curves as rules: dm.galerkin{functions=}, dm.multiscale, dm.filon.
local blame = require "dm.base.blame"
local core = require "dm.core"
local options = require "dm.base.options"

local M = {}

local GALERKIN, MULTISCALE, FILON = "dm.galerkin", "dm.multiscale", "dm.filon"
local MOST_NODES = 8

---- quadratures ----

-- weights given for nodes in [0, 1]
local function own_nodes(given, where)
  options.check(given, { "nodes", "weights", "pieces" }, where, "{ nodes =, weights = }")
  local nodes = options.need(given, "nodes", where, "the nodes of the quadrature, in [0, 1]")
  local weights = options.need(given, "weights", where, "its weights, whose sum is 1")
  local out, sum = { nodes = nodes, weights = weights, text = "own nodes" }, 0
  local c, b = core.quadrature(out)
  for i = 1, #c do
    if not (c[i] >= 0 and c[i] <= 1) then
      options.fail(where, "nodes lie in [0, 1], the step as unit (entry %d is %s)", i, c[i])
    end
    sum = sum + b[i]
  end
  if math.abs(sum - 1) > 1e-12 then
    options.fail(where, "the sum of the weights must be 1, it is %.15g", sum)
  end
  return out
end

-- a name, { nodes =, weights = } or { name, pieces = } as fields of core.trial_rule
local function read_quadrature(given, where)
  if type(given) == "string" then
    local out = { named = given, text = given }
    core.quadrature(out)
    return out
  end
  if type(given) ~= "table" then
    options.fail(where, "a quadrature is missing: quadrature = \"gauss(4)\", { nodes =, weights = }"
      .. " or { \"gauss(4)\", pieces = 5 } (got %s)", options.got(given))
  end
  if given[1] == nil then
    local out = own_nodes(given, where)
    out.pieces = options.whole(given, "pieces", where, 1, 400, 1)
    return out
  end
  options.check(given, { "pieces", entries = true }, where, "{ \"gauss(4)\", pieces = 5 }")
  local out = read_quadrature(given[1], where)
  out.pieces = options.whole(given, "pieces", where, 1, 400, 1)
  if out.pieces > 1 then out.text = ("%d x %s"):format(out.pieces, out.text) end
  return out
end

-- the options of core.trial_rule: a quadrature, and what there is beside it
local function rule(quadrature, more)
  local out = {}
  for key, value in pairs(quadrature) do out[key] = value end
  for key, value in pairs(more) do out[key] = value end
  return core.trial_rule(out)
end

---- dm.galerkin with a space of its own (called by C) ----

-- a list of functions of (t, h), one for every coordinate, or one function for all
local function read_functions(given)
  local f = given.functions
  if type(f) == "function" then return { options.single(f, "functions") }, true end
  local fine = type(f) == "table" and #f > 0
  for _, each in ipairs(fine and f or {}) do fine = fine and type(each) == "function" end
  options.demand(fine, given, "functions", GALERKIN,
    "a function(t, h) that returns a list { f1, f2, ... }, or a list of such functions")
  local out = {}
  for i, each in ipairs(f) do out[i] = options.single(each, ("functions[%d]"):format(i)) end
  return out, false
end

-- how many functions of a space there are
local function count_of(f)
  local fine, list = blame.try(f, 0.5, 1)
  if not fine then error(list, 0) end
  if type(list) ~= "table" or #list == 0 then
    options.fail(GALERKIN, "'functions' must return a list { f1, f2, ... } (got %s)",
      options.got(list))
  end
  if #list < 2 then
    options.fail(GALERKIN, "a space of one function cannot meet both ends of a step: two are "
      .. "needed at least")
  end
  return #list
end

local function of_functions(given, quadrature)
  local functions, same = read_functions(given)
  local counts, total = {}, 0
  for i, f in ipairs(functions) do
    counts[i] = count_of(f)
    total = total + counts[i]
  end
  return rule(quadrature, { kind = "functions", functions = functions, counts = counts, same = same,
    each = same and total or 0, parameters = same and 0 or total,
    text = ("galerkin(%d functions, %s) (own)"):format(total, quadrature.text) })
end

local function of_curve(given, quadrature)
  local curve = options.callable(given, "curve", GALERKIN, "(t, z, h)")
  local start = options.callable(given, "start", GALERKIN, "(q, v, h)")
  if not start then
    options.fail(GALERKIN, "option 'start' is missing: function(q, v, h) that returns a first "
      .. "guess of z, the parameters of 'curve'")
  end
  options.need(given, "parameters", GALERKIN, "how many numbers z has")
  local count = options.whole(given, "parameters", GALERKIN, 2, 400)
  return rule(quadrature, { kind = "curve",
    curve = options.single(curve, "curve"), start = options.single(start, "start"),
    parameters = count,
    text = ("galerkin(curve of %d parameters, %s) (own)"):format(count, quadrature.text) })
end

M.own_space = blame.caller(function(given)
  options.check(given, { "functions", "curve", "parameters", "start", "quadrature" }, GALERKIN)
  local quadrature = read_quadrature(given.quadrature, GALERKIN)
  if given.functions ~= nil and given.curve ~= nil then
    options.fail(GALERKIN, "give 'functions' (a linear space) or 'curve' (any other), not both")
  end
  if given.curve ~= nil then return of_curve(given, quadrature) end
  for _, key in ipairs { "parameters", "start" } do
    if given[key] ~= nil then options.fail(GALERKIN, "option '%s' goes with 'curve'", key) end
  end
  return of_functions(given, quadrature)
end)

---- two scales ----

-- a whole number for all coordinates, or a list of one for each
local function read_degrees(given, key, default, least)
  local x = given[key]
  if x == nil then return default end
  local list = type(x) == "table" and x or { x }
  local fine = #list > 0
  for _, d in ipairs(list) do
    fine = fine and math.type(d) and math.tointeger(d) and d >= least and d <= 20
  end
  options.demand(fine, given, key, MULTISCALE, ("a whole number from %d to 20, or a list of "
    .. "one for each coordinate"):format(least))
  return type(x) == "table" and x or list[1]
end

-- how many parameters the coordinates of these degrees have; nothing where all have the same
local function parameters_of(degrees, oscillating, product)
  local function count(d, o) return product and d + 3 or d + 1 + 2 * (o + 1) end
  if type(degrees) == "number" and type(oscillating) == "number" then
    return count(degrees, oscillating), nil
  end
  local n = type(degrees) == "table" and #degrees or #oscillating
  local total = 0
  for i = 1, n do
    total = total + count(type(degrees) == "table" and degrees[i] or degrees,
      type(oscillating) == "table" and oscillating[i] or oscillating)
  end
  return nil, total
end

-- what of the options is wrong beside their kinds
local function check_multiscale(given, degrees, oscillating)
  if type(degrees) == "table" and type(oscillating) == "table" and #degrees ~= #oscillating then
    options.fail(MULTISCALE, "'degrees' and 'oscillating' are lists of %d and %d numbers",
      #degrees, #oscillating)
  end
  if given.ansatz ~= nil and given.ansatz ~= "additive" and given.ansatz ~= "product" then
    options.fail(MULTISCALE, "option 'ansatz' must be \"additive\" or \"product\" (got %s)",
      options.got(given.ansatz))
  end
  if given.ansatz == "product" and given.oscillating ~= nil then
    options.fail(MULTISCALE, "option 'oscillating' goes with the additive ansatz")
  end
end

M.multiscale = blame.caller(function(given)
  options.check(given, { "frequency", "degrees", "oscillating", "nodes", "phases", "ansatz" },
    MULTISCALE, "{ frequency = }")
  options.need(given, "frequency", MULTISCALE, "that of the fast motion, radians per unit of time")
  local w = options.positive(given, "frequency", MULTISCALE, "radians per unit of time")
  local degrees = read_degrees(given, "degrees", 3, 1)
  local oscillating = read_degrees(given, "oscillating", 0, 0)
  local nodes = options.whole(given, "nodes", MULTISCALE, 2, MOST_NODES, 5)
  local phases = options.whole(given, "phases", MULTISCALE, 3, 99, 9)
  options.demand(phases % 2 == 1, given, "phases", MULTISCALE, "odd")
  check_multiscale(given, degrees, oscillating)
  local product = given.ansatz == "product"
  local each, total = parameters_of(degrees, oscillating, product)
  return core.trial_rule { kind = "multiscale", named = ("lobatto(%d)"):format(nodes),
    phases = phases, frequency = w, each = each, parameters = total, degrees = degrees,
    oscillating = oscillating, product = product, nodes = nodes,
    text = ("multiscale(%.6g, %d nodes, %d phases%s) (own)"):format(w, nodes, phases,
      product and ", product" or "") }
end)

core.docs[M.multiscale] = [[
dm.multiscale{frequency=, degrees=, oscillating=, nodes=, phases=, ansatz=} -> dm.rule
A rule for motion that vibrates with a known frequency w (radians per unit of time;
path:frequency reads it off a run) beside something slow, with steps over many vibrations: every
coordinate is P(t) + S(t) sin(w t) + C(t) cos(w t), P of `degrees` (3; a list: one for each
coordinate), S and C of degree `oscillating` (0). L is taken at nodes x phases points of time and
phase (5 Lobatto nodes, at most 8; 9 phases, odd) and every harmonic integrated by Filon's
weights, so that a step costs the same however stiff the spring. Rows and events inside a step are
read off its curve. ansatz = "product": P(t) (1 + a sin(w t) + b cos(w t)), the printed space with
w held, to compare: its equations have many roots and conditions of 1e10 and more
(solver:report().condition). Where h w is below 3, more nodes and phases are needed (6 and 15),
below 1/2 the space is refused. With a wrong frequency, or a second fast one, the energy goes:
solver:report().drift says by how much of the largest v . L_v (0.03 and less where all is right),
the path asks from 0.01 on, and above 0.2 the run ends. Leok 5.7.]]

-- a name or { nodes = } as the core takes it
local function filon_nodes(quadrature)
  if type(quadrature) == "string" then return { named = quadrature } end
  if type(quadrature) ~= "table" then
    options.fail(FILON, "takes a quadrature by name, \"lobatto(5)\", or { nodes = } (got %s)",
      options.got(quadrature))
  end
  options.check(quadrature, { "nodes", "weights" }, FILON, "{ nodes = }")
  local q = { nodes = quadrature.nodes, weights = quadrature.nodes }
  local c = core.quadrature(q)
  for i = 2, #c do
    if not (c[i] > c[i - 1]) then
      options.fail(FILON, "nodes must grow (entry %d is %s)", i, c[i])
    end
  end
  return q
end

M.filon = blame.caller(function(quadrature, z)
  if type(z) ~= "number" then
    options.fail(FILON, "takes a quadrature and z = w h, a number (got %s)", options.got(z))
  end
  if z - z ~= 0 then options.fail(FILON, "z must be finite (got %s)", tostring(z)) end
  return core.filon_weights(filon_nodes(quadrature), z)
end)

core.docs[M.filon] = [[
dm.filon(quadrature, z) -> re, im, nodes
Filon's weights b_i(z) = int_0^1 l_i(x) exp(i z x) dx on the nodes of a quadrature ("lobatto(5)",
or { nodes = }; at most 8), l_i their Lagrange polynomials: the integral over a step h of
F(t) exp(i w t) is about h sum_i b_i(w h) F(c_i h), exactly where F has a degree below the number
of nodes. Real and imaginary parts, and the nodes in [0, 1], as vectors. Filon 1928; Leok 5.7.2.]]

return M
