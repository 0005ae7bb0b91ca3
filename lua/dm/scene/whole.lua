--- The problem of a scene whose system is taken as it is: on a group, watched by entries of the
-- element, momenta, the energy, or functions(g, xi, t, mu); or with an H that no Lagrangian has,
-- watched by coordinates, momenta, the energy, or functions(q, v, t, p). Models with fewer terms or
-- coordinates are not looked for: a group has none, and terms are those of a Lagrangian.
local blame = require "dm.base.blame"
local option = require "dm.base.options"
local observed = require "dm.measure.observed"
local pilot = require "dm.scene.pilot"
local watch = require "dm.scene.watch"

local M = {}

local fail = option.failing "dm.scene"

-- what is watched under a name, as solver:run takes it
local function of_name(system, name)
  if name == "energy" or not system.place then return name end
  local found = observed.of(system.place, name)
  if found then return found end
  fail("option 'watch': there is no '%s'; on %s watch entries of the element (R31, of factor k "
    .. "R31_k), body momenta (p1), \"energy\", or name = function(g, xi, t, p) ... end", name,
    tostring(system.Q))
end

-- functions by their names; "energy" as an entry of the list
local function functions(system, given)
  if given == "picture" then given = watch.names(system) end
  if type(given) == "function" then given = { watched = given } end
  if type(given) == "string" then given = { given } end
  if type(given) ~= "table" then
    fail("option 'watch' must be a list of names and functions (got %s)", option.got(given))
  end
  local out = {}
  for key, value in pairs(given) do
    if type(value) == "string" then
      local f = of_name(system, value)
      out[f == value and #out + 1 or value] = f
    elseif type(key) == "string" and type(value) == "function" then
      out[key] = value
    else
      fail("option 'watch': entry '%s' must be a name, or name = function(%s, t, p) ... end",
        tostring(key), system.place and "g, xi" or "q, v")
    end
  end
  if next(out) == nil then fail("nothing is watched: name entries or functions in 'watch'") end
  return out
end

local TINY = 1e-6  -- of the time: what is watched is asked for its columns

-- the first of these steps it: on groups some have no lift, and an H may have no Lagrangian
local FIRST = { "lie(1)", "gauss(1)", "rkmk4" }

-- the path of a short step; raises why none can be made
local function short_step(problem, h, options)
  local why
  for _, rule in ipairs(FIRST) do
    local fine, path = blame.try(function()
      return problem.system:solver({ rule = rule, h = h }):run(options)
    end)
    if fine then return path end
    local words = pilot.first_line(path)
    if not why or not pilot.is_refusal(words) then why = words end
  end
  fail("%s", why)
end

-- the columns that what is watched makes, seen by a short step
local function columns_of(problem)
  local h, options = TINY * problem.T, { watch = problem.watched, at = {} }
  for key, value in pairs(problem.start) do options[key] = value end
  options.at[1] = problem.t0 + h
  local path = short_step(problem, h, options)
  local out = {}
  for _, name in ipairs(path.columns) do
    if name ~= "t" then out[#out + 1] = name end
  end
  table.sort(out)
  return out
end

--- The problem: system, start, what is watched.
function M.problem(system, options)
  local t0, own = options.t0 or 0, system.place
  local problem = { system = system, given = system.given,
    n = own and own.dimension or system.Q.dimension, names = {}, t0 = t0, T = options.until_t - t0,
    project = options.project, needs = { q = {}, v = {} }, q = {}, tolerance = {},
    whole = own and "it lives on " .. tostring(system.Q) or "it is given by an H without a "
      .. "Lagrangian, whose terms are not taken apart",
    start = { q = options.q, v = options.v, p = options.p, t0 = t0, project = options.project } }
  for i = 1, problem.n do problem.names[i] = "q" .. i end
  problem.watched = functions(system, options.watch)
  problem.columns = columns_of(problem)
  for _, column in ipairs(problem.columns) do
    problem.tolerance[column] = watch.tolerance_of(options.tolerance, column)
  end
  return problem
end

--- Is it such a system?
function M.is(system) return system.place ~= nil or not system.given.L end

--- Options that mean coordinates, or terms.
function M.check(system, options)
  if options.symmetry ~= nil then
    fail("option 'symmetry': models are looked for %s; leave it out", system.place
      and "in coordinates, and this system lives on " .. tostring(system.Q)
      or "among the terms of a Lagrangian, and this system has only H")
  end
  if options.watch == "picture" and system.place then
    fail("watch = \"picture\" is every coordinate, and this system lives on %s: name entries of "
      .. "the element (R31) or functions(g, xi, t, p)", tostring(system.Q))
  end
end

return M
