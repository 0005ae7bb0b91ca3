-- dm.sweep: columns, failures, processes; --part, --join, signals, ranks: the same bytes from each
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local dmlua = os.getenv "DMLUA" or arg[-1]

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))
local function name(base) return folder .. "/" .. base end
local function text(file, new)
  local f <close> = assert(io.open(file, new and "wb" or "rb"))
  return new and f:write(new) or f:read "a"
end

---- values ----

local squares = dm.sweep { members = 50, run = function(i) return i * i end }
ok(#squares == 50 and squares.value[7] == 49 and squares.status[50] == "ok", "a number is column value")
ok(squares.columns[1] == "value" and #squares.columns == 1 and squares.journal == nil, "and the only one")
local lists = dm.sweep { members = 9, workers = 2, run = function(i) return { i, 1 / i } end }
ok(lists.x2[3] == 1 / 3 and lists.x1[9] == 9, "a list is x1, x2")
local vectors = dm.sweep { members = 3, run = function(i) return dm.vector { i, 2, 3 } end }
ok(vectors.x3[2] == 3, "a vector too")
local named = dm.sweep { members = 20, workers = 3, run = function(i) return { b = -i, a = i / 3, c = 0 / 0 } end }
ok(table.concat(named.columns, " ") == "a b c", "names in the alphabet's order", table.concat(named.columns, " "))
ok(named.a[20] == 20 / 3 and named.b[20] == -20 and named.c[1] ~= named.c[1], "the bits of numbers")
local dice = dm.random(3)
local random = dm.sweep { members = 30, workers = 3, run = function(i) return dice:uniform(i, 1) end }
local same = true
for i = 1, 30 do same = same and random.value[i] == dice:uniform(i, 1) end
ok(same, "random numbers by counting do not depend on the process")

local boom = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 + q[1] ^ 4 / 4 end }:solver { rule = "verlet", h = 1 }
local failing = dm.sweep { members = 12, workers = 2, run = function(i)
  if i % 4 == 0 then boom:run { q = { 3 }, v = { 0 }, steps = 30 } end
  return i
end }
local failures = failing:failures()
ok(#failures == 3 and failures[2].member == 8 and failures[2].code == "not_finite" and failures[2].step > 0, "a dm.failure is a row")
ok(failing.value[8] ~= failing.value[8] and failing.value[9] == 9 and failing.status[8] == "not_finite", "without a number")
ok(tostring(failing):find "12 members" and tostring(failing):find "3 failed", "and is counted", tostring(failing))
local all = dm.sweep { members = 3, run = function() boom:run { q = { 3 }, v = { 0 }, steps = 30 } end }
ok(#all.columns == 0 and #all:failures() == 3, "no column where all failed")

for _, workers in ipairs { 1, 3 } do
  raises("member 7: ", dm.sweep, { members = 20, workers = workers, run = function(i)
    if i >= 7 then error "my own" end
    return i
  end })
end
raises("member 5", dm.sweep, { members = 9, run = function(i) return i < 5 and { a = 1 } or { b = 1 } end })
raises("member 2: 'x1' must be a number", dm.sweep, { members = 2, run = function(i) return i == 1 and { 1 } or { "1" } end })
raises("member 1: run must return a number", dm.sweep, { members = 2, run = function() return {} end })
raises("one value", dm.sweep, { members = 2, run = function() return 1, 2 end })
raises("members", dm.sweep, { members = 0, run = print })
raises("members", dm.sweep, { run = print })
raises("run", dm.sweep, { members = 3 })
raises("did you mean 'journal'", dm.sweep, { members = 3, run = print, jurnal = "x" })
raises("workers", dm.sweep, { members = 3, run = print, workers = 0 })

---- files ----

local file = name "s.journal"
local calls = 0
local function cube(i)
  calls = calls + 1
  return { cube = i ^ 3, root = i ^ 0.5 }
end
local first = dm.sweep { members = 100, run = cube, journal = file }
ok(first.journal.run == 100 and first.journal.found == 0, "a journal is written")
local again = dm.sweep { members = 100, run = cube, journal = file, workers = 1 }
ok(again.journal.found == 100 and again.cube[100] == 1e6 and again.root[49] == 7, "and read")
ok(calls == 1, "only one member of it is run again, the others in processes of their own", calls)
raises("another member 1", dm.sweep, { members = 100, run = function(i) return { cube = i, root = i + 1 } end, journal = file })
raises("members was 100 and is 101", dm.sweep, { members = 101, run = cube, journal = file })
local data = dm.load(file)
ok(#data.member == 100 and data.cube[5] == 125 and table.concat(data.columns, " ") == "member cube root", "dm.load")
local csv = dm.load(first:csv(name "s.csv"))
local npy = dm.load(first:npy(name "s.npy"))
ok(csv.root[2] == 2 ^ 0.5 and npy.root[3] == 3 ^ 0.5 and npy.member[3] == 3, "csv and npy")
ok(first:plot("member", "root", { file = name "s.svg" }) == name "s.svg" or true, "plot")
raises("no column 'x'", first.plot, first, "member", "x")

---- the command line ----

local script = name "script.lua"
local function run(words, environment)
  local pipe = assert(io.popen(("cd '%s' && %s '%s' %s 2>&1; echo status $?"):format(folder, environment or "", dmlua, words)))
  local out = pipe:read "a"
  pipe:close()
  return out, tonumber(out:match "status (%d+)%s*$")
end
dmlua = dmlua:sub(1, 1) == "/" and dmlua or io.popen("pwd"):read "l" .. "/" .. dmlua
text(script, [[
local dm = require "dm"
local s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }:solver { rule = "verlet", h = 0.1 }
local c = s:ensemble { members = 900, q = function(i) return { i/300 } end, v = function() return { 0 } end, steps = 20, every = 5, journal = "c.journal" }
local w = dm.sweep { members = 30, journal = "w.journal", run = function(i) return c.q[i][1] end }
print(c.journal.run, w.journal.run, w.value[30] == c.q[30][1])
]])
local out, status = run "script.lua"
ok(out:find "900\t30\ttrue" and status == 0, "a script with two sweeps", out)
run "--join whole c.journal"
local whole = text(name "whole")
for _, n in ipairs { 1, 2, 5 } do
  os.execute(("rm -f '%s'/c.journal* '%s'/w.journal*"):format(folder, folder))
  for k = n, 1, -1 do
    out, status = run(("--part %d/%d script.lua"):format(k, n))
    ok(status == 0 and (k == 1 or not out:find "true"), ("part %d/%d ends well, before what needs the whole"):format(k, n), out)
  end
  out = run "script.lua"
  ok(out:find("true", 1, true), "then the script has it all", out)
  run "--join joined c.journal*"
  ok(text(name "joined") == whole, n .. " parts joined are the bytes of one process")
end
out, status = run "--join joined c.journal.2-of-5"
ok(status == 1 and out:find "%-%-join: members 1 to 180 are missing", "missing members are named", out)
ok(not out:find "journal%.lua:%d+: %-%-join", "by the command alone", out)
out, status = run "--join joined c.journal w.journal"
ok(status == 1 and out:find "kind is ensemble and sweep", "different sweeps are not joined", out)
out, status = run "--join c.journal c.journal"
ok(status == 1 and out:find "one of the files", "nor into what is read", out)
out, status = run "--join"
ok(status == 1 and out:find "OUT FILE", "without files", out)
for _, wrong in ipairs { "0/4", "9/8", "x", "1/", "-1/2", "1.5/2", "auto" } do
  out, status = run("--part=" .. wrong .. " script.lua", "env -u SLURM_ARRAY_TASK_ID -u OMPI_COMM_WORLD_RANK -u SLURM_STEP_NUM_TASKS")
  ok(status == 1 and out:find "part", "--part " .. wrong .. " is refused", out)
end
out, status = run "--part"
ok(status == 1 and out:find "part", "--part alone", out)
out = run("--part auto -e 'print(dm.part())' script.lua", "OMPI_COMM_WORLD_RANK=2 OMPI_COMM_WORLD_SIZE=3")
ok(out:find "3\t3", "mpirun's variables", out)
out, status = run("--part auto -e 'print(dm.part())' script.lua", "env -u OMPI_COMM_WORLD_RANK SLURM_PROCID=5 SLURM_STEP_NUM_TASKS=4")
ok(status == 1 and out:find "rank 5 of 4", "a rank that cannot be", out)

-- another process has it
local core = require "dm.core"
local held = assert(core.journal_file(name "c.journal", true))
out, status = run "script.lua"
ok(status == 1 and out:find "in use by process %d+", "a file in use", out)
held:close()
ok(not pcall(held.size, held), "a closed file")

-- ended by a signal
text(name "long.lua", [[
local dm = require "dm"
local s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }:solver { rule = "verlet", h = 0.1 }
s:ensemble { members = 10^7, q = function(i) return { i/1e7 } end, v = function() return { 0 } end, steps = 5000, journal = "long.journal" }
]])
text(name "end.sh", ("cd '%s'\n'%s' long.lua &\npid=$!\n" -- once some members are written, on a slow machine too
  .. "until [ $(wc -c < long.journal || echo 0) -gt 4000 ] || ! kill -0 $pid; do sleep 0.1; done\n"
  .. "kill -TERM $pid\nwait $pid\necho status $?\n"):format(folder, dmlua))
out = io.popen(("sh '%s' 2>&1"):format(name "end.sh")):read "a"
ok(out:find "status 143", "SIGTERM: status 143", out)
local report = dm.journal(name "long.journal")
ok(report.finished > 0 and report.damaged == 0, "SIGTERM: what is finished is whole", tostring(report))

-- a stop between any two instructions leaves whole records
local journal = require "dm.data.journal"
local cut, added = 0, 0
for stop = 1, 60 do
  local file = name("stopped" .. stop)
  local j = journal.read(file, true)
  j.where = "test"
  journal.begin(j, { { "kind", "test" }, { "members", 1 } })
  local k = 0
  local function count()
    k = k + 1
    if k == stop then error "stopped" end
  end
  pcall(function()
    debug.sethook(count, "", 1)
    journal.add(j, 1, 1, ("<s4"):pack "bytes")
    debug.sethook()
  end)
  debug.sethook()
  j.file:close()
  local back = journal.read(file)
  cut, added = cut + back.damaged, added + #back.records
  back.file:close()
end
ok(cut == 0 and added > 0 and added < 60, "a stop between two instructions: whole records or none", cut .. " " .. added)

-- ranks
local MPI = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout 300 mpirun -n 3 --oversubscribe"
local there = os.execute("command -v mpirun >/dev/null 2>&1 && " .. MPI .. " true >/dev/null 2>&1")
local module = io.open((dmlua:gsub("[^/]*$", "dm/mpi.so")))
if there and module then -- not opened here: a process of MPI cannot start mpirun
  os.execute(("rm -f '%s'/c.journal* '%s'/w.journal*"):format(folder, folder))
  out, status = run("-l dm.mpi script.lua", MPI)
  ok(status == 0 and select(2, out:gsub("true", "")) == 1, "three ranks print once", out)
  run "--join joined c.journal"
  ok(text(name "joined") == whole, "and write the bytes of one process")
  out, status = run("-l dm.mpi -e 'if dm.mpi.rank == 1 then error \"here\" end dm.mpi.barrier()'", MPI)
  ok(status ~= 0 and out:find "here", "an error of one rank ends all", out)
else
  print "# skipped: ranks (make mpi, openmpi-bin)"
end
local values = require "dm.mpi.values"
local deep = { 1, 2.5, "x\0y", { a = true, [3] = dm.vector { 1, 1e-300 } }, dm.matrix { { 1, 2 }, { 3, 4 } }, math.mininteger, 1 / 0, -0.0 }
local back = values.unpack(values.pack(deep))
ok(back[1] == 1 and math.type(back[1]) == "integer" and back[3] == "x\0y" and back[4].a and back[4][3][2] == 1e-300
  and back[5][2][1] == 3 and back[6] == math.mininteger and back[7] == 1 / 0 and 1 / back[8] == -1 / 0, "values of messages")
raises("a function cannot be sent", values.pack, { print })
local cycle = {}
cycle[1] = cycle
raises("too deeply", values.pack, cycle)
near(#dm.sweep { members = 1, run = function() return 1 end }, 1, 0, "one member")

os.execute(("rm -rf '%s'"):format(folder))
-- NaN that a member gives is its number, and told
do
  local some = dm.sweep { members = 4, workers = 1, run = function(i) return { a = i, b = i > 2 and 0 / 0 or i } end }
  tap.ok(tostring(some) == "sweep of 4 members (a, b): all ok, NaN in b of 2" and some.status[4] == "ok" and some.a[4] == 4,
    "a sweep says in which columns NaN is", tostring(some))
end

-- names of very many columns do not fit into a journal's record
raises("member 1: the names of its 20000 columns take 128893 bytes, 65535 at most", function()
  dm.sweep { members = 2, run = function() return dm.zeros(20000) end }
end)
ok(#dm.sweep { members = 2, run = function() return dm.zeros(9000) end }.columns == 9000, "thousands do")
tap.done()
