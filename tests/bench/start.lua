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
