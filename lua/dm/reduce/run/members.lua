--- Members of ensembles of a reduced system that lost their way: found as in runs of their own
-- (failure.lua), which are made again for all members where these take few steps in all, else for
-- those whose energy has moved most.
local blame = require "dm.base.blame"
local core = require "dm.core"
local failure = require "dm.reduce.run.failure"
local lists = require "dm.base.lists"
local routh = require "dm.reduce.routh"

local M = {}

local abs, min = math.abs, math.min

-- steps of all members that are made again in any case; members that are looked at for their
-- energy, more than FEW only where each takes LONG steps, since a look costs as much as 20; how far
-- it must have moved for one to be made again; of these so many
local FEW_STEPS, MOST, FEW, LONG, SUSPECT, AGAIN = 20000, 100000, 1000, 500, 0.02, 256

-- ensemble -> failures of its members that are not known to it, { [member] = failure }
local found = setmetatable({}, { __mode = "k" })

---- the starts ----

-- f(i), kept, since it may give something else when it is asked again
local function remembered(source, members, key)
  if type(source) ~= "function" or members > MOST then return source, source end
  local kept = {}
  source = core.one(source, key)
  return function(i)
    local value = source(i)
    kept[i] = type(value) == "table" and lists.copy(value) or value
    return value
  end, kept
end

local SOURCES = { "q", "v", "p", "h" }

-- the options with such sources, and what they gave
local function remember(options)
  local out, kept = lists.copy(options), {}
  local members = lists.whole(options.members) or 0
  for _, key in ipairs(SOURCES) do
    if type(options[key]) == "function" then
      out[key], kept[key] = remembered(options[key], members, key)
    else
      kept[key] = options[key]
    end
  end
  kept.vary = {}
  if type(options.vary) == "table" then
    out.vary = {}
    for name, source in pairs(options.vary) do
      out.vary[name], kept.vary[name] = remembered(source, members, name)
    end
  end
  return out, kept
end

---- one of them again ----

local function with_params(system, kept, i)
  if not next(kept.vary) then return system end
  local given, params = lists.copy(system.given), lists.copy(system.params or {})
  for name, values in pairs(kept.vary) do params[name] = values[i] end
  given.params = params
  return core.system(given)
end

-- the failure of the run of member i, or nothing
local function run_again(run, e, options, kept, i)
  local solver = e.solver
  local system, h = with_params(solver.system, kept, i), kept.h and kept.h[i] or solver.h
  if system ~= solver.system or h ~= solver.h then
    solver = system:solver { rule = solver.rule, h = h,
      newton = { tolerance = solver.tolerance, max_iterations = solver.max_iterations } }
  end
  local fine, why = blame.try(failure.run, run, solver, { q = kept.q[i], v = kept.v and kept.v[i],
    p = kept.p and kept.p[i], t0 = options.t0, steps = e.steps[i], project = options.project })
  if not fine and type(why) == "table" and why.reason then return why end
end

---- which of them ----

-- energies of the members at these starts, a vector
local function energies(plain, solver, start, options)
  local still = { members = options.members, threads = options.threads, t0 = options.t0,
    project = options.project, steps = 0, rows = 1, watch = { "energy" } }
  for key, source in pairs(start) do still[key] = source end
  return plain(solver, still):summary("energy").first
end

-- members by how far their energy has moved, those that moved most first
local function suspects(plain, e, options, kept, info)
  if next(kept.vary) or routh.is_driven(info) or not routh.is_autonomous(info) then return {} end
  local before = energies(plain, e.solver, { q = kept.q, v = kept.v, p = kept.p }, options)
  local after = energies(plain, e.solver, { q = e.q, p = e.p }, options)
  local out, moved = {}, {}
  for i = 1, #after do
    local by = abs(after[i] - before[i])
    if not (by <= SUSPECT * abs(before[i])) and e.status[i] == "ok" then
      out[#out + 1], moved[i] = i, by
    end
  end
  table.sort(out, function(a, b) return moved[a] > moved[b] or moved[a] == moved[b] and a < b end)
  return { table.unpack(out, 1, min(#out, AGAIN)) }
end

local function candidates(plain, e, options, kept, info)
  if #e > MOST then return {} end
  if #e > FEW and e.steps[1] < LONG then return {} end
  local steps, all = 0, {}
  for i = 1, #e do
    steps = steps + e.steps[i]
    if e.steps[i] > 0 and e.status[i] == "ok" then all[#all + 1] = i end
  end
  if steps <= FEW_STEPS then return all end
  return suspects(plain, e, options, kept, info)
end

---- the ensemble ----

--- solver:ensemble of a reduced system; plain is the method without this, run that of solver:run.
function M.ensemble(plain, run, solver, options)
  if type(options) ~= "table" or options.watch then return plain(solver, options) end
  local given, kept = remember(options)
  local e = plain(solver, given)
  local fine, list = blame.try(candidates, plain, e, options, kept, routh.info(solver.system))
  for _, i in ipairs(fine and list or {}) do
    local known, why = blame.try(run_again, run, e, options, kept, i)
    if known and why then
      found[e] = found[e] or {}
      found[e][i] = why
      debug.getuservalue(e.status, 1)[i] = why.code -- the list itself, which users cannot set
    end
  end
  return e
end

--- ensemble:failures with these among them, in the order of members.
function M.failures(plain, e)
  local out = plain(e)
  for i, why in pairs(found[e] or {}) do
    out[#out + 1] = { member = i, code = why.code, step = why.step, message = why.message }
  end
  table.sort(out, function(a, b) return a.member < b.member end)
  return out
end

--- tostring of an ensemble, which counts them.
function M.text(plain, e)
  local count = 0
  for _ in pairs(found[e] or {}) do count = count + 1 end
  if count == 0 then return plain(e) end
  return ("%s, %d lost their way (see failures())"):format(plain(e):gsub(": all ok$", ""), count)
end

return M
