--- Members of ensembles of a reduced system (dm.euler_poincare) that carry quantities of their own
-- along: their entries are parameters that vary, so that all members share one kernel.
local blame = require "dm.base.blame"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "solver:ensemble"

-- is there one for each member, or one for all?
local function is_of_members(a)
  return type(a) == "function" or type(a) == "table" and lists.count(a[1]) ~= nil
end

-- that of member i, of n entries
local function quantity(a, i, n)
  local what = ("'a' of member %d"):format(i)
  local value
  if type(a) == "function" then value = option.single(a, "a")(i) else value = a[i] end
  local x = lists.vector(value, what)
  if #x ~= n then
    option.fail(WHERE, "%s must have %d entries (got %d)", what, n, #x)
  end
  return x
end

--- The options of an ensemble and the solver that makes it: where `a` is a function of the member
-- or a list of quantities these are of the system with parameters a1, a2 ...
function M.of(solver, options)
  local fine, place = blame.try(function() return solver.system.place end)
  local reduced = fine and place and place.reduced
  if not reduced or type(options) ~= "table" or not is_of_members(options.a) then
    return solver, options
  end
  local out, vary, members = {}, {}, lists.whole(options.members)
  if options.vary ~= nil then
    option.fail(WHERE, "'vary' is for parameters of a system, and this reduced one has none: give "
      .. "'a' for each member")
  end
  for key, value in pairs(options) do out[key] = value end
  out.a, out.vary = nil, vary
  if not members then return solver, out end -- refused there
  if type(options.a) == "table" and #options.a ~= members then
    option.fail(WHERE, "'a' must have one quantity for each of %d members (got %d)", members,
      #options.a)
  end
  local system, names = reduced.open()
  for k, name in ipairs(names) do vary[name] = {} end
  for i = 1, members do
    local x = quantity(options.a, i, #names)
    for k, name in ipairs(names) do vary[name][i] = x[k] end
  end
  return system:solver { rule = solver.rule, h = solver.h, backend = solver.backend,
    sums = solver.sums,
    newton = { tolerance = solver.tolerance, max_iterations = solver.max_iterations } }, out
end

return M
