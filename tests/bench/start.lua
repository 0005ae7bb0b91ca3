-- make bench: how long it takes until the interpreter stands, against a stock lua5.4.
local dm = require "dm"
local dmlua = (os.getenv "B" or "build") .. "/dmlua"

-- median of 21 starts, in ms
local function start(command)
  local times = {}
  for i = 1, 21 do
    local before = dm.clock()
    os.execute(command)
    times[i] = 1000 * (dm.clock() - before)
  end
  table.sort(times)
  return times[11]
end

local ours, theirs = start(dmlua .. " -e ''"), start "lua5.4 -e ''"
print(("start-up: dmlua %.1f ms, lua5.4 %.1f ms, %.1f ms more (aim: below 10)"):format(ours, theirs, ours - theirs))

-- loops over math.*, whose functions know symbols too: the least of 9 times each, in turns
local LOOP = [[local f, s, t = math.%s, 0, os.clock()
for i = 1, 5e6 do s = s + f(i * 0.37, 2.5) end
print(os.clock() - t)]]
local function loop(program, name)
  local pipe <close> = assert(io.popen(("%s -e '%s'"):format(program, LOOP:format(name))))
  return 1e9 / 5e6 * pipe:read "n"
end
for _, name in ipairs { "sin", "sqrt", "floor", "max" } do
  local mine, other = math.huge, math.huge
  for _ = 1, 9 do
    mine, other = math.min(mine, loop(dmlua, name)), math.min(other, loop("lua5.4", name))
  end
  print(("math.%-5s dmlua %.1f ns, lua5.4 %.1f ns: %.2f times (aim: below 1.25)")
    :format(name, mine, other, mine / other))
end
