--- Starts of runs on groups as a user writes them: what an element looks like, in words and as an
-- example, for messages and help; elements, velocities, momenta as flat coordinates. place.lua has
-- what a place is; C asks through M.ask.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local places = require "dm.group.place"
local wanted = require "dm.base.options"

local M = {}

---- the form of an element ----

local LONGEST = 60  -- characters of an example

-- an element as it is written in Lua
local function written(g)
  local class = kits.class_of(g)
  if class ~= "table" and class ~= "dm.vector" and class ~= "dm.matrix" then
    return ("%.6g"):format(g)
  end
  local out = {}
  for i = 1, #g do out[i] = written(g[i]) end
  return "{" .. table.concat(out, ", ") .. "}"
end

-- G:exp of a small vector of the algebra
local function near_identity(kit)
  local out = {}
  for k = 1, kit.dimension do out[k] = ("%g"):format(k / 10) end
  return ("G:exp{%s}"):format(table.concat(out, ", "))
end

--- "a matrix of 2 x 2, for instance {{1, 0}, {0, 1}} or G:exp{0.1}", of the kit of a group
function M.form(kit)
  local example, other = written(kit.identity()), near_identity(kit)
  local short = #example <= LONGEST and example
  local long = #other <= LONGEST and other
  local both = short and long and short .. " or " .. long or short or long or "G:identity()"
  return ("%s, for instance %s"):format(kit.form, both)
end

---- starts ----

local LOOSE = 1e-9  -- how far a start may be off its group

local function form_of(place)
  return ("an element of %s is %s"):format(tostring(place.space), M.form(place.kit))
end

-- what else was meant by four numbers, or by a table of options; or ""
local function mistaken(place, q)
  if type(q) == "table" and q.q ~= nil then return " (q and v come one after the other)" end
  if place.kit.form == "a matrix of 3 x 3" and lists.count(q) == 4 and type(q[1]) == "number" then
    return " (a unit quaternion is an element of dm.SU(2))"
  end
  return ""
end

--- Flat coordinates of the element q, which is on the group or (project) brought there; asked: of
-- a state that is no start, which is never brought.
function M.on_group(place, q, project, asked)
  local kit = place.kit
  local fine, g = blame.try(kit.element, q)
  if not fine then
    error(("field 'q': %s%s; %s"):format(blame.bare(g), mistaken(place, q), form_of(place)), 0)
  end
  local defect, why = kit.defect(g)
  if defect <= LOOSE then
    local list = place.flat(g)
    if kits.is_finite(list) then return list end
  end
  local name = tostring(place.space)
  if not kits.is_finite(kit.entries(g)) then
    error(("field 'q': the element of %s is not finite"):format(name), 0)
  end
  local can, near = blame.try(kit.project, g)
  local found = can and kit.defect(near) <= LOOSE
  if project and found then return place.flat(near) end
  error(("field 'q': this is no element of %s, %s%s"):format(name,
    why or ("it is off by %.3g"):format(defect),
    found and (asked and ": G:project(g) is an element near it"
      or ": project = true starts at the nearest one") or can and "" or ": " .. near), 0)
end

-- a reduced system (dm.euler_poincare) knows its own start
local function start_reduced(place, options, out)
  if place.reduced then place.reduced.start(options, out) end
  if out.a ~= nil then
    error("field 'a': this system carries no quantity along (dm.euler_poincare, advected =)", 0)
  end
end

-- q, v, p in flat coordinates, in a copy of the options
local function flat_options(place, options, asked)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  if options.q0 ~= nil or options.q1 ~= nil then
    error(("field '%s': a system on %s starts from q and v or from q and p")
      :format(options.q0 ~= nil and "q0" or "q1", tostring(place.space)), 0)
  end
  if options.q ~= nil then
    out.q = core.vector(M.on_group(place, options.q, options.project, asked))
  end
  if options.v ~= nil then out.v = places.padded(place, options.v, "field 'v'") end
  if options.p ~= nil then out.p = places.padded(place, options.p, "field 'p'") end
  return out
end

-- there is no element
local function refuse_missing(place, options)
  if options.q ~= nil or options.q0 ~= nil or options.q1 ~= nil then return end
  if place.reduced then
    error(("fields 'v' and 'p' are missing: a reduced run begins with one of them, %d numbers")
      :format(place.dimension), 0)
  end
  error(("field 'q' is missing: %s"):format(form_of(place)), 0)
end

--- The options of a run that goes on from a checkpoint, which has q and p of its own.
function M.more(place, options)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  start_reduced(place, options, out)
  return flat_options(place, out)
end

--- q, v, p of a run in flat coordinates, in a copy of its options.
function M.start(place, options)
  if not place.reduced and options.a == nil then
    refuse_missing(place, options)
    return flat_options(place, options)
  end
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  start_reduced(place, options, out)
  refuse_missing(place, out)
  return flat_options(place, out)
end

--- The same of a position that a system is asked about; a reduced one takes its usual quantity, or
-- that of its last run.
function M.position(place, options)
  local reduced = place.reduced
  if options.q == nil then
    error(("the element q is missing, argument 1: %s"):format(form_of(place)), 0)
  end
  if reduced then reduced.a = reduced.usual or reduced.a end
  return flat_options(place, options, true)
end

--- The same of a position with v or p.
function M.state(place, options)
  local out = M.position(place, options)
  if out.v == nil and out.p == nil then
    error(("argument 2 behind the element is missing: a vector of %d numbers")
      :format(place.dimension), 0)
  end
  return out
end

-- the source of members `key`, a function of their number or a table, with `how` of each
local function each(source, how, key)
  if type(source) == "function" then
    source = wanted.single(source, key)
    return function(i) return how(source(i), i) end
  end
  local out = {}
  if not lists.count(source) then return source end -- refused where it is read
  for i = 1, #source do out[i] = how(source[i], i) end
  return out
end

--- q, v, p of the members of an ensemble, in a copy of its options.
function M.starts(place, options)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  start_reduced(place, options, out)
  if options.q ~= nil then
    out.q = each(options.q, function(q) return M.on_group(place, q, options.project) end,
      "q")
  elseif out.q ~= nil then
    local flat = place.flat(out.q)
    out.q = function() return flat end
  end
  for _, key in ipairs { "v", "p" } do
    if options[key] ~= nil then
      out[key] = each(options[key], function(x, i)
        return places.padded(place, x, ("'%s' of member %d"):format(key, i))
      end, key)
    end
  end
  return out
end

--- M[how](place, x) for C: true and the value, or false and a message without a line in here, which
-- C raises at the line of its caller.
function M.ask(how, place, x)
  local fine, value = blame.try(M[how], place, x)
  if fine then return true, value end
  if type(value) ~= "string" then error(value, 0) end
  return false, blame.bare(value)
end

return M
