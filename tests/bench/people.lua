-- make bench: what surrounds the interpreter, against the bars of docs/benchmarks/people.md: start, require in a
-- stock Lua, the first run, math.*, a cell of a notebook, a film, the examples of help, the site.
local dm = require "dm"
local build = os.getenv "B" or "build"
local dmlua = build .. "/dmlua"

local function output(command)
  local pipe <close> = assert(io.popen(command .. " 2>/dev/null"))
  return pipe:read "a"
end
local function has(program) return output("command -v " .. program) ~= "" end
local function row(what, text, bar) print(("%-44s %-36s %s"):format(what, text, bar)) end
local folder = output "mktemp -d":gsub("\n", "")
-- the command that runs this program
local function python(name, program, argument)
  local file <close> = assert(io.open(folder .. "/" .. name .. ".py", "w"))
  file:write(program)
  return ("/usr/bin/python3 %s/%s.py %s"):format(folder, name, argument)
end
local function seconds(command)
  local before = dm.clock()
  local fine = os.execute(command)
  return dm.clock() - before, fine
end

---- starts: the least of 60 of each program, in turns ----

local STARTS = [[
import subprocess, sys, time
def start(*c):
    t = time.perf_counter()
    subprocess.run(c, stdin=subprocess.DEVNULL)
    return 1000*(time.perf_counter() - t)
pairs = [(start(sys.argv[1], "-e", ""), start("lua5.4", "-e", "")) for _ in range(60)]
print(*(min(times) for times in zip(*pairs)))]]
local ours, theirs = output(python("starts", STARTS, dmlua)):match "(%S+) (%S+)"
row("dmlua -e '' over lua5.4 -e ''", ("%.2f ms, %.2f ms: %.2f times"):format(ours, theirs, ours / theirs), "2.7")

---- CPU time in a stock Lua, in a process of its own each ----

local PATHS = ("LUA_PATH='lua/?.lua;lua/?/init.lua' LUA_CPATH='%s/?.so' lua5.4 -e '%%s'"):format(build)
local REQUIRE = [[local t = os.clock() local dm = require "dm" print(1000*(os.clock() - t))]]
local FIRST = [[local dm = require "dm" local t = os.clock()
  local s = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 - q[1]^2/2 end }
  s:solver({ rule = "verlet", h = 0.1 }):run { q = {1}, v = {0}, steps = 100 }
  print(1000*(os.clock() - t))]]
local function least(code, times)
  local best = math.huge
  for _ = 1, times do best = math.min(best, tonumber(output(PATHS:format(code))) or math.huge) end
  return best
end
row('require "dm" in lua5.4', ("%.2f ms"):format(least(REQUIRE, 21)), "5 ms")
row("first system and run, more", ("%.2f ms"):format(least(FIRST, 21)), "1 ms")

---- loops over math.*, whose functions know symbols too: the least of 9 times each, in turns ----

local MATH = [[local f, s, t = math.%s, 0, os.clock()
for i = 1, 5e6 do s = s + f(i * 0.37, 2.5) end
print(os.clock() - t)]]
local function loop(program, name) return 1e9 / 5e6 * tonumber(output(("%s -e '%s'"):format(program, MATH:format(name)))) end
for _, name in ipairs { "sin", "sqrt", "floor", "max" } do
  local mine, other = math.huge, math.huge
  for _ = 1, 9 do
    mine, other = math.min(mine, loop(dmlua, name)), math.min(other, loop("lua5.4", name))
  end
  row("math." .. name .. " over lua5.4's", ("%.1f ns, %.1f ns: %.2f times"):format(mine, other, mine / other), "1.25")
end

---- a cell of a notebook: 20 cells, the least of 5 ----

local CELLS = [[
import os, sys, time
os.environ["JUPYTER_PATH"] = sys.argv[1] + "/share/jupyter"
from jupyter_client.manager import start_new_kernel
km, kc = start_new_kernel(kernel_name=os.listdir(sys.argv[1] + "/share/jupyter/kernels")[0])
def cell(code):
    mid = kc.execute(code)
    while True:
        m = kc.get_iopub_msg(timeout=30)
        if m["parent_header"].get("msg_id") == mid and m["content"].get("execution_state") == "idle": break
    kc.get_shell_msg(timeout=10)
cell("1 + 1")
best = 1e9
for _ in range(5):
    t = time.time()
    for _ in range(20): cell("1 + 1")
    best = min(best, time.time() - t)
print(1000*best/20)
km.shutdown_kernel(now=True)]]
output(("%s --jupyter=%s"):format(dmlua, folder))
local cell = tonumber(output(python("cells", CELLS, folder)))
row("a cell of a notebook", cell and ("%.1f ms"):format(cell) or "left out: python3-ipykernel is missing", "10 ms")

---- 150 frames of 640 x 480 to MP4 ----

if has "ffmpeg" and has "gnuplot" then
  local s = dm.system { Q = dm.R(1), coordinates = { "theta" }, L = function(q, v) return v[1] ^ 2 / 2 + math.cos(q[1]) end }
  local path = s:solver({ rule = "verlet", h = 0.05 }):run { q = { 2 }, v = { 0 }, t = 20 }
  local before = dm.clock()
  path:animate(folder .. "/film.mp4", { fps = 30, seconds = 5, size = { 640, 480 } })
  row("150 frames of 640 x 480 to MP4", ("%.1f s"):format(dm.clock() - before), "10 s")
else
  row("150 frames of 640 x 480 to MP4", "left out: ffmpeg or gnuplot is missing", "10 s")
end

---- all examples of help, the site ----

local count = 0
for _ in pairs(require "dm.session.transcripts") do count = count + 1 end
local time, fine = seconds(("LUA_PATH='tests/lua/?.lua;;' %s tests/lua/session/test_transcripts.lua >/dev/null"):format(dmlua))
row(("all %d examples of help"):format(count), ("%.1f s%s"):format(time, fine and "" or ", with errors"), "20 s")
if has "pandoc" then
  time, fine = seconds(("%s docs/site/build.lua %s/site >/dev/null"):format(dmlua, folder))
  row("make site", ("%.0f s%s"):format(time, fine and "" or ", with errors"), "180 s")
else
  row("make site", "left out: pandoc is missing", "180 s")
end
os.execute("rm -r " .. folder)
