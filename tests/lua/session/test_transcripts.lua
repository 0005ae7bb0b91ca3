-- dm.example: every transcript is typed again, and the answers are those
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local dmlua = os.getenv "DMLUA" or arg[-1]
local known = require "dm.session.transcripts"

if not require "dm.manual".readline then -- which gives what was typed back
  print "1..0 # SKIP built without readline"
  os.exit()
end
local count = 0
for name, wanted in pairs(known) do
  local typed = {}
  for line in (wanted .. "\n"):gmatch "([^\n]*)\n" do
    typed[#typed + 1] = line:match "^>>? (.*)$"
  end
  local input = os.tmpname()
  local file = assert(io.open(input, "w"))
  file:write(table.concat(typed, "\n"), "\n")
  file:close()
  local pipe = io.popen(("env -i PATH=/usr/bin:/bin HOME=/nonexistent LC_ALL=C.UTF-8 TERM=dumb COLUMNS=400 '%s' -n -i -q < '%s' 2>&1")
    :format(dmlua, input))
  local got = pipe:read "a":gsub("\n+$", ""):gsub("\n> *$", "")
  pipe:close()
  os.remove(input)
  ok(got == wanted, "example of " .. name, got)
  count = count + 1
end
ok(count >= 80, "examples", count)
ok(dm.example "path.drift" == known["path.drift"] and dm.example "path:drift" == known["path.drift"] and dm.example "vector" == known["dm.vector"],
  "names as in help")
ok(dm.example "nothing.here" == nil, "nil where there is none")
tap.raises("a name is needed", dm.example, 3)
tap.done()
