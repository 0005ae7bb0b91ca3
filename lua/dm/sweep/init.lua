--- dm.sweep: the user's own function of a member's number, many times, by processes and journals.
local blame = require "dm.base.blame"
local carrier = require "dm.sweep.carrier"
local core = require "dm.core"
local heads = require "dm.sweep.head"
local join = require "dm.sweep.join"
local journal = require "dm.data.journal"
local option = require "dm.base.options"
local parts = require "dm.sweep.part"
local report = require "dm.sweep.report"
local workers = require "dm.sweep.workers"

local M = { journal = report.journal, part = parts.part }

local WHERE = "dm.sweep"
local KNOWN = { "members", "run", "journal", "workers" }

local fail = option.failing(WHERE)

---- what a member returns ----

-- a column of such a name would hide what a sweep has
local RESERVED = { columns = true, status = true, failed = true, failures = true, journal = true,
  csv = true, npy = true, plot = true, member = true }

-- x1, x2, ... of the n entries of a list
local function numbered(value, n)
  local names, numbers = {}, {}
  for k = 1, n do names[k], numbers[k] = "x" .. k, value[k] end
  return names, numbers
end

-- names and numbers of a table: those of a list, or names in the alphabet's order; none of one that
-- is both or neither
local function of_table(value)
  local names, numbers, integers = {}, {}, 0
  for key in pairs(value) do
    if math.type(key) == "integer" then integers = integers + 1
    elseif type(key) == "string" then names[#names + 1] = key
    else return {}, {} end
  end
  if integers > 0 then
    if integers ~= #value or #names > 0 then return {}, {} end
    return numbered(value, integers)
  end
  table.sort(names)
  for k, name in ipairs(names) do numbers[k] = value[name] end
  return names, numbers
end

-- names and numbers of what run gave; raises where it is something else
local function columns_of(value, i)
  if type(value) == "number" then return { "value" }, { value } end
  local names, numbers = {}, {}
  value = core.unlocked(value)
  if type(value) == "table" then names, numbers = of_table(value) end
  if option.got(value) == "dm.vector" then names, numbers = numbered(value, #value) end
  for k, x in ipairs(numbers) do
    if RESERVED[names[k]] then
      fail("member %d: '%s' cannot be a column: a sweep has that name itself", i, names[k])
    end
    if type(x) ~= "number" then
      fail("member %d: '%s' must be a number (got %s)", i, names[k], option.got(x))
    end
  end
  if #names == 0 then
    fail("member %d: run must return a number, a list of numbers or named numbers (got %s)", i,
      option.got(value))
  end
  return names, numbers
end

local MOST_BYTES = 0xffff  -- of a text behind its length, u16

-- Of a member: its code and, of "ok", the names of its columns (each text behind its length, u16)
-- and its numbers (f64); of another one the step and the message of its failure.
local function member_bytes(run, i)
  local results = table.pack(pcall(run, i))
  local value = results[2]
  if results[1] then
    if results.n > 2 then
      fail("member %d: run must return one value (got %d)", i, results.n - 1)
    end
    local names, numbers = columns_of(value, i)
    local line = table.concat(names, "\t")
    if #line > MOST_BYTES then
      fail("member %d: the names of its %d columns take %d bytes, %d at most: return fewer "
        .. "numbers, and write the rest to a file", i, #names, #line, MOST_BYTES)
    end
    for k, x in ipairs(numbers) do numbers[k] = ("<d"):pack(x) end
    return ("<s2s2"):pack("ok", line) .. table.concat(numbers)
  end
  local meta = type(value) == "table" and getmetatable(value)
  if meta and meta.__name == "dm.failure" and value.code ~= "stopped" then
    return ("<s2i8s4"):pack(value.code, value.step or 0, tostring(value.message))
  end
  if blame.is_stop(value) then error("interrupted!", 0) end
  fail("member %d: %s", i, blame.bare(tostring(value)))
end

local function read_member(bytes)
  local code, at = ("<s2"):unpack(bytes)
  if code ~= "ok" then
    local step, message = ("<i8s4"):unpack(bytes, at)
    return { code = code, step = step, message = message }
  end
  local names
  names, at = ("<s2"):unpack(bytes, at)
  local count = select(2, names:gsub("\t", "")) + 1
  if #bytes - at + 1 ~= 8 * count then error "not as many numbers as names" end
  return { code = code, names = names, at = at, bytes = bytes }
end

M.read_member = read_member

---- the result ----

local Sweep = core.class({ __name = "dm.sweep" }, [[
dm.sweep: what dm.sweep{run =} has found, a row for each member
fields: columns (names), a dm.vector for each of them (NaN where a member failed), status[i] ("ok"
or a code of dm.failure), journal ({ file, found, run } where there is one); #sweep members]])

function Sweep.__len(s) return #s.status end

-- ", NaN in value of 2" of columns in which members that are ok have it
local function nan_text(s)
  local out = ""
  for _, name in ipairs(s.columns) do
    local count = 0
    for i = 1, #s do
      if s.status[i] == "ok" and s[name][i] ~= s[name][i] then count = count + 1 end
    end
    if count > 0 then out = out .. (", NaN in %s of %d"):format(name, count) end
  end
  return out
end

function Sweep.__tostring(s)
  local failed = #s:failures()
  return ("sweep of %d members (%s): %s%s"):format(#s, table.concat(s.columns, ", "),
    failed == 0 and "all ok" or failed .. " failed (see failures())", nan_text(s))
end

core.method("dm.sweep", "failures", blame.caller(function(s)
  local out = {}
  for i, m in pairs(rawget(s, "failed")) do
    out[#out + 1] = { member = i, code = m.code, step = m.step, message = m.message }
  end
  table.sort(out, function(a, b) return a.member < b.member end)
  return out
end), [[
sweep:failures() -> table of {member, code, step, message}
The members whose run raised a dm.failure.]])

-- the column of that name, the numbers of members among them
local function column_of(s, name)
  if name == "member" then
    local out = {}
    for i = 1, #s do out[i] = i end
    return out
  end
  for _, known in ipairs(s.columns) do
    if known == name then return s[name] end
  end
  fail("no column '%s'; there are member, %s", tostring(name), table.concat(s.columns, ", "))
end

-- what dm.data.export writes: columns and rows
local function as_rows(s)
  local columns = table.move(s.columns, 1, #s.columns, 2, { "member" })
  local rows = { columns = columns }
  function rows.column(_, name) return column_of(s, name) end
  return setmetatable(rows, { __len = function() return #s end })
end

core.method("dm.sweep", "csv", blame.caller(function(s, file)
  return require "dm.data.export".csv(as_rows(s), file)
end), [[
sweep:csv(file) -> file name   or   sweep:csv() -> string
A line for each member: its number and its columns with 17 significant digits, nan where it
failed.]])

core.method("dm.sweep", "npy", blame.caller(function(s, file)
  return require "dm.data.export".npy(as_rows(s), file)
end), [[
sweep:npy(file) -> file name
The same as records of NumPy, which dm.load reads, too.]])

core.method("dm.sweep", "plot", blame.caller(function(s, x, y, options)
  if options ~= nil and type(options) ~= "table" then
    option.fail("sweep:plot", "takes a table of options (got %s)", option.got(options))
  end
  local xs, ys, fine_x, fine_y = column_of(s, x), column_of(s, y), {}, {}
  for i = 1, #s do
    if s.status[i] == "ok" then fine_x[#fine_x + 1], fine_y[#fine_y + 1] = xs[i], ys[i] end
  end
  local plotted = { xlabel = x, ylabel = y, style = "points" }
  for key, value in pairs(options or {}) do plotted[key] = value end
  return require "dm.show.plot".plot(fine_x, fine_y, plotted)
end), [[
sweep:plot(x, y [, options]) -> string or nothing
Points of two columns, "member" among them, as dm.plot draws them; members that failed are left
out.]])

-- All members' columns. Bytes may come in any order; they are read in that of the members, so that
-- the first one that differs is always the same one.
local function collector(members)
  local result = { status = {}, failed = {} }
  local columns, reference
  local function names_of(m, i)
    if not reference then
      reference, result.columns, columns = { names = m.names, i = i }, {}, {}
      for name in m.names:gmatch "[^\t]+" do
        result.columns[#result.columns + 1] = name
        columns[#columns + 1] = {}
        for k = 1, members do columns[#columns][k] = 0 / 0 end
      end
    elseif m.names ~= reference.names then
      fail("member %d has the columns %s, member %d has %s", i, m.names:gsub("\t", ", "),
        reference.i, (reference.names:gsub("\t", ", ")))
    end
  end
  local function read(range)
    for i, one in journal.members(range, range.bytes) do
      local fine, m = blame.try(read_member, one)
      if not fine then fail("member %d of the journal is none of a sweep: remove the file", i) end
      result.status[i] = m.code
      if m.code == "ok" then
        names_of(m, i)
        for k, column in ipairs(columns) do column[i] = ("<d"):unpack(one, m.at + 8 * (k - 1)) end
      else
        result.failed[i] = m
      end
    end
  end
  local waiting, at = {}, 1 -- ranges by their first member; all before `at` are read
  local function put(first, count, bytes)
    waiting[first] = { first = first, count = count, bytes = bytes }
    while waiting[at] do
      local range = waiting[at]
      waiting[at], at = nil, at + range.count
      read(range)
    end
  end
  local function finish()
    local rest = {}
    for _, range in pairs(waiting) do rest[#rest + 1] = range end
    table.sort(rest, function(a, b) return a.first < b.first end)
    for _, range in ipairs(rest) do read(range) end
    result.columns = result.columns or {}
    for k, name in ipairs(result.columns) do
      if result[name] == nil then result[name] = core.vector(columns[k]) end
    end
    return setmetatable(result, Sweep)
  end
  return put, finish
end

---- the sweep ----

local function run_all(c, run, count)
  local put, finish = collector(c.members)
  local function make(first, many)
    local pieces = {}
    for i = first, first + many - 1 do
      pieces[#pieces + 1] = ("<s4"):pack(member_bytes(run, i))
    end
    return table.concat(pieces)
  end
  carrier.run(c, 1, make, put, function(_, _, _, keep)
    workers.run(c.missing, count, make, keep)
  end)
  return finish()
end

-- one finished member is run again: nothing else tells that the function is the same
local function check_member(c, run)
  local x = c.records[1]
  if not x then return end
  local i, was = journal.members(x.r, journal.bytes(x.j, x.r))()
  if member_bytes(run, i) ~= was then
    fail("%s has another member %d: run gave something else then. Remove the file, or give another "
      .. "name", x.j.name, i)
  end
end

local doc_sweep = [[
dm.sweep{members=, run=, journal=, workers=} -> dm.sweep
Call run(i) for i = 1 .. members in processes of their own (workers; default: one a core). run
returns a number (column "value"), a list (x1, x2, ...) or named numbers: sweep.a is the column of
all members, a dm.vector. A dm.failure that it raises is the status of the member, NaN in the
columns; any other error ends the sweep and names the member. Random numbers are those of
dm.random(seed), which do not depend on the process. journal = "file": finished ranges of members
are kept there, and the same call goes on where it stopped (docs/sweeps.md). What run changes
outside of itself is lost with its process.]]

M.sweep = blame.caller(function(options)
  option.check(options, KNOWN, WHERE, "{ members =, run = }")
  option.need(options, "run", WHERE, "a function of the member's number")
  option.need(options, "members", WHERE, "how many")
  local run = option.callable(options, "run", WHERE, "the member's number")
  local members = option.whole(options, "members", WHERE, 1, 1e9)
  local file = option.text(options, "journal", WHERE)
  local count = option.whole(options, "workers", WHERE, 1, 1024, core.cores())
  if not file and parts.of_process() then
    fail("--part needs journal = \"file\", where parts are put together")
  end
  local c = carrier.open(WHERE, file, heads.of("sweep", members), members)
  return carrier.guarded(c, function()
    check_member(c, run)
    local s = run_all(c, run, math.min(count, members))
    carrier.leave_if_part(c)
    s.journal = file and carrier.result(c) or nil
    return s
  end)
end)

core.docs[M.sweep] = doc_sweep
M.join = join.join

return M
