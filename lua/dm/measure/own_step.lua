--- The tangent map of a dm.step. With x the root of F(y, x, h) = 0 and y' = N(y, x, h),
--   dy'/dy = N_y - N_x F_x^-1 F_y,
-- exact derivatives of the functions that the step is made of. y are flat coordinates, momenta, t
-- and parts; of a group changes are (u, dp), u = g^-1 dg, which directions of coordinates stand
-- for. Parts begin with the derivative of `begin` and move along.
local blame = require "dm.base.blame"
local core = require "dm.core"
local flats = require "dm.group.flat"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local steps = require "dm.group.step"

local M = {}

local abs, max = math.abs, math.max
local joined, part = lists.joined, lists.part

local SAME = 1e-9      -- of a state: its step, and the one that C takes
local ITERATIONS = 60  -- of Newton's method, at most

--- Is the rule of a solver a dm.step?
function M.is(solver)
  local rule = solver.rule
  return type(rule) ~= "string" and rule.own
end

---- the functions of a step and their derivatives ----

-- f(q, p, t, parts, ...) without parts where there are none
local function without_parts(f, w)
  if w > 0 then return f end
  return function(q, p, t, _, ...) return f(q, p, t, ...) end
end

-- what is known of a step on a system: sizes, start, and F and N one after the other with their
-- derivatives by all of (q, p, t, parts, x)
local function facts_of(solver)
  local system, options = solver.system, steps.options_of(solver.rule)
  local own, f, w = system.place, steps.functions(options, system), 0
  for _, entry in ipairs(options.parts or {}) do w = w + entry[2] end
  local d, m = own and own.dimension or system.Q.dimension, options.unknowns
  local N = own and own.size or d
  local lengths = { N, d, "number" }
  if w > 0 then lengths[4] = w end
  local function both(...)
    local F, after = core.vector(lists.entries(f.equation(...))), core.vector(f.next(...))
    return joined(F, after)
  end
  local of_state = lists.copy(lengths)
  lengths[#lengths + 1], of_state[#of_state + 1] = m, "number"
  lengths[#lengths + 1] = "number"
  local function traced(make, g, ...) return without_parts(make(g, ...), w) end
  return { N = N, d = d, w = w, m = m, own = own, h = solver.h, sums = options.sums,
    states = N + d + 1 + w, begin = f.begin,
    start = traced(core.trace, f.start, table.unpack(of_state)),
    value = traced(core.trace, both, table.unpack(lengths)),
    slopes = traced(core.derivative, both, table.unpack(lengths)) }
end

-- rows and columns of J as a matrix
local function block(J, row, rows, column, columns)
  return linear.fill(rows, columns, function(i, k) return J[row + i][column + k] end)
end

---- one step ----

local function is_finite(x)
  for i = 1, #x do
    if x[i] ~= x[i] or abs(x[i]) == math.huge then return false end
  end
  return true
end

-- the root, by Newton's method from where the step begins it until corrections stop falling
local function root(k, y, what)
  local x, last = core.vector(k.start(y.q, y.p, y.t, y.parts, k.h)), math.huge
  for _ = 1, ITERATIONS do
    local F = part(k.value(y.q, y.p, y.t, y.parts, x, k.h), 0, k.m)
    local J = block(k.slopes(y.q, y.p, y.t, y.parts, x, k.h), 0, k.m, k.states, k.m)
    local fine, change = blame.try(J.solve, J, F)
    if not fine then
      error(what .. ": dF/dx of this step is singular at its root, so that no tangent map is "
        .. "known", 0)
    end
    if not is_finite(change) then break end
    local size = change:norm()
    if size >= last then return x end
    x, last = x - change, size
    if size == 0 then return x end
  end
  error(what .. ": Newton's method does not find the root of this step", 0)
end

-- the state behind a step, as a table
local function after(k, y, value)
  local q, p = part(value, k.m, k.N), part(value, k.m + k.N, k.d)
  if k.sums then q, p = y.q + q, y.p + p end
  return { q = q, p = p, t = value[k.m + k.N + k.d + 1],
    parts = part(value, k.m + k.N + k.d + 1, k.w) }
end

-- raises where the time of a step depends on the state
local function check_time(k, Z, what)
  for j = 1, Z.columns do
    if Z[k.N + k.d + 1][j] ~= 0 then
      error(what .. ": this step changes the time with the state, and a tangent map compares "
        .. "states at one time: use a step whose time grows by h", 0)
    end
  end
end

-- do parts act on x, q or p?
local function feeds(k, J)
  for i = 1, k.m + k.N + k.d do
    for a = k.N + k.d + 2, k.states do
      if J[i][a] ~= 0 then return true end
    end
  end
  return false
end

-- a step from y; Z: derivatives of y, in columns. The state behind it, its derivatives, J
local function advance(k, y, Z, what)
  local x = root(k, y, what)
  local J = k.slopes(y.q, y.p, y.t, y.parts, x, k.h)
  local S, m = k.states, k.m
  local of_x = block(J, 0, m, S, m):solve(block(J, 0, m, 0, S) * Z)
  local out = block(J, m, S, 0, S) * Z - block(J, m, S, S, m) * of_x
  if k.sums then
    out = out + linear.fill(S, Z.columns, function(i, a) return i <= k.N + k.d and Z[i][a] or 0 end)
  end
  check_time(k, out, what)
  return after(k, y, k.value(y.q, y.p, y.t, y.parts, x, k.h)), out, J
end

---- changes of a state ----

-- d(flat coordinates)/du; the identity on R^n
local function directions(k)
  local own = k.own
  if not own then
    return function() return linear.fill(k.d, k.d, function(i, j) return i == j and 1 or 0 end) end
  end
  return flats.directions(own, k.N, k.d, own.right)
end

-- vectors (u, dp) as columns of derivatives of (q, p, t, parts)
local function raised(k, X, y, vectors)
  local dq, dparts = X(y.q), nil
  if k.w > 0 and k.begin and y.fresh then
    dparts = core.derivative(k.begin, k.N, k.d, "number")(y.q, y.p, k.h)
  end
  local columns = {}
  for a, w in ipairs(vectors) do
    local change = joined(dq * part(w, 0, k.d), part(w, k.d, k.d))
    local of_parts = dparts and block(dparts, 0, k.w, 0, k.N + k.d) * change or core.zeros(k.w)
    columns[a] = joined(change, { 0 }, of_parts)
  end
  return linear.fill(k.states, #vectors, function(i, a) return columns[a][i] end)
end

-- and back
local function lowered(k, X, y, Z)
  local dq, out = X(y.q), {}
  local across = dq:transpose()
  for a = 1, Z.columns do
    local column = {}
    for i = 1, k.N + k.d do column[i] = Z[i][a] end
    out[a] = joined((across * dq):solve(across * part(column, 0, k.N)), part(column, k.N, k.d))
  end
  return out
end

---- along a run ----

-- raises where a step of C leads elsewhere: then its root is another one
local function check_step(solver, k, y, behind, what)
  local path = solver:run { q = k.own and k.own.element(y.q) or y.q, p = y.p, t0 = y.t, steps = 1 }
  local worst, size = 0, 1
  for i = 1, k.N + k.d do
    local here = path:column(path.columns[1 + i])[2]
    local there = i <= k.N and behind.q[i] or behind.p[i - k.N]
    worst, size = max(worst, abs(here - there)), max(size, abs(here))
  end
  if not (worst <= SAME * size) then
    error(("%s: the equation of this step has several roots, and the one of its tangent map is not "
      .. "that of its run (they are %.2g apart)"):format(what, worst), 0)
  end
end

local function parts_at_start(k, q, p)
  if k.begin and k.w > 0 then return core.vector(k.begin(q, p, k.h)) end
  return core.zeros(k.w)
end

--- along(s, count, vectors) as dm.measure.on_group has it, on R^n too (s.q: a vector there). s
-- keeps the parts of its state; raises where they act on later steps and s goes on, since what
-- vectors have of them is not known any more.
function M.map(solver, what)
  local k = facts_of(solver)
  local X, checked = directions(k), false
  return function(s, count, vectors)
    local q, p = core.vector(k.own and k.own.flat(s.q) or s.q), core.vector(s.p)
    if s.feeds then
      error(what .. ": parts of this step's state act on later steps, so that (q, p) alone has no "
        .. "exponents; solver:tangent knows the derivative of a whole run", 0)
    end
    local y = { q = q, p = p, t = s.t, parts = s.parts or parts_at_start(k, q, p),
      fresh = not s.parts }
    local Z, J = raised(k, X, y, vectors), nil
    for _ = 1, count do
      local before = y
      y, Z, J = advance(k, y, Z, what)
      if not checked then check_step(solver, k, before, y, what) end
      checked, s.feeds = true, s.feeds or k.w > 0 and feeds(k, J)
    end
    s.q, s.p, s.t, s.parts = k.own and k.own.element(y.q) or y.q, y.p, y.t, y.parts
    return lowered(k, X, y, Z)
  end
end

return M
