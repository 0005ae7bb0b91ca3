--- A sweep by the ranks of dm.mpi. Rank 0 knows what is missing, hands ranges out and alone writes
-- the journal; it runs ranges too, short ones, so that nobody waits for it long.
local apart = require "dm.mpi.apart"
local core = require "dm.core"
local pace = require "dm.sweep.pace"

local M = {}

local ASK, ORDER, RESULT = 11, 12, 13 -- tags
M.LEAST = 64                          -- members of a range
local ANSWER = 0.01                   -- s after which rank 0 looks for requests
local NAP = 1e-4                      -- s, where it has nothing else to do

--- { rank, size } where there are several ranks that share work out here, or nothing.
function M.here()
  local mpi = package.loaded["dm.mpi"]
  return mpi and mpi.size > 1 and not apart.is_here() and mpi or nil
end

--- Are so many members without a journal shared out? Fewer are run by every rank for itself.
function M.shares(members) return M.here() ~= nil and members > M.LEAST end

-- ranges of what is missing, of the length that is asked for
local function taker(missing)
  local k, at, left = 1, missing[1] and missing[1][1], 0
  for _, range in ipairs(missing) do left = left + range[2] - range[1] + 1 end
  return function(size)
    local range = missing[k]
    if not range then return nil end
    local first, count = at, math.min(size or left, range[2] - at + 1)
    at, left = at + count, left - count
    if at > range[2] then
      k = k + 1
      at = missing[k] and missing[k][1]
    end
    return first, count
  end, function() return left end
end

-- guided: (members left)/(4 ranks)
local function guided(left, ranks) return math.max(M.LEAST, left // (4 * ranks)) end

-- the first range of every rank is known to all without a word
local function first_range(take, left, rank, ranks)
  local size, first, count = guided(left(), ranks), nil, nil
  for r = 1, ranks - 1 do
    local at, many = take(size)
    if r == rank then first, count = at, many end
  end
  return first, count
end

-- rank > 0: ask for the next range, run this one, tell the result
local function serve(mpi, missing, make)
  local take, left = taker(missing)
  local first, count = first_range(take, left, mpi.rank, mpi.size)
  while first do
    core.ranks_send(0, ASK, "")
    core.ranks_send(0, RESULT, ("<i8i8"):pack(first, count) .. make(first, count))
    first, count = ("<i8i8"):unpack((core.ranks_receive(0, ORDER)))
    if count == 0 then first = nil end
  end
end

-- rank 0: every range that is given brings one request and one result
local function lead(mpi, missing, make, keep)
  local take, left = taker(missing)
  local requests, results, size = 0, 0, pace(M.LEAST, ANSWER)
  local function give(count)
    local first, many = take(count)
    if first then requests, results = requests + 1, results + 1 end
    return first or 0, many or 0
  end
  local function answer()
    local asked, from = core.ranks_receive(nil, ASK, true)
    if not asked then return false end
    requests = requests - 1
    core.ranks_send(from, ORDER, ("<i8i8"):pack(give(guided(left(), mpi.size))))
    return true
  end
  local function collect()
    local result = core.ranks_receive(nil, RESULT, true)
    if not result then return false end
    local first, count = ("<i8i8"):unpack(result)
    results = results - 1
    keep(first, count, result:sub(17))
    return true
  end
  local length = guided(left(), mpi.size)
  for _ = 1, mpi.size - 1 do give(length) end
  while true do
    while answer() or collect() do end
    local first, count = take(size())
    if not first then break end
    local began = core.clock()
    keep(first, count, make(first, count))
    if count == size() then size(core.clock() - began) end
  end
  while requests > 0 or results > 0 do
    if not (answer() or collect()) then core.nap(NAP) end
  end
end

--- Run what is missing on all ranks; keep(first, count, bytes) is called on rank 0.
function M.run(mpi, missing, run, keep)
  local function make(first, count) return apart.run(run, first, count) end
  if mpi.rank == 0 then lead(mpi, missing, make, keep) else serve(mpi, missing, make) end
end

return M
