-- Where memory ends there is a result or an error, and no segmentation fault of a stack that cannot
-- grow, or may not be large. Builds that do not run under a limit of memory at all (sanitizers) are not
-- asked.
local tap = require "tap"

local file = os.tmpname()
local f <close> = assert(io.open(file, "w"))
f:write [[
  local dm = require "dm"
  local s = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v)/2 + 1/q:norm() end }
  local made = pcall(function() return s:solver { rule = "verlet", h = 0.01 }:ensemble { members = 1e5, steps = 10, threads = 4,
    q = function() return { 1, 0 } end, v = function() return { 0, 1 } end } end)
  os.exit(made and 3 or 1)
]]
f:close()
local function status(limit, what, of)
  return select(3, os.execute(("(ulimit -%s %d && '%s' %s) >/dev/null 2>&1"):format(of or "v", limit, arg[-1], what)))
end
-- from where this starts at all to where members have had enough five times
local asked, whole, limit = false, 0, 8000
while limit <= 80000 and whole < 5 do -- kB
  if status(limit, "-e ''") == 0 then
    local code = status(limit, file)
    asked, whole = true, whole + (code == 3 and 1 or 0)
    tap.ok(code == 1 or code == 3, ("an end in order with %d kB"):format(limit), code)
  end
  limit = limit + 1000
end
if asked then tap.ok(whole == 5, "and at last a result", whole) end
os.remove(file)
if not asked then print "# this build does not run under ulimit -v" end
-- what takes room on the stack asks first how much there may be
local code = status(1024, "-e ''", "s")
tap.ok(code == 0, "a stack of 1 MB is enough to start", code)
tap.done()
