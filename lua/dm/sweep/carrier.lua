--- What a sweep of any kind does with its journal: find what is finished, run what is missing in
-- ranges, keep each. The kind brings a head and a function that runs a range.
local apart = require "dm.mpi.apart"
local blame = require "dm.base.blame"
local core = require "dm.core"
local journal = require "dm.data.journal"
local option = require "dm.base.options"
local pace = require "dm.sweep.pace"
local parts = require "dm.sweep.part"
local ranks = require "dm.sweep.ranks"
local values = require "dm.mpi.values"

local M = {}

local GOAL = 0.25 -- s of a range

---- what is finished ----

-- refuses a file of another sweep
local function check_head(where, j, head)
  local key, was, is = journal.difference(j.head, head)
  if not key then return end
  option.fail(where, "%s is the journal of another sweep: %s was %s and is %s. Remove the file, or "
    .. "give another name", j.name, key, was, is)
end

-- the file that is written, its lock taken
local function open_own(where, name, head)
  local j, why = journal.read(name, true)
  if not j then option.fail(where, "%s: %s", name, why) end
  j.where = where
  if j.head then check_head(where, j, head) end
  return j
end

-- the files that are only read: the whole one beside a part, and parts
local function open_others(where, file, own, head)
  local out = {}
  local names = own == file and {} or { file }
  for _, p in ipairs(parts.files(file)) do
    if p.name ~= own then names[#names + 1] = p.name end
  end
  for _, name in ipairs(names) do
    local j, why = journal.read(name)
    if j then
      check_head(where, j, head)
      out[#out + 1] = j
    elseif name ~= file and why ~= "empty" then
      option.fail(where, "%s: %s", name, why)
    end
  end
  return out
end

-- as the rank that has the files sees them
local function open_files(carrier)
  local where, file, members, p = carrier.where, carrier.file, carrier.members, carrier.part
  local own = p and parts.name(file, p.k, p.n) or file
  carrier.own = open_own(where, own, carrier.head)
  carrier.files = open_others(where, file, own, carrier.head)
  table.insert(carrier.files, 1, carrier.own)
  carrier.records = journal.ordered(carrier.files)
  for _, x in ipairs(carrier.records) do
    if x.r.first + x.r.count - 1 > members then
      option.fail(where, "%s has members that the sweep has not: remove the file", x.j.name)
    end
  end
  local first, last = 1, members
  if p and carrier.undivided then
    last = p.k == 1 and members or 0
  elseif p then
    first, last = parts.share(members, p.k, p.n)
  end
  carrier.missing = journal.gaps(carrier.records, first, last)
  carrier.left = journal.count_in(journal.gaps(carrier.records, 1, members))
  journal.begin(carrier.own, carrier.head)
end

-- ranks check that they do the same, then do what rank 0 has found
local function share(mpi, carrier)
  local head = journal.text(carrier.head)
  local zero = values.unpack(core.ranks_broadcast(0, values.pack { head = head,
    missing = carrier.missing, left = carrier.left }))
  if zero.head ~= head then
    option.fail(carrier.where, "rank %d runs another sweep than rank 0: it has %s, rank 0 has %s",
      mpi.rank, head:gsub("\n", "; "), (zero.head:gsub("\n", "; ")))
  end
  carrier.missing, carrier.left = zero.missing, zero.left
end

--- Open what there is for `members` members, in `file` or (nil) in memory: { own, files, records,
-- missing (of this process), found, left (of all) }. undivided: the first part or rank runs all.
function M.open(where, file, head, members, undivided)
  local carrier = { where = where, file = file, members = members, head = head, files = {},
    records = {}, part = file and parts.of_process(), missing = { { 1, members } },
    left = members, undivided = undivided }
  local mpi = ranks.here()
  if file and not (mpi and mpi.rank > 0) then open_files(carrier) end
  if mpi then share(mpi, carrier) end
  carrier.found = members - carrier.left
  return carrier
end

--- Close all files.
function M.close(carrier)
  for _, j in ipairs(carrier.files) do j.file:close() end
end

---- running ----

-- what is finished: into the file and to who asked
local function keeper(carrier, put)
  return function(first, count, bytes)
    if carrier.own then journal.add(carrier.own, first, count, bytes) end
    put(first, count, bytes)
  end
end

-- one range after the other
local function run_here(carrier, unit, run, keep)
  local size = pace(unit, GOAL)
  for _, range in ipairs(carrier.missing) do
    local at = range[1]
    while at <= range[2] do
      local count, began = math.min(size(), range[2] - at + 1), core.clock()
      keep(at, count, run(at, count))
      if count == size() then size(core.clock() - began) end
      at = at + count
    end
  end
end

--- Run what is missing: run(first, count) -> bytes of these members, in ranges of `unit` members or
-- more; put(first, count, bytes) takes these and what was finished before, on every rank. engine
-- (or nil) does it in place of one range after the other. What is finished stays, however it ends.
function M.run(carrier, unit, run, put, engine)
  local mpi = ranks.here()
  local pieces = {}
  local function note(first, count, bytes)
    if mpi then pieces[#pieces + 1] = { first, count, bytes } end
    put(first, count, bytes)
  end
  for _, x in ipairs(carrier.records) do note(x.r.first, x.r.count, journal.bytes(x.j, x.r)) end
  local keep = keeper(carrier, note)
  if mpi then
    if not carrier.undivided then
      ranks.run(mpi, carrier.missing, run, keep)
    elseif mpi.rank == 0 then
      apart.run(run_here, carrier, unit, run, keep)
    end
    local all = values.unpack(core.ranks_broadcast(0, mpi.rank == 0 and values.pack(pieces) or nil))
    for _, x in ipairs(mpi.rank > 0 and all or {}) do put(x[1], x[2], x[3]) end
  else
    (engine or run_here)(carrier, unit, run, keep)
  end
end

--- f(), after which the journal is on the disk and closed; what f raises goes on.
function M.guarded(carrier, f)
  local results = table.pack(pcall(f))
  local kept, why = true, nil
  if carrier.own then kept, why = pcall(journal.flush, carrier.own) end
  M.close(carrier)
  if not results[1] then error(results[2], 0) end
  if not kept then error(why, 0) end
  return table.unpack(results, 2, results.n)
end

--- A part whose sweep is not complete ends the script.
function M.leave_if_part(carrier)
  local run = journal.count_in(carrier.missing)
  if carrier.part and carrier.left > run then
    parts.leave(carrier.file, carrier.members, carrier.found + run)
  end
end

--- What result.journal is; nothing where there is no file.
function M.result(carrier)
  if not carrier.file then return nil end
  return { file = carrier.file, found = carrier.found, run = journal.count_in(carrier.missing) }
end

M.bare = blame.bare

return M
