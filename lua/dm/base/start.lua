--- The start of a run as a caller gives it: the number of an only coordinate becomes a list of one,
-- numbers by the names of coordinates ({ x = 1, y = 0 }) a list in their order.
local count_of = require("dm.base.lists").count
local blame = require "dm.base.blame"
local option = require "dm.base.options"

local M = {}

local KEYS = { "q", "v", "p", "q0", "q1", "p0", "u", "dp" }

-- a table without a list in it, and with a name for a key
local function is_named(x)
  return type(x) == "table" and getmetatable(x) == nil and rawlen(x) == 0
    and type(next(x)) == "string"
end

-- the entries in the order of the coordinates; as solver:run reads them
local function unnamed(x, system, key)
  local names, out, known = system.coordinates, {}, {}
  if not names then
    names = {}
    for i = 1, system.Q.dimension do names[i] = "q" .. i end
  end
  for i, name in ipairs(names) do out[i], known[name] = x[name], true end
  for name in pairs(x) do
    if not known[name] then
      option.fail(("field '%s'"):format(key), "there is no coordinate '%s'; they are %s",
        tostring(name), table.concat(names, ", "))
    end
  end
  for i, name in ipairs(names) do
    if out[i] == nil then
      option.fail(("field '%s'"):format(key),
        "the coordinate '%s' is missing; all of %s are needed", name, table.concat(names, ", "))
    end
  end
  return out
end

--- Raises where a start has both v and p, of which one would not be looked at; `where` begins the
-- message, or nothing does.
function M.check_one(options, where)
  if options.v ~= nil and options.p ~= nil then
    error((where and where .. ": " or "") .. "give the start as q and v or as q and p, not both", 0)
  end
end

--- One position, velocity or momentum, called `key` in messages.
function M.list(x, system, key)
  local field = system and system.field
  if field and type(field) ~= "function" then x = field.start(x, key) end -- a mesh has a method
  if type(x) == "number" then return { x } end
  if system and is_named(x) then return unnamed(x, system, key) end
  if x ~= nil and key ~= "u" and key ~= "dp" and not count_of(x) then
    option.fail(("field '%s'"):format(key), "a list of numbers is needed (got %s)", option.got(x))
  end
  return x
end

-- a reduced system (dm.euler_poincare), or a solver of one, whose usual quantity is a
local function with_quantity(of, a)
  local system = of.system or of
  local own = system.place.reduced.with(a)
  if own == system or not of.system then return own end
  return own:solver { rule = of.rule, h = of.h, backend = of.backend, sums = of.sums,
    newton = { tolerance = of.tolerance, max_iterations = of.max_iterations } }
end

-- the start of a reduced system, in `out`, and what has its quantity
local function reduced(out, of, system)
  local place = system and system.place
  if not (place and place.reduced) then
    if system and out.a ~= nil then
      option.fail("field 'a'", "this system carries no quantity along (dm.euler_poincare, "
        .. "advected =)")
    end
    return out, of
  end
  if out.a ~= nil then of, out.a = with_quantity(of, out.a), nil end
  local own = (of.system or of).place
  own.reduced.start(out, out)
  return out, of
end

--- A copy of the options with q, v, p (and tangent vectors u, dp) as lists; `of`: a system or a
-- solver of one, without it names stay. A reduced system (dm.euler_poincare) begins at the
-- identity. Second the system or solver: of a reduced one with option a, that with this quantity.
function M.lists(options, of)
  if type(options) ~= "table" then return options, of end
  local system = type(of) == "userdata" and (of.system or of)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  for _, key in ipairs(KEYS) do
    if out[key] ~= nil then out[key] = M.list(out[key], system, key) end
  end
  return reduced(out, of, system)
end

--- The same of options that name their system, in `system` or first: one that is reduced is
-- replaced by that with the quantity a. v and p may be functions.
function M.of_system(options)
  if type(options) ~= "table" then return options end
  local out, key = {}, options.system ~= nil and "system" or 1
  local system = options[key]
  local fine, own = blame.try(function() return system.place end)
  if not (fine and type(system) == "userdata" and own and own.reduced) then return options end
  for name, value in pairs(options) do out[name] = value end
  out, out[key] = reduced(out, system, system)
  return out
end

return M
