--- dm.msfem: multiscale finite elements for (a u')' = f on an interval, u = 0 at its ends (Leok
-- 5.7.1, appendix C). The shape functions solve (a phi')' = 0 in each element: with G = int dx/a,
-- phi_i = (G - G_(i-1))/(G_i - G_(i-1)) to the left of node i, and the values at the nodes are
-- those of the solution.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local integrals = require "dm.elements.integrals"
local lists = require "dm.base.lists"
local narrow = require "dm.elements.narrow"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.msfem"
local fail = option.failing(WHERE)

local Solution = core.class({ __name = "dm.msfem_solution" }, [[
dm.msfem_solution: finite elements for (a u')' = f, u = 0 at the ends
fields: u (dm.vector, at all nodes), x (nodes), elements ("multiscale", "linear")]])

local KNOWN = { "a", "f", "x", "period", "antiderivative", "shape" }

---- what is given ----

local function is_finite(y) return type(y) == "number" and y - y == 0 end

local function read_nodes(options)
  local given = option.need(options, "x", WHERE, "the nodes, a list of growing numbers")
  local x = lists.vector(given, WHERE .. ": option 'x'"):totable()
  if #x < 2 then fail "option 'x': at least two nodes are needed, the ends" end
  for i = 1, #x do
    if not is_finite(x[i]) then fail("option 'x': node %d is %s", i, tostring(x[i])) end
    if i > 1 and x[i] <= x[i - 1] then
      fail("option 'x': nodes must grow (%g at %d, then %g)", x[i - 1], i - 1, x[i])
    end
  end
  return x
end

-- 1/a, a > 0
local function inverse(a)
  return function(x)
    local y = a(x)
    if not (is_finite(y) and y > 0) then
      fail("a(%g) must be a positive number (got %s)", x, option.got(y))
    end
    return 1 / y
  end
end

local function load_at(f)
  return function(x)
    local y = f(x)
    if not is_finite(y) then fail("f(%g) must be a finite number (got %s)", x, option.got(y)) end
    return y
  end
end

---- integrals ----

local MOST_PANELS = 4096  -- or 8 times those that the period asks for
local BESIDE = 512        -- or so many times those where some end beside what is narrow
local SETTLED = 3e-15  -- of the largest, between two halvings

-- G and F, and the integrals of F/a, a and x f, on panels of a length, at least so many between
-- two places where they must end
local function integrate(given, places, length, least)
  local edges = integrals.edges(places, length, least)
  local out = integrals.together(given.f, given.inverse, edges)
  out.panels, out.edges = #edges - 1, edges
  if given.antiderivative then out.G = given.antiderivative end
  return out
end

-- how far two sets of integrals are apart at the nodes, over the largest of each; infinite where
-- one overflows
local function difference(a, b, x)
  local worst = 0
  for _, key in ipairs { "G", "F", "FG", "A", "M" } do
    local off, most, base = 0, 0, { a[key](x[1]), b[key](x[1]) }
    for i = 2, #x do
      local u, v = a[key](x[i]) - base[1], b[key](x[i]) - base[2]
      if not is_finite(u - v) then return math.huge end
      off, most = math.max(off, math.abs(u - v)), math.max(most, math.abs(v))
    end
    if most > 0 then worst = math.max(worst, off / most) end
  end
  return worst
end

-- an antiderivative that is none would give wrong numbers without a word
local function check_antiderivative(given, own)
  local G = given.antiderivative
  if not G then return end
  for i = 2, #given.x do
    local a, b = given.x[i - 1], given.x[i]
    local told, found = G(b) - G(a), own(b) - own(a)
    if not (is_finite(told) and math.abs(told - found) <= 1e-8 * math.abs(found)) then
      fail("option 'antiderivative': from %g to %g it grows by %s, the integral of 1/a is %.10g",
        a, b, tostring(told), found)
    end
  end
end

-- the nodes and more places, growing, each once
local function merged(places, more)
  local all, out = table.move(more, 1, #more, #places + 1, { table.unpack(places) }), {}
  table.sort(all)
  for _, x in ipairs(all) do
    if x ~= out[#out] then out[#out + 1] = x end
  end
  return out
end

local LOOKS = 16 -- for what is narrow

-- places at which panels must end: the nodes, and more beside what is narrow
local function places_of(given, length)
  local places = given.x
  for _ = 1, LOOKS do
    local edges = integrals.edges(places, length, 1)
    local marks = narrow.marks(given.f, given.traced[1], edges)
    local more = narrow.marks(given.inverse, given.traced[2], edges)
    if #marks + #more == 0 then break end
    places = merged(merged(places, marks), more)
  end
  return places
end

-- on panels that are halved until nothing changes any more
local function settle(given)
  local width = given.x[#given.x] - given.x[1]
  local length = math.min(given.period and given.period / 2 or width / 8, width / 8)
  local places, least, before = places_of(given, length), 1, math.huge
  local coarse = integrate(given, places, length, 1)
  local most = math.max(MOST_PANELS, (#places > #given.x and BESIDE or 8) * coarse.panels)
  while true do
    length, least = length / 2, 2 * least
    local fine = integrate(given, places, length, least)
    local off = difference(coarse, fine, given.x)
    local is_last = fine.panels > most
    -- where rounding is what is left, halving changes nothing any more
    if off <= SETTLED or off < 1e-13 and (off > before / 4 or is_last) then
      check_antiderivative(given, integrals.running(given.inverse, fine.edges))
      return fine
    end
    if off == math.huge then
      fail("the integrals of 1/a, a, f and x f between the nodes overflow: take other units")
    end
    if is_last then
      fail("the integrals of 1/a and f do not settle on %d panels (they change by %.1g): are they "
        .. "continuous? Give 'period', or put nodes where they jump", fine.panels, off)
    end
    coarse, before = fine, off
  end
end

---- the linear system ----

-- stiffness of element i, from x[i] to x[i + 1], and its loads on both nodes. With multiscale
-- shapes int f phi = F_right - (int F/a)/(G_right - G_left) for the node on the right, the rest on
-- the left.
local function element(given, made, i)
  local a, b = given.x[i], given.x[i + 1]
  local load = made.F(b) - made.F(a)
  if given.linear then
    local h = b - a
    local right = (made.M(b) - made.M(a) - a * load) / h
    return (made.A(b) - made.A(a)) / h ^ 2, load - right, right
  end
  local G = made.G(b) - made.G(a)
  -- about F(a), so that nothing large is taken from something large
  local mean = (made.FG(b) - made.FG(a)) / G - made.F(a)
  return 1 / G, mean, load - mean
end

-- -(B_i + B_(i+1)) u_i + B_i u_(i-1) + B_(i+1) u_(i+1) = f_i by elimination; u is 0 at the ends
local function solve(given, made)
  local count = #given.x
  local stiff, load, u = {}, {}, {}
  for i = 1, count do load[i], u[i] = 0, 0 end
  for i = 1, count - 1 do
    local left, right
    stiff[i], left, right = element(given, made, i)
    load[i], load[i + 1] = load[i] + left, load[i + 1] + right
  end
  local diagonal = {}
  for i = 2, count - 1 do
    diagonal[i] = -(stiff[i - 1] + stiff[i])
    if i > 2 then
      local factor = stiff[i - 1] / diagonal[i - 1]
      diagonal[i] = diagonal[i] - factor * stiff[i - 1]
      load[i] = load[i] - factor * load[i - 1]
    end
  end
  for i = count - 1, 2, -1 do
    u[i] = (load[i] - stiff[i] * u[i + 1]) / diagonal[i]
    if not is_finite(u[i]) then fail("u at node %d overflows: take other units", i) end
  end
  return core.vector(u)
end

---- dm.msfem ----

local DOC = "dm.msfem{a=, f=, x=, period=, antiderivative=, shape=} -> dm.msfem_solution\n" .. [[
(a u')' = f with u = 0 at both ends of the nodes x, a growing list; a and f: functions of x, a > 0.
The shape functions follow a (shape = "multiscale", unless given), so that the values at the nodes
are those of the solution to round-off on any mesh; shape = "linear": hats, for comparison. period:
of a, where it varies fast; antiderivative: of 1/a, where it is known (it is checked). Integrals are
by 12 Gauss points on panels that are halved until nothing changes; what is narrow in f or 1/a
between nodes is looked for by their bounds, where they can be traced (f:bounds), else put nodes
beside it. Raises on a <= 0, on nodes that do not grow, and on integrals that do not settle.]]

M.msfem = blame.caller(function(options)
  option.check(options, KNOWN, WHERE)
  for _, key in ipairs { "a", "f" } do
    option.need(options, key, WHERE, "a function of x")
    option.callable(options, key, WHERE, "x")
  end
  option.callable(options, "antiderivative", WHERE, "x, the integral of 1/a")
  local shape = option.one_of(options, "shape", WHERE, { "multiscale", "linear" }, "multiscale")
  local a, f = option.single(options.a, "a"), option.single(options.f, "f")
  local given = { x = read_nodes(options), inverse = inverse(a), f = load_at(f),
    traced = { f, function(x) return 1 / a(x) end },
    period = option.positive(options, "period", WHERE, "a length"),
    antiderivative = core.one(options.antiderivative, "antiderivative"),
    linear = shape == "linear" }
  local made = settle(given)
  return setmetatable({ u = solve(given, made), x = core.vector(given.x), elements = shape,
    given = given, made = made }, Solution)
end)

core.docs[M.msfem] = DOC

function Solution.__tostring(s)
  return ("%s elements for (a u')' = f: %d nodes from %g to %g, %d panels"):format(s.elements,
    #s.x, s.x[1], s.x[#s.x], s.made.panels)
end

---- values ----

local function check_place(s, x, where)
  if not is_finite(x) or x < s.x[1] or x > s.x[#s.x] then
    option.fail(where, "x must be a number from %g to %g (got %s)", s.x[1], s.x[#s.x],
      option.got(x))
  end
end

-- the element that x is in, and how far it is through it: 0 to 1 as the shape has it
local function locate(s, x)
  local nodes, i = s.given.x, 1
  while i < #nodes - 1 and x >= nodes[i + 1] do i = i + 1 end
  local a, b, G = nodes[i], nodes[i + 1], s.made.G
  if s.given.linear then return i, (x - a) / (b - a) end
  return i, (G(x) - G(a)) / (G(b) - G(a))
end

class.method("dm.msfem_solution", "value", function(s, x)
  check_place(s, x, "s:value")
  local i, part = locate(s, x)
  return (1 - part) * s.u[i] + part * s.u[i + 1]
end, [[
s:value(x) -> number
The finite element solution at x. Raises outside of the nodes.]])

class.method("dm.msfem_solution", "shape", function(s, i, x)
  option.whole({ i = i }, "i", "s:shape", 1, #s.x)
  option.need({ i = i }, "i", "s:shape", "the number of a node")
  check_place(s, x, "s:shape")
  local at, part = locate(s, x)
  return at == i and 1 - part or at + 1 == i and part or 0
end, [[
s:shape(i, x) -> number
The shape function of node i at x: 1 at the node, 0 at all others and beyond its elements.]])

class.method("dm.msfem_solution", "exact", function(s, x)
  check_place(s, x, "s:exact")
  local made, first, last = s.made, s.x[1], s.x[#s.x]
  local G0, FG0 = made.G(first), made.FG(first)
  local slope = (made.FG(last) - FG0) / (made.G(last) - G0)
  return made.FG(x) - FG0 - slope * (made.G(x) - G0)
end, [[
s:exact(x) -> number
The solution itself, int F/a - (int_all F/a)/G_all G(x), G and F the integrals of 1/a and f.]])

class.method("dm.msfem_solution", "plot", function(s, options)
  local count, first, last = 801, s.x[1], s.x[#s.x]
  local x, exact, value = {}, {}, {}
  for k = 1, count do
    x[k] = first + (last - first) * (k - 1) / (count - 1)
    exact[k], value[k] = s:exact(x[k]), s:value(x[k])
  end
  return require "dm.show.plot".plot({
    { x = x, y = exact, name = "exact" }, { x = x, y = value, name = s.elements },
    { x = s.x, y = s.u, name = "nodes", style = "points" } },
    lists.copy(options or { xlabel = "x", ylabel = "u" }))
end, [[
s:plot{file=, ...} -> file name or nothing
The exact solution, that of the elements and its values at the nodes; options as of dm.plot.]])

return M
