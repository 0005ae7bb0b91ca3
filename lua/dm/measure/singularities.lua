--- solver:singularities: where d2L/dv2 loses a value along a run, on the velocities that
-- constraints allow: coordinates that break down there, or a Lagrangian whose momentum folds.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local prolonged = require "dm.measure.prolonged_run"

local M = {}

local abs, max, min, huge = math.abs, math.max, math.min, math.huge

---- the mass on the velocities that are allowed ----

-- the rows that an allowed velocity is at right angles to, as a function of (q, v, t); nothing
-- without constraints
local function rows_of(system)
  local given, n = system.given, system.Q.dimension
  local g = given.constraint and bound(given.constraint, given.params)
  local phi = given.rolling and bound(given.rolling, given.params)
  local G = g and core.derivative(function(q, t) return core.vector(lists.entries(g(q, t))) end, n,
    "number")
  local E = phi and core.derivative(function(q, v, t)
    return core.vector(lists.entries(phi(q, v, t)))
  end, n, n, "number")
  return (G or E) and function(q, v, t)
    local out = {}
    for _, row in ipairs(G and G(q, t):totable() or {}) do out[#out + 1] = lists.part(row, 0, n) end
    for _, row in ipairs(E and E(q, v, t):totable() or {}) do
      out[#out + 1] = lists.part(row, n, n)
    end
    return out
  end
end

-- x without its parts along unit vectors, twice, so that round-off leaves none; and its length
local function cleared(x, units)
  for _ = 1, 2 do
    for _, u in ipairs(units) do x = x - x:dot(u) * u end
  end
  return x, x:norm()
end

local ALONG = 1e-10 -- of its length: what is left of a vector that the others span

-- unit vectors at right angles to all rows and to each other
local function allowed(rows, n)
  local across, out, all = {}, {}, {}
  for _, row in ipairs(rows) do
    local x, length = cleared(row, across)
    if length > ALONG * row:norm() then across[#across + 1] = x / length end
  end
  for i, u in ipairs(across) do all[i] = u end
  for i = 1, n do
    local unit = core.zeros(n)
    unit[i] = 1
    local x, length = cleared(unit, all)
    if length > 1e-8 and #all < n then
      out[#out + 1], all[#all + 1] = x / length, x / length
    end
  end
  return out
end

-- the scales of the velocities with which a mass has ones on its diagonal
local function scales_of(mass)
  local out = {}
  for i = 1, #mass do
    local own = abs(mass[i][i])
    out[i] = own > 0 and own < huge and own ^ -0.5 or 1
  end
  return out
end

-- the entries of a row, each by its scale
local function scaled(row, scales)
  local out = {}
  for i, scale in ipairs(scales) do out[i] = scale * row[i] end
  return core.vector(out)
end

-- the values of a mass on the velocities at right angles to rows
local function values_of(mass, rows)
  if not rows then return lists.entries(mass:eigenvalues()) end
  local basis, out = allowed(rows, #mass), {}
  for i, a in ipairs(basis) do
    out[i] = {}
    for j, b in ipairs(basis) do out[i][j] = a:dot(mass * b) end
  end
  return #out > 0 and lists.entries(core.matrix(out):eigenvalues()) or {}
end

-- how many are negative, counted with scaled velocities, so that no unit makes a value small
local function negative_values(mass, rows, scales)
  local all, across, negative = {}, rows and {}, 0
  for i = 1, #mass do all[i] = (scales[i] * scaled(mass[i], scales)):totable() end
  for i, row in ipairs(rows or {}) do across[i] = scaled(row, scales) end
  for _, value in ipairs(values_of(core.matrix(all), across)) do
    negative = negative + (value < 0 and 1 or 0)
  end
  return negative
end

---- what breaks down ----

local function name_of(system, i)
  return system.coordinates and system.coordinates[i] or "q" .. i
end

-- as much of its inertia left: it is no coordinate of its own; so near to 1: two move the same
local KEPT, SAME = 0.1, 0.99

-- which coordinate, or which two, make the mass singular: the one whose inertia is the least of
-- what it was at the start, or those that move the same there, as two angles of Euler do
local function weakest(system, q, v, t, start)
  local mass, best, ratio = system:mass(q, v, t), 1, huge
  for i = 1, #q do
    local r = abs(mass[i][i] / start[i][i])
    if r < ratio then best, ratio = i, r end
  end
  if ratio < KEPT then
    return ("'%s' has %.1g of the inertia that it had at the start")
      :format(name_of(system, best), ratio)
  end
  local most, one, other = 0, nil, nil
  for i = 1, #q do
    for j = 1, i - 1 do
      local together = abs(mass[i][j]) / (abs(mass[i][i] * mass[j][j])) ^ 0.5
      if together > most then most, one, other = together, j, i end
    end
  end
  if most > SAME then
    return ("'%s' and '%s' move the same there")
      :format(name_of(system, one), name_of(system, other))
  end
  return "a combination of them loses its inertia"
end

---- along a run ----

local MOST_ROWS, BAD = 4000, 1e4

-- the rows of a run, and the failure that ended it, or nothing
local function path_of(solver, options, steps)
  local run = lists.copy(options)
  run.every = max(1, steps // MOST_ROWS)
  local fine, path = blame.try(solver.run, solver, run)
  if fine then return path end
  if type(path) == "string" or not path.path then error(path, 0) end
  return path.path, path
end

-- what the mass is at a row: how singular beside the largest value there and at the start, how many
-- values are negative, the velocity; nothing where no velocity belongs to the momentum
local function look_at(system, path, rows, i, first)
  local q, t = path.q[i], path.t[i]
  local known, v = blame.try(path.velocity, path, i)
  if not known then return nil end
  local mass, across = system:mass(q, v, t), rows and rows(q, v, t)
  local scales = first and first.scales or scales_of(mass)
  local least, most = huge, first and first.most or 0
  for _, value in ipairs(values_of(mass, across)) do
    least, most = min(least, abs(value)), max(most, abs(value))
  end
  local negative = negative_values(mass, across, scales)
  local condition = least > 0 and most / least or huge
  return { v = v, scales = scales, most = most, negative = negative, condition = condition }
end

-- a place where the condition is bad goes on in the next row, or begins
local function note_place(places, i, t, condition)
  local here = places[#places]
  if condition <= BAD then return end
  if not here or here.last < i - 1 then
    here = { t = t, condition = condition }
    places[#places + 1] = here
  end
  here.last, here.condition = i, max(here.condition, condition)
end

-- worst, where, places and the time between which the inertia changed, of the rows of a path
local function look_along(system, path)
  local out, rows, first = core.result { worst = 0, places = {} }, rows_of(system), nil
  for i = 1, #path do
    local here = look_at(system, path, rows, i, first)
    first = first or here
    local c, t = here and here.condition or huge, path.t[i]
    if here and here.negative ~= first.negative and not out.change then
      out.change, c = { path.t[i - 1], t }, huge
    end
    if c > out.worst then
      out.worst, out.t, out.q, out.v = c, t, path.q[i], here and here.v or nil
    end
    note_place(out.places, i, t, c)
  end
  return out, first
end

-- the run ended at a step over such a place
local function note_failure(out, failure, h)
  out.failure = failure.code
  local crossed = failure.code == "inertia"
  if not (crossed or failure.fading) then return end
  out.worst, out.t, out.v = huge, failure.time, nil
  out.change = crossed and { failure.time, failure.time + h } or nil
  out.places[#out.places + 1] = { t = failure.time, condition = huge }
end

local SINGULAR = "the coordinates come near a singular place at t = %.6g: %s, condition %.2g; use "
  .. "other coordinates there (a constraint in R^n has no such places)"

local function describe(out, system, first)
  if out.change then
    return ("a value of d2L/dv2 passes through zero or grows without bound between t = %.6g and "
      .. "%.6g, and no motion goes through such a place"):format(out.change[1], out.change[2])
  elseif out.worst < BAD then
    return ("the coordinates stay regular: the condition of d2L/dv2 is at most %.3g (t = %.5g)")
      :format(out.worst, out.t)
  elseif out.v and first then
    local start = system:mass(first.q, first.v, first.t)
    return SINGULAR:format(out.t, weakest(system, out.q, out.v, out.t, start), out.worst)
  end
  return ("d2L/dv2 is singular at t = %.6g: no velocity belongs to the momentum there")
    :format(out.t)
end

local START = "{ q =, v = } or { q =, p = }"

M.singularities = blame.caller(function(solver, options)
  local what = "solver:singularities"
  option.check(options, { "q", "v", "p", "t0", "steps", "t" }, what, START)
  option.need(options, "q", what, START)
  local system = solver.system
  if not (system.given and system.given.L) then
    error(what .. " needs a dm.system with a Lagrangian", 0)
  end
  local steps = prolonged.steps_of(solver, options)
  if steps < 1 then error(what .. ": needs at least one step", 0) end
  local path, failure = path_of(solver, options, steps)
  local out, first = look_along(system, path)
  if first then first.q, first.t = path.q[1], path.t[1] end
  if failure then note_failure(out, failure, solver.h) end
  out.why = describe(out, system, first)
  if failure then
    out.why = out.why .. ("; the run ends there: %s at step %d"):format(failure.code, failure.step)
  end
  for _, place in ipairs(out.places) do place.last = nil end
  return out
end)

class.method("dm.solver", "singularities", M.singularities, [[
solver:singularities{q=, v= | p=, steps= | t=, t0=} -> {worst, t, q, places, change, why, failure}
Does d2L/dv2 lose a value on the way? Its condition at the rows of a run (at most 4000): the largest
value there and at the start over the least, on the velocities that constraints allow; the worst and
where; places: {t, condition} where it exceeds 1e4; change: the times between which its inertia, the
number of negative values, changes, and the motion ends; failure: the code that ended the run, if
one did. why names the coordinate that loses its inertia.]])

return M
