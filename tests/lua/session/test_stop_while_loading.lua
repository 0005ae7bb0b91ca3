-- Ctrl-C while a module of dmlua is loaded at its first use: the module is whole when the stop is raised, and is not read a second time, since it
-- would wrap again what it has wrapped.
local tap = require "tap"
local ok = tap.ok

local SCRIPT = [[
local module, k = "%s", %d
local reads, search = 0, package.searchers[2]
package.searchers[2] = function(name) if name == module then reads = reads + 1 end return search(name) end
debug.sethook(function()
  k = k - 1
  if k > 0 then return end
  debug.sethook()
  io.popen("kill -INT $PPID"):close()
end, "", 100)
local fine = pcall(function()
  require(module)
  for _ = 1, 1e5 do math.abs(1) end
end)
debug.sethook()
require(module)
print(fine, k <= 0, reads)]]

local file = os.tmpname()
for _, module in ipairs { "dm.dec", "dm.connection", "dm.reduce.routh" } do
  for k = 1, 7, 3 do
    local f = assert(io.open(file, "w"))
    f:write(SCRIPT:format(module, k))
    f:close()
    local p = io.popen(("'%s' %s 2>&1"):format(os.getenv "DMLUA" or "build/dmlua", file))
    local said = p:read "a"
    p:close()
    ok(said == "false\ttrue\t1\n", ("%s, stopped at mark %d: raised behind it, read once"):format(module, k), said)
  end
end
os.remove(file)
tap.done()
