-- make bench: what a journal costs an ensemble, how fast a complete one is opened, and two ranks
-- beside two threads (where `make mpi` has built dm/mpi.so and mpirun is there). s of wall time.
local dm = require "dm"

local MEMBERS, STEPS, TURNS = 1000000, 1000, 2

local MODEL = [[
local dm = require "dm"
local solver = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }:solver { rule = "verlet", h = 0.1 }
]]
local solver = assert(load(MODEL .. "return solver"))()
local q, v = {}, {}
for i = 1, MEMBERS do q[i], v[i] = { i / MEMBERS }, { 0 } end
q, v = dm.matrix(q), dm.matrix(v)

local function seconds(f)
  local t = dm.clock()
  f()
  return dm.clock() - t
end
local file = os.tmpname() .. ".journal"
local function run(journal)
  return seconds(function()
    solver:ensemble { members = MEMBERS, q = q, v = v, steps = STEPS, journal = journal }
  end)
end
local plain, with, again = math.huge, math.huge, math.huge
for _ = 1, TURNS do
  plain = math.min(plain, run())
  os.remove(file)
  with = math.min(with, run(file))
  again = math.min(again, run(file))
end
os.remove(file)
print(("%d pendulums, %d steps of Verlet: %.2f s; with a journal %.2f s, %.2f times; a complete one %.2f s"):format(
  MEMBERS, STEPS, plain, with, with / plain, again))

-- ranks: the time of a sweep, each started for itself
local dmlua = arg[-1]
local module = io.open((dmlua:gsub("[^/]*$", "dm/mpi.so")))
local there = io.popen "command -v mpirun 2>/dev/null":read "l"
if not (module and there) then
  print "skipped  ranks: make mpi, install openmpi-bin"
  return
end
local script = os.tmpname()
local f = assert(io.open(script, "w"))
f:write(MODEL .. [[
local t = dm.clock()
local e = solver:ensemble { members = 400000, q = function(i) return { i/4e5 } end, v = function() return { 0 } end, steps = 4000,
  threads = tonumber(arg[1]), journal = arg[2] }
print(dm.clock() - t)
]])
f:close()
local function timed(before, words)
  os.remove(file)
  local pipe = io.popen(("%s '%s' %s '%s' %s '%s' 2>/dev/null"):format(before, dmlua, before == "" and "" or "-l dm.mpi", script, words, file))
  local out = pipe:read "n"
  pipe:close()
  return out or 0 / 0
end
local threads, ranks = math.huge, math.huge
for _ = 1, TURNS do
  threads = math.min(threads, timed("", "2"))
  ranks = math.min(ranks, timed("mpirun -n 2 --oversubscribe --allow-run-as-root", "1"))
end
-- what rank 0 does for a range of 64 rows of 64 bytes, its journal included, and nothing else to do
f = assert(io.open(script, "w"))
f:write [[
local mpi, core, ranks, journal = require "dm.mpi", require "dm.core", require "dm.sweep.ranks", require "dm.data.journal"
local RANGES, missing, bytes = 20000, {}, ("x"):rep(64 * 64)
for k = 1, RANGES do missing[k] = { 65 * k, 65 * k + 63 } end
local j = mpi.rank == 0 and assert(journal.read(arg[1], true))
if j then journal.begin(j, { { "kind", "bench" } }) end
local function make() return bytes end
mpi.barrier()
local t = core.clock()
ranks.run(mpi, missing, make, function(first, count, rows) journal.add(j, first, count, rows) end)
if mpi.rank == 0 then print((core.clock() - t) / RANGES * 1e6) end
]]
f:close()
local handing = math.huge
for _ = 1, TURNS do handing = math.min(handing, timed("mpirun -n 2 --oversubscribe --allow-run-as-root", file)) end
print(("rank 0: %.1f us a range of 64 rows of 64 bytes, journal included"):format(handing))
local pipe = io.popen(("ldd '%s' 2>/dev/null | grep -ci mpi"):format(dmlua))
print("libraries of MPI that dmlua is linked with: " .. pipe:read "n")
pipe:close()
print(("two threads %.2f s, two ranks %.2f s: %.2f of the speed"):format(threads, ranks, threads / ranks))
os.remove(script)
os.remove(file)
