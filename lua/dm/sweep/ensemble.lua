--- solver:ensemble{journal =}: finished ranges of members are kept in a file, and the same call
-- goes on where it stopped.
local carrier = require "dm.sweep.carrier"
local core = require "dm.core"
local heads = require "dm.sweep.head"
local journal = require "dm.data.journal"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "solver:ensemble"
local UNIT = 256 -- members of the shortest range: lanes are full, threads have work

local fail = option.failing(WHERE)

---- starts of a range ----

-- the source of members first ... as one of members 1 ...
local function shifted(source, key, members, first, count)
  if type(source) ~= "function" and #source ~= members then
    fail("field '%s' has %d rows for %d members; the same for all is function() return ... end",
      key, #source, members)
  end
  if type(source) == "function" then return function(i) return source(i + first - 1) end end
  if type(source) == "table" then return table.move(source, first, first + count - 1, 1, {}) end
  return core.matrix_rows(source, first, count) or function(i) return source[i + first - 1] end
end

-- the options for members first .. first + count - 1
local function options_of(options, first, count)
  local out = lists.copy(options)
  out.members, out.journal = count, nil
  local members = options.members
  if first == 1 and count == members then return out end
  for _, key in ipairs { "q", "v", "p", "h" } do
    if type(options[key]) == "function" or type(options[key]) == "table"
      or type(options[key]) == "userdata" then
      out[key] = shifted(options[key], key, members, first, count)
    end
  end
  if type(options.vary) == "table" then
    out.vary = {}
    for name, source in pairs(options.vary) do
      out.vary[name] = shifted(source, name, members, first, count)
    end
  end
  return out
end

-- messages number members as the user does
local function renumbered(why, first)
  local function text(message)
    return (message:gsub("member (%d+)", function(i)
      return ("member %d"):format(tonumber(i) + first - 1)
    end))
  end
  if type(why) == "string" then return text(why) end
  if type(why) == "table" and type(why.message) == "string" then why.message = text(why.message) end
  return why
end

local function run_range(plain, solver, options, first, count)
  local results = table.pack(pcall(plain, solver, options_of(options, first, count)))
  if results[1] then return results[2] end
  error(renumbered(results[2], first), 0)
end

---- what decides the result ----

local function names_of(list)
  local out = {}
  for key, value in pairs(type(list) == "table" and list or { list }) do
    out[#out + 1] = type(key) == "string" and key or tostring(value):gsub("0x%x+", "")
  end
  table.sort(out)
  return table.concat(out, " ")
end

local function number(x)
  return type(x) == "number" and ("%.17g"):format(x) or x == nil and "-" or "by member"
end

local function head_of(solver, options)
  local head, varied = heads.of("ensemble", options.members), {}
  for name in pairs(type(options.vary) == "table" and options.vary or {}) do
    varied[#varied + 1] = name
  end
  local system = solver.system
  local n, momenta = core.sizes(system)
  local function say(key, value) head[#head + 1] = { key, value } end
  say("system", core.fingerprint(system))
  say("n", n)
  say("momenta", momenta)
  say("rule", solver.rule)
  say("h", options.h == nil and number(solver.h) or number(options.h))
  say("steps", number(options.steps))
  say("t", number(options.t))
  say("t0", number(options.t0 or 0))
  say("tolerance", number(solver.tolerance))
  say("iterations", number(solver.max_iterations))
  say("starts", options.v and "q v" or "q p")
  say("vary", names_of(varied))
  say("varied", #varied)
  say("every", number(options.every))
  say("rows", number(options.rows))
  say("watch", (options.watch and names_of(options.watch) or "-")
    .. (options.gaps and ", with gaps" or ""))
  say("project", tostring(options.project or false))
  return head
end

---- the ensemble ----

-- one finished member is run again: the file cannot see what functions of starts give
local function check_member(make, c)
  local x = c.records[1]
  if not x then return nil end
  local i, was = journal.members(x.r, journal.bytes(x.j, x.r))()
  local e = make(i, 1)
  local now = core.ensemble_pack(e)
  if ("<s4"):pack(was) == now then return e end
  fail("%s has another member %d: its start or its system gave something else then. Remove the "
    .. "file, or give another name", x.j.name, i)
end

local function unpack_into(e, x, name)
  if not core.ensemble_unpack(e, x.first, x.count, x.bytes) then
    fail("%s has members of another ensemble: remove the file", name)
  end
end

-- runs what is missing, keeps the bytes, and puts all together
local function run(plain, solver, options, c)
  local function make(first, count) return run_range(plain, solver, options, first, count) end
  local like, whole = check_member(make, c), nil
  local function into(first, count, bytes)
    like = like or make(first, 1) -- a rank that has run nothing yet
    whole = whole or core.ensemble_like(like, options.members)
    unpack_into(whole, { first = first, count = count, bytes = bytes }, c.file)
  end
  local fine, why = pcall(carrier.run, c, UNIT, function(first, count)
    local e = make(first, count)
    like = like or e
    return core.ensemble_pack(e)
  end, into)
  if fine then return whole end
  if type(why) == "table" and why.code == "stopped" and whole then why.path = whole end
  error(why, 0)
end

--- solver:ensemble with a journal; plain is the method without. journals[e] is told of it.
function M.ensemble(plain, solver, options, journals)
  local file = option.text(options, "journal", WHERE)
  local members = option.whole(options, "members", WHERE, 1, 1 << 53)
  if not members then return plain(solver, options_of(options, 1, 1)) end -- says what is missing
  options = lists.copy(options)
  options.members = members
  local c = carrier.open(WHERE, file, head_of(solver, options), members)
  return carrier.guarded(c, function()
    local e = run(plain, solver, options, c)
    carrier.leave_if_part(c)
    journals[e] = carrier.result(c)
    return e
  end)
end

return M
