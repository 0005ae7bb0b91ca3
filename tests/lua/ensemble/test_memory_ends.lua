-- Where memory ends there is a result or an error, and no segmentation fault of a stack that cannot
-- grow, or may not be large. Builds that do not run under a limit of memory at all (sanitizers) are not
-- asked.
local tap = require "tap"

local file = os.tmpname()
local f <close> = assert(io.open(file, "w"))
f:write [[
  local dm = require "dm"
  local s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
  pcall(function() return s:solver { rule = "verlet", h = 0.01 }:ensemble { members = 1e6, steps = 10, threads = 4,
    q = function() return { 1, 0 } end, v = function() return { 0, 1 } end } end)
]]
f:close()
local function status(limit, what, of)
  return select(3, os.execute(("(ulimit -%s %d && '%s' %s) >/dev/null 2>&1"):format(of or "v", limit, arg[-1], what)))
end
local asked = false
for _, limit in ipairs { 165000, 175000, 180000, 185000 } do -- kB
  if status(limit, "-e ''") == 0 then
    asked = true
    local code = status(limit, file)
    tap.ok(code == 0 or code == 1, ("an end in order with %d kB"):format(limit), code)
  end
end
os.remove(file)
if not asked then print "# this build does not run under ulimit -v" end
-- what takes room on the stack asks first how much there may be
local code = status(1024, "-e ''", "s")
tap.ok(code == 0, "a stack of 1 MB is enough to start", code)
tap.done()
