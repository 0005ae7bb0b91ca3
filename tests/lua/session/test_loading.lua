-- Modules are loaded when something of them is needed: a load that an error ends in its midst, as want of memory or a stop
-- of a stock Lua, leaves nothing half made, and Ctrl-C waits for its end. Each in a process of its own, which then prints
-- how long the reference is that it makes of all docs.
local tap = require "tap"
local dmlua = os.getenv "DMLUA" or arg[-1]

-- the module is loaded, and what(…) happens after so many instructions
local SCRIPT = [[debug.sethook(function() debug.sethook() %s end, "", %d)
local fine, why = pcall(require, "%s")
debug.sethook()
pcall(require, "%s")
print(tostring(why):match "interrupted!", #require "dm.session.reference".text(dm))]]
local FAILS, PRESSED = [[error("interrupted!", 0)]], [[io.popen("kill -INT $PPID"):close()]]
local function after(what, count, module)
  local name = os.tmpname()
  local file = assert(io.open(name, "w"))
  file:write(SCRIPT:format(what, count, module, module))
  file:close()
  local pipe = io.popen(("'%s' %s 2>&1"):format(dmlua, name))
  local said, length = pipe:read "a":match "^(%S+)%s+(%d+)\n$"
  pipe:close()
  os.remove(name)
  return said, tonumber(length)
end

local _, whole = after("", 1, "dm.group")
for _, row in ipairs { { "dm.reduce.methods", 10, 300 }, { "dm.group", 40 }, { "dm.group.methods.momentum", 200 },
  { "dm.dec.fields.methods", 139 }, { "dm.sweep.methods", 40 }, { "dm.connection", 900, 1200 } } do
  for i = 2, #row do
    for way, what in pairs { ["that fails"] = FAILS, ["during which Ctrl-C is pressed"] = PRESSED } do
      local said, length = after(what, row[i], row[1])
      tap.ok(said == "interrupted!" and length == whole, ("a load of %s %s after %d instructions"):format(row[1], way, row[i]),
        ("%s, %s in the place of %s"):format(said, length, whole))
    end
  end
end
tap.done()
