--- Invariant variational problems, the second way (Bogfjellmo ch. 5): from L(invariants), the
-- action and the cross-section alone, the discrete Euler-Lagrange equations in invariants, stepped
-- in C, and the points recovered from the frame.
local blame = require "dm.base.blame"
local boundary = require "dm.frame.invariant_boundary"
local curves = require "dm.frame.invariant_curve"
local core = require "dm.core"
local derivatives = require "dm.frame.derivatives"
local equations = require "dm.frame.invariant_equations"
local frames = require "dm.frame"
local lists = require "dm.base.lists"
local options = require "dm.base.options"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"
local windows = require "dm.frame.invariant_windows"
local stability = require "dm.frame.invariant_stability"
local starts = require "dm.frame.invariant_start"

local M = {}


local class = core.class({ __name = "dm.invariant_problem" }, [[
dm.invariant_problem: a variational problem in invariants of an action, by dm.invariant_problem{}
fields: frame, action, group, N (points of L), constraints (how many)]])
local function method(name, f, doc)
  core.method("dm.invariant_problem", name, blame.caller(f), doc)
end

local KNOWN = { "action", "frame", "L", "points", "invariants", "constraint", "inside", "name" }
local NAME = "dm.invariant_problem"
local fail = options.failing(NAME)

---- what the invariants are called ----

-- I.name that is not there
local Invariants = { __index = function(_, name)
  if type(name) == "number" then return nil end
  error(("there is no invariant '%s': name it by invariants = { %s = { point, entry } }")
    :format(tostring(name), tostring(name)), 0)
end }

-- name -> function of normalized points; {j, a} stands for entry a of point j
local function named_function(name, what, points, entries)
  if type(what) == "function" then return core.one(what, ("invariant '%s'"):format(name)) end
  if type(what) ~= "table" then
    fail("invariant '%s' must be a function of the normalized points, or { point, entry }", name)
  end
  local j, a = what[1], what[2] or 1
  local function is_place(i, most)
    return type(i) == "number" and lists.whole(i) and i >= 1 and i <= most
  end
  if not (is_place(j, points) and is_place(a, entries)) then
    fail("invariant '%s': there is no entry %s of point %s among %d points of %d numbers", name,
      tostring(a), tostring(j), points, entries)
  end
  return function(...) return (select(j, ...))[a] end
end

local function named_functions(given, points, entries)
  local names, functions = {}, {}
  if given ~= nil and type(given) ~= "table" then
    fail "option 'invariants' must be a table { name = { point, entry } or a function }"
  end
  for name, what in pairs(given or {}) do
    if type(name) ~= "string" then
      fail "option 'invariants' must be a table { name = { point, entry } or a function }"
    end
    names[#names + 1] = name
    functions[name] = named_function(name, what, points, entries)
  end
  table.sort(names)
  return names, functions
end

---- the action as a left one ----

local function left_action(p)
  local action, G = p.action, p.group
  local right = action.side == "right"
  local function element(g) return right and G:inverse(g) or g end
  function p.act(g, z)
    return frames.point(require "dm.action".move(action, element(g), z), p.d,
      "what the action gives")
  end
  function p.move(g, list)
    local out = {}
    for i, z in ipairs(list) do out[i] = p.act(g, z) end
    return out
  end
  function p.rho(list) return element(frames.element(p.frame, windows.for_frame(p, list))) end
  function p.generator(z) return right and action:generator(z) * -1 or action:generator(z) end
  p.flat_size = #points.entries(G:flat(G:identity()))
  p.motion = core.derivative(function(y, z)
    return p.act(G:unflat(y), z):map(function(w) return 1 + w end)
  end, p.flat_size, p.d)
end

-- how many of the first points the cross-section looks at
local function reach_of_section(frame)
  local reach = 1
  for seed = 1, 3 do
    local J = tangent.section_slope(frame, points.sample(frame, seed))
    for i = 1, frame.r do
      for j = 1, frame.k * frame.m do
        if J[i][j] ~= 0 then reach = math.max(reach, (j - 1) // frame.m + 1) end
      end
    end
  end
  return reach
end

-- largest number of first points that the constraint (c numbers) depends on
local function reach_of(p, c)
  local reach, seen = 0, 0
  for seed = 1, 60 do
    local fine, _, J = blame.try(windows.slopes_apart, p, points.sample(p.frame, seed, p.N))
    if fine then
      seen = seen + 1
      for i = 1, c do
        for j = 1, p.N * p.d do
          if math.abs(J[i][j]) > 1e-11 then reach = math.max(reach, (j - 1) // p.d + 1) end
        end
      end
    end
    if seen == 3 then break end
  end
  return reach
end

---- L and the constraint of windows of N points ----

-- the derivative of f, made when it is first called
local function when_wanted(f, n)
  local made
  return function(x)
    made = made or core.derivative(f, n)
    return made(x)
  end
end

local function functions_of_windows(p, o)
  local function windowed(x) return frames.split(x, p.N, p.d) end
  local function with_names(I)
    for _, name in ipairs(p.names) do I[name] = p.functions[name](table.unpack(I, 1, p.N)) end
    return setmetatable(I, Invariants)
  end
  function p.invariants_of(list)
    local I = p.move(p.rho(list), list)
    return with_names(I)
  end
  function p.named(list)
    local I, out = p.invariants_of(list), {}
    for i, name in ipairs(p.names) do out[i] = I[name] end
    return out
  end
  local L = options.numeric(o.L, "L")
  p.bare_slope = core.derivative(function(x) return L(with_names(windowed(x))) end, p.N * p.d)
  function p.lagrangian(list) return L(p.invariants_of(list)) end
  p.slope = when_wanted(function(x) return p.lagrangian(windowed(x)) end, p.N * p.d)
  if not o.constraint then return end
  function p.phi(list) return points.entries(o.constraint(p.invariants_of(list))) end
  for seed = 1, 60 do
    local fine, value = blame.try(p.phi, points.sample(p.frame, seed, p.N))
    if fine then p.constraints = #value break end
  end
  if p.constraints == 0 then
    fail("the constraint fails at all random points: %s",
      tostring(select(2, blame.try(p.phi, points.sample(p.frame, 1, p.N)))))
  end
  p.phi_slope = when_wanted(function(x) return core.vector(p.phi(windowed(x))) end, p.N * p.d)
  p.bare_phi_slope = core.derivative(function(x)
    return core.vector(points.entries(o.constraint(with_names(windowed(x)))))
  end, p.N * p.d)
  p.reach = reach_of(p, p.constraints)
  if p.reach == 0 then fail "the constraint does not depend on the points" end
end

local doc_new = [[
dm.invariant_problem{frame=, L=, points=, invariants=, constraint=, inside=, name=} -> problem
The variational problem sum L(I) = extremal over sequences of points, invariant under the action of
the frame. I[1] ... I[N] are the points moved by the frame of the first of them, I.name what
`invariants` names: {name = {point, entry} or function(I1, ..., IN)}. points = N (default: one more
than the frame looks at). constraint(I) gives numbers that vanish at every site, with multipliers mu
in L - mu . constraint; inside(I) gives numbers that are > 0 where a root is allowed. The discrete
Euler-Lagrange equations are derived and solved for the next invariants (Bogfjellmo ch. 5). Methods:
solve, boundary, stability, momentum, action_sum, both_ways.]]

local function check_options(o)
  options.check(o, KNOWN, NAME, "{ frame =, L = }")
  options.demand(frames.is_frame(o.frame), o, "frame", NAME, "a moving frame, dm.moving_frame{...}")
  options.need(o, "L", NAME, "a function of the invariants I")
  for _, key in ipairs { "L", "constraint", "inside" } do
    options.callable(o, key, NAME, "the invariants I")
  end
  if o.frame.basis or o.frame.discrete then
    fail "the frame is one up to isotropy (partial): an invariant problem needs a free action"
  end
  if o.action and o.frame.action ~= o.action and o.action.base ~= o.frame.action then
    fail "the frame belongs to another action"
  end
end

-- every number of a point must be free to vary
local function check_space(p)
  local kit = require "dm.group".kit(p.action.on)
  if kit.bonds and #points.entries(kit.bonds(points.sample(p.frame, 1)[1])) > 0 then
    fail("the %d numbers of a point of %s are not independent: let the group act on dm.R(%d) and "
      .. "give the rest as a constraint, for a sphere function(I) return I[1]:dot(I[1]) - 1 end",
      p.d, tostring(p.action.on), p.d)
  end
end

M.invariant_problem = blame.caller(function(o)
  check_options(o)
  local frame = o.frame
  local p = setmetatable({ frame = frame, action = frame.action, group = frame.group, d = frame.m,
    r = frame.r, constraints = 0, reach = 0, inside = o.inside, name = o.name }, class)
  p.k = reach_of_section(frame)
  local least = math.max(2, math.min(frame.k, p.k))
  p.N = options.whole(o, "points", NAME, least, 12, math.max(frame.k, p.k + 1))
  p.names, p.functions = named_functions(o.invariants or frame.invariants_named, p.N, p.d)
  check_space(p)
  left_action(p)
  functions_of_windows(p, o)
  p.may_reduce = p.N - 1 >= p.k and (p.N - 1) * p.d >= p.r
  p.fixed = derivatives.phantom(frame, math.max(p.N - 1, p.k))
  function p.section_points()
    local out = {}
    for i = 1, p.N - 1 do
      out[i] = core.zeros(p.d)
      for a = 1, p.d do
        if not p.fixed[i][a] then
          error("a start from a frame needs a section that fixes all numbers of the window: "
            .. "give points", 0)
        end
        out[i][a] = p.fixed[i][a]
      end
    end
    return out
  end
  return p
end)

function class.__tostring(p)
  local text = ("invariant problem of %d points on %s under %s"):format(p.N, tostring(p.action.on),
    tostring(p.group))
  if p.constraints == 0 then return text end
  return ("%s, %d constraint%s"):format(text, p.constraints, p.constraints == 1 and "" or "s")
end

---- solving ----

local SOLVE = { "points", "n", "momentum", "body_momentum", "multiplier", "frame", "form", "every" }

local function check_solve(o)
  options.check(o, SOLVE, "problem:solve", "{ points =, n = }")
  if not lists.whole(o.n) then
    options.fail("problem:solve", "'n', the number of points of the curve, must be a whole number")
  end
  return options.one_of(o, "form", "problem:solve", { "momentum", "points" }, "momentum")
end

local function state_of(p, name, o)
  if o.momentum or o.body_momentum then
    if name == "points" then
      error("problem:solve: a start from `momentum` is for the form \"momentum\"", 0)
    end
    return starts.from_momentum(p, o)
  end
  local list = frames.list(o.points, p.d,
    "problem:solve: give the first points, a list, or `momentum` with points or a frame")
  return starts.from_points(p, name, list, o.multiplier)
end

local doc_solve = [[
problem:solve{points=, n=, form=, every=, momentum=, frame=, multiplier=} -> curve
The sequence of n points that starts with the given ones: 2 N - 2 of them, one more with a
constraint (whose multipliers then follow; or give them). Or from N - 1 points, or a frame there,
and the Noether momentum J (dim G numbers, problem:momentum), where the section fixes all of them.
form = "momentum" (default) or "points", the recurrence as it is printed: the same equations, with
other round-off (problem:stability). curve: points (dm.matrix, a row each; every `every` sites and
the last ones), invariants (by name, vectors along the curve), multiplier (row k of the window that
begins at point first_site + k - 1), frame (the last). A step that has no root raises a dm.failure
with the points so far in its `path`.]]

method("solve", function(p, o)
  local name = check_solve(o)
  p.window = name == "points" and math.max(2 * p.N - 2, p.k) or math.max(p.N - 1, p.k)
  local values, before = state_of(p, name, o)
  local form = equations[name .. "_form"](p)
  local steps = o.n - #before - p.window
  if steps < 0 then
    options.fail("problem:solve", "n = %d is less than the %d points given", o.n,
      #before + p.window)
  end
  local function curve_of(rows)
    local curve = curves.of(p, form, rows, before)
    curve.form, curve.first_site = name, #before + p.window - p.N + 2
    return curve
  end
  local rows, report = curves.run(core.sequence, { equation = form.equation, next = form.next,
    start = form.start, inside = form.inside, scale = form.scale,
    y = form.layout:pack(values), unknowns = p.d + p.constraints, steps = steps,
    every = o.every or 1, check = false }, curve_of)
  local curve = curve_of(rows)
  if report.code ~= "ok" then
    curves.stopped(p, report, curve, #before + p.window + report.done + 1)
  end
  return curve
end, doc_solve)

local doc_momentum = [[
problem:momentum({u1, ..., u2N-2} [, multiplier]) -> dm.vector
The Noether momentum J of the discrete problem at these points, <J, e_j> = sum p . v_j over the last
N - 1 of them: the same at every window of a solution. With a constraint the multipliers of the last
windows are given as a list (of `curve.multiplier`; row k belongs to the window that begins at point
curve.first_site + k - 1), or follow from one point more.]]

method("momentum", function(p, points, multiplier)
  local list = frames.list(points, p.d, "problem:momentum takes a list of points")
  if #list < 2 * p.N - 2 then
    error(("problem:momentum takes %d points (got %d)"):format(2 * p.N - 2, #list), 0)
  end
  return starts.spatial(p, list, multiplier)
end, doc_momentum)

local doc_action = [[
problem:action_sum{u1, ..., un} -> number
The sum of L over all windows of N points.]]

method("action_sum", function(p, points)
  local list, sum = frames.list(points, p.d, "problem:action_sum takes a list of points"), 0
  for i = 1, #list - p.N + 1 do sum = sum + p.lagrangian { table.unpack(list, i, i + p.N - 1) } end
  return sum
end, doc_action)

local doc_both = [[
problem:both_ways{points=, n=, form=} -> {difference, first, second}
For problems of two points: the sequence from the two given ones by the first way, a path of the
discrete Lagrangian q0, q1 -> L(I) in the original coordinates, and by the second, problem:solve;
and their largest distance. They solve the same equations (docs/theory/frames.md): it is
round-off.]]

method("both_ways", function(p, o)
  if p.N ~= 2 or p.constraints > 0 then
    error("problem:both_ways is for problems of two points without constraint", 0)
  end
  options.check(o, { "points", "n", "form" }, "problem:both_ways", "{ points =, n = }")
  local wanted = "problem:both_ways: option 'points' must be two points"
  local a, b = table.unpack(frames.list(o.points, p.d, wanted))
  if not b then error(wanted, 0) end
  local second = p:solve { points = { a, b }, n = o.n, form = o.form }
  local function lagrangian(h)
    return core.discrete_lagrangian { Q = core.R(p.d), h = h,
      Ld = function(q0, q1) return p.lagrangian { q0, q1 } end }
  end
  local momentum = lagrangian(1):legendre_minus(a, b)
  -- h is of no consequence but for where the search for the first point begins
  local h = (b - a):norm() / math.max(momentum:norm(), 1e-300)
  local first = core.solver { lagrangian(h) }
    :run { q = a, p = momentum, steps = o.n - 1, every = 1 }
  local worst = 0
  for i = 1, o.n do
    for j = 1, p.d do worst = math.max(worst, math.abs(first.q[i][j] - second.points[i][j])) end
  end
  return core.result { difference = worst, first = first, second = second }
end, doc_both)

method("stability", stability.stability, stability.doc)
method("boundary", boundary.solve, boundary.doc)

core.docs[M.invariant_problem] = doc_new

return M
