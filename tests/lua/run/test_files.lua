-- Files that runs write and read: a changed checkpoint is refused and crashes nothing, rows of a
-- killed run are there, a resumed run adds to its rows, no link in the way is followed.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local folder = os.tmpname()
os.remove(folder)
os.execute("mkdir " .. folder)
local function at(name) return folder .. "/" .. name end
local function spit(file, text)
  local f <close> = assert(io.open(file, "wb"))
  f:write(text)
end
local function slurp(file)
  local f <close> = assert(io.open(file, "rb"))
  return f:read "a"
end
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local own = dm.discrete_lagrangian { Q = dm.R(2), h = 0.05, Ld = function(a, b, h)
  local v = (b - a) / h
  return h * (v:dot(v) / 2 + 1 / a:norm())
end }
local function start(o)
  o.q, o.v = { 0.4, 0 }, { 0, 2 }
  return o
end

-- FNV-1a of all lines but the last, as the file ends with it
local function sealed(lines)
  local sum, text = 0xcbf29ce484222325, table.concat(lines, "\n") .. "\n"
  for i = 1, #text do sum = (sum ~ text:byte(i)) * 0x100000001b3 end
  return text .. ("end %016x\n"):format(sum)
end

local function lines_of(text)
  local lines = {}
  for line in text:gmatch "([^\n]*)\n" do lines[#lines + 1] = line end
  return lines
end

-- the number at the end of line i replaced; nil where there is none
local function changed(lines, i, bad)
  local before = lines[i]:match "^(.*%s)[-%d]%S*$" or lines[i]:match "^[-%d]%S*$" and ""
  if not before then return end
  local copy = table.move(lines, 1, #lines, 1, {})
  copy[i] = before .. bad
  return copy
end

local function same(a, b)
  for i = 1, #a.q[1] do
    if a.q[#a][i] ~= b.q[#b][i] or a.p[#a][i] ~= b.p[#b][i] then return false end
  end
  return true
end

-- rules that keep counts, pivots, matrices beside the state
for _, case in ipairs { { kepler, "gauss(3)" }, { kepler, "midpoint" }, { kepler, dm.curve "rk4" },
  { kepler, "verlet" }, { kepler, "sem(2, gauss(2))" }, { kepler, "galerkin(2, gauss(3))" }, { own } } do
  local system, rule = case[1], case[2]
  local solver = rule and system:solver { rule = rule, h = 0.05 } or dm.solver { system }
  local path = solver:run(rule and start { steps = 9 } or { q = { 0.4, 0 }, p = { 0, 2 }, steps = 9 })
  local file, name = at "checkpoint", tostring(rule or "del")
  path:checkpoint(file)
  local text = slurp(file)
  local lines = lines_of(text)
  local last = table.remove(lines)
  ok(sealed(lines) == text, name .. ": the last line is the checksum of those before it")
  local taken, tried = 0, 0
  for i = 1, #lines do
    for _, bad in ipairs { "0x1p+24", "-0x1p+40", "nan", "inf", "7", "" } do
      local copy = changed(lines, i, bad)
      if copy and copy[i] ~= lines[i] then
        spit(file, table.concat(copy, "\n") .. "\n" .. last .. "\n")
        tried = tried + 1
        if pcall(dm.resume, file, system) then taken = taken + 1 end
        spit(file, sealed(copy))  -- as somebody would who knows how
        pcall(function() dm.resume(file, system):run { steps = 3 } end)
      end
    end
  end
  ok(tried > 40 and taken == 0, name .. ": a changed line is refused", taken .. " of " .. tried)
  spit(file, text .. "more\n")
  raises("its end expected", dm.resume, file, system)
  spit(file, (text:gsub("end (%x+\n)$", "end%1")))
  raises("checksum", dm.resume, file, system)
  spit(file, text)
  ok(same(dm.resume(file, system):run { steps = 4 }, dm.resume(path):run { steps = 4 }),
    name .. ": the file as it was goes on like the path")
end
spit(at "old", "dmlua checkpoint 2\nrule verlet\n")
raises("dmlua checkpoint 4 expected", dm.resume, at "old", kepler)

-- no name of ours is one that somebody else can foresee
spit(at "victim", "mine")
for _, name in ipairs { "c.new", "c.part", "p.png.part.png", "p.png.new" } do
  os.execute(("ln -s victim %s/%s"):format(folder, name))
end
local path = kepler:solver({ rule = "verlet", h = 0.05 }):run(start { steps = 3 })
path:checkpoint(at "c")
pcall(dm.plot, { 1, 2 }, { 1, 2 }, { file = at "p.png" })
ok(slurp(at "victim") == "mine", "a link in the way is not followed")
os.execute(("ln -s victim %s/linked"):format(folder))
path:checkpoint(at "linked")
ok(slurp(at "victim") == "mine", "a link in the place of a checkpoint is replaced, not followed")
local printing = ([[dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 end }
  :solver { rule = "verlet", h = 0.1 }:run { q = { 0 }, v = { 1 }, steps = 3 }:checkpoint "%s"]]):format(at "out")
os.execute(("ln -s /proc/self/fd/1 %s && %s -e '%s' >%s 2>%s"):format(at "out", arg[-1], printing, at "printed", at "said"))
local is_link = os.execute("test -L " .. at "out")
ok(is_link and slurp(at "said"):find("not permitted", 1, true), "a link to what is printed stays, and is told", slurp(at "said"))
os.execute(("rm %s %s %s"):format(at "out", at "printed", at "said"))
local left = io.popen("ls " .. folder):read "a"
ok(not left:find(("%w"):rep(12)), "nothing is left beside", left)
-- what killed runs left for this file goes with the next one: of this name alone, and not what may still be written to
local stale, others = "s.ck.dmlua-0123456789ab.ck", { "s.ck.dmlua-0123456789aw.ck", "s.ck.measurements.ck", "r.ck.dmlua-0123456789ab.ck",
  "s.ck.dmlua-0123456789ab.txt", "s.ck.dmlua-0123456789a.ck" }
local under_way = "s.ck.dmlua-vvvvvvvvvvvv.ck"
for _, name in ipairs { stale, table.unpack(others) } do
  spit(at(name), "left")
  os.execute(("touch -d '2 hours ago' %s"):format(at(name)))
end
spit(at(under_way), "left")
path:checkpoint(at "s.ck")
others[#others + 1] = under_way
ok(not io.open(at(stale)), "a new file that nobody finished is removed")
for _, name in ipairs(others) do
  local handle = io.open(at(name))
  ok(handle and handle:close(), name .. " stays")
  os.remove(at(name))
end

-- the child, killed as soon as `enough`, a condition of the shell, holds: after as long as this machine takes
local function killed_when(enough)
  spit(at "kill.sh", ("'%s' %s >/dev/null 2>&1 &\npid=$!\n"
    .. "until %s || ! kill -0 $pid; do sleep 0.1; done\nkill -KILL $pid\nwait $pid\n"):format(arg[-1], at "child.lua", enough))
  os.execute(("sh %s 2>/dev/null"):format(at "kill.sh"))
end

-- rows: the header counts them block by block
local file = at "rows.npy"
local child = ([[local dm = require "dm"
local k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
k:solver { rule = "gauss(2)", h = .01 }:run { q = { .4, 0 }, v = { 0, 2 }, steps = 3e8, every = 5,
  file = "%s" }]]):format(file)
spit(at "child.lua", child)
killed_when(("[ $(wc -c < %s || echo 0) -gt 1000000 ]"):format(file))
local data = dm.load(file)
ok(#data.t > 4000 and math.abs(data.t[#data.t] - 0.05 * (#data.t - 1)) < 1e-6,
  "rows of a killed run are there", #data.t)

-- rows before a checkpoint are in the file when it is written, so that a killed run goes on
-- without a gap, also where its block of rows was far from full
spit(at "child.lua", ([[local dm = require "dm"
local k = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
k:solver { rule = "verlet", h = .01 }:run { q = { 1, 0 }, v = { 0, 1 }, steps = 1e10, every = 1e5,
  file = "%s", checkpoint = { file = "%s", every = .05 } }]]):format(file, at "killed"))
-- one, and some rows
killed_when(("[ -s %s ] && [ $(wc -c < %s) -gt 2000 ]"):format(at "killed", file))
local further = dm.resume(at "killed", kepler):run { steps = 1e5, every = 1e5, file = file }
data = dm.load(file)
local gap = 0
for i = 2, #data.t do gap = math.max(gap, data.t[i] - data.t[i - 1]) end
ok(#data.t > 3 and gap < 1000 * (1 + 1e-9) and data.t[#data.t] == further.t[#further],
  "no row of a killed run is missing before its checkpoint", ("%d, %g"):format(#data.t, gap))

-- a resumed run adds to its file, and takes back rows that are later than its checkpoint
os.remove(file)
local gauss = kepler:solver { rule = "gauss(2)", h = 0.05 }
local whole = gauss:run(start { steps = 1500 })
gauss:run(start { steps = 1000, file = file, checkpoint = at "r" })
dm.resume(at "r", kepler):run { steps = 500, file = file }
data = dm.load(file)
local equal = #data.t == 1501
for i = 1, #data.t do equal = equal and data.t[i] == whole.t[i] and data.q1[i] == whole.q[i][1] end
ok(equal, "rows of a run that went on are those of one run", #data.t)
local early = gauss:run(start { steps = 400 })
dm.resume(early):run { steps = 100, file = file }
data = dm.load(file)
ok(#data.t == 501 and data.q1[501] == whole.q[501][1], "rows later than the checkpoint are replaced", #data.t)
raises("other columns", function()
  dm.resume(early):run { steps = 100, file = file, watch = { "energy" } }
end)
gauss:run { q = { 1, 0 }, v = { 0, 1 }, steps = 500, file = at "other.npy" }
raises("rows of another run: the one at t = 20.0,", function()
  dm.resume(early):run { steps = 100, file = at "other.npy" }
end)
ok(#dm.load(at "other.npy").t == 501, "which stay as they are")
spit(at "foreign.npy", "not rows")
raises("another kind of file", function() dm.resume(early):run { steps = 1, file = at "foreign.npy" } end)
ok(slurp(at "foreign.npy") == "not rows", "which stays as it is")
gauss:run(start { steps = 10, file = file })
ok(#dm.load(file).t == 11, "a start begins the file anew")

-- a checkpoint that cannot be written ends the run where it is
os.execute("mkdir " .. at "gone")
local first = true
local fine, failure = pcall(gauss.run, gauss, start { steps = 6e6, every = 1e4,
  checkpoint = { file = at "gone/x", every = 0.05 }, watch = { x = function(q)
    if first then
      os.execute("rm -r " .. at "gone")
      first = false
    end
    return q[1]
  end } })
local t = not fine and failure.path.t
ok(t and failure.code == "not_written" and t[#t] < 1.5e5 and tostring(failure):find("gone/x", 1, true),
  "a checkpoint that cannot be written ends the run, and names the file", tostring(failure))

-- rows of every = k are counted from where it goes on, as help says
local cut = gauss:run(start { steps = 7, every = 5 })
local rest = dm.resume(cut):run { steps = 12, every = 5 }
local times = {}
for k = 1, #rest do times[k] = ("%.2f"):format(rest.t[k]) end
ok(table.concat(times, " ") == "0.35 0.60 0.85 0.95", "every k-th step from there", table.concat(times, " "))

-- rows inside of a step that is not taken, since it goes over a place without mass, are in no file, whenever that is written
local falling = dm.system { Q = dm.R(2), L = function(q, v) return (q[1] * v[1] ^ 2 + v[2] ^ 2) / 2 - q[1] end }:solver { rule = "rk4", h = 0.1 }
local inside = {}
for i = 0, 4 do for part = 0, 4 do inside[#inside + 1] = 0.1 * i + 0.02 * part end end
for _, x in ipairs { 0.22, 0.32 } do
  local function ends(more)
    local o = { q = { x, 0 }, v = { -1, 0.3 }, at = inside, file = more.file, checkpoint = more.checkpoint }
    local _, why = pcall(falling.run, falling, o)
    return why.code == "inertia" and why.path.t[#why.path.t]
  end
  local last = ends {}
  ok(last and ends { file = at "in.npy", checkpoint = { file = at "in.ck", every = 1e-9 } } == last, "it ends at the same row", last)
  local t = dm.load(at "in.npy").t
  ok(t[#t] == last, "and so does its file", t)
end

-- a file that another process writes is left to it: rows of two runs in one file are those of neither
local core = require "dm.core"
local busy = at "busy.npy"
gauss:run(start { steps = 3, file = busy })
local bytes = slurp(busy)
local mine = io.open(busy, "r+b")
ok(core.lock_file(mine), "it is locked")
local other = at "other.lua"
spit(other, [[
local dm = require "dm"
local s = dm.system { Q = dm.R(1), L = function(q, v) return (v[1]^2 - q[1]^2)/2 end }
local wave = dm.schroedinger { x = { -8, 8, 16 }, V = function(x) return x^2/2 end }
local sheet = dm.field { x = { 0, 1, 8 }, fixed = "ends", L = function(_, ut, ux) return (ut^2 - ux^2)/2 end }
local function psi(x) return math.exp(-x^2/2), 0 end
print(pcall(function() s:solver { rule = "gauss(1)", h = 0.1 }:run { q = {1}, v = {0}, steps = 9, file = arg[1] } end))
print(pcall(function() wave:solver { rule = "strang", h = 0.1 }:run { psi = psi, steps = 9, file = arg[1] } end))
print(pcall(function() sheet:solver { h = 0.01 }:run { u = 0, t = 0.1, file = arg[1] } end))
]])
local answer = io.popen(("%s %s %s 2>&1"):format(arg[-1], other, busy)):read "a"
ok(select(2, answer:gsub("busy.npy is in use by process %d+; give another name", "")) == 3, "refused, with who has it", answer)
ok(mine:read "a" == bytes, "and its rows are there")
mine:close()
answer = io.popen(("%s %s %s 2>&1"):format(arg[-1], other, busy)):read "a"
ok(answer == ("true\n"):rep(3), "then it is free", answer)

-- a zero byte would cut the name of a file: another one would be written, or read
local cut = at "cut"
spit(cut, "precious")
local three = gauss:run(start { steps = 3 })
for what, f in pairs {
  csv = function() three:csv(cut .. "\0.csv") end, npy = function() three:npy(cut .. "\0.npy") end,
  checkpoint = function() three:checkpoint(cut .. "\0.state") end,
  animate = function() three:animate(cut .. "\0.html") end,
  load = function() dm.load(cut .. "\0.csv") end, resume = function() dm.resume(cut .. "\0.state", three.system) end,
  journal = function() dm.sweep { members = 1, run = function(i) return i end, journal = cut .. "\0.journal" } end,
} do
  print("# " .. what)
  raises("zero bytes", f)
end
raises("field 'checkpoint'", function() gauss:run(start { steps = 3, checkpoint = cut .. "\0.state" }) end)
ok(slurp(cut) == "precious", "and the file that the cut name is of is as it was")

os.execute("rm -r " .. folder)
tap.done()
