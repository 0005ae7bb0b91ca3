--- dm.mpi: what mpirun has started several times works together: mpirun dmlua -l dm.mpi script.lua.
-- Every rank runs the whole script; sweeps are shared out (dm.sweep.ranks), and what they return is
-- the same on every rank. One rank alone prints and writes files.
local apart = require "dm.mpi.apart"
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local values = require "dm.mpi.values"

local rank, size = core.ranks_open()

local M = { rank = rank, size = size }

-- tags of messages: those of sweeps are in dm.sweep.ranks
local MAP, GATHER = 1, 2

if rank > 0 then
  function print() end -- luacheck: ignore
end

-- of rank `root` on every rank
local function broadcast(value, root)
  local bytes = core.ranks_broadcast(root, rank == root and values.pack(value) or nil)
  return values.unpack(bytes)
end

local doc_broadcast = [[
dm.mpi.broadcast(value) -> value
The value of rank 0 on every rank; what the others give is not looked at.]]

M.broadcast = blame.caller(function(value) return broadcast(value, 0) end)

local doc_gather = [[
dm.mpi.gather(value) -> table or nil
On rank 0 the list of the values of all ranks, [1] that of rank 0; nil on the others.]]

local function gather(value, tag)
  if rank > 0 then
    core.ranks_send(0, tag, values.pack(value))
    return nil
  end
  local out = { value }
  for r = 1, size - 1 do out[r + 1] = values.unpack((core.ranks_receive(r, tag))) end
  return out
end

M.gather = blame.caller(function(value) return gather(value, GATHER) end)

local doc_map = [[
dm.mpi.map(f, n) -> table
The list f(1), ..., f(n) on every rank. Rank r calls f for r + 1, r + 1 + size, ...; what f raises
ends all ranks.]]

M.map = blame.caller(function(f, n)
  if type(f) ~= "function" then
    option.fail("dm.mpi.map", "a function is needed (got %s)", option.got(f))
  end
  if not lists.whole(n) or n < 0 then
    option.fail("dm.mpi.map", "how many must be a whole number >= 0 (got %s)", option.got(n))
  end
  local own = {}
  for i = rank + 1, n, size do own[i] = apart.run(f, i) end
  local all, out = gather(own, MAP), {}
  if all then
    for i = 1, n do out[i] = all[(i - 1) % size + 1][i] end
  end
  return broadcast(out, 0)
end)

M.barrier = blame.caller(function() core.ranks_barrier() end)
M.abort = blame.caller(function(code) core.ranks_abort(code) end)

core.docs[M.map], core.docs[M.gather] = doc_map, doc_gather
core.docs[M.broadcast] = doc_broadcast
core.docs[M.barrier] = "dm.mpi.barrier()\nWait until every rank is here."
core.docs[M.abort] = "dm.mpi.abort(code)\nEnd all ranks with this status (default 1)."

return M
