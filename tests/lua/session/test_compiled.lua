-- compiled modules: taken where their texts are as they were, and nothing else is seen of them
local tap = require "tap"
local ok = tap.ok

local dmlua = os.getenv "DMLUA" or arg[-1]
if not dmlua:find "/" then dmlua = arg[-1] end
local root = os.tmpname()
os.remove(root)
assert(os.execute(([[mkdir -p %s/build && cp %s %s/build/dmlua && cp -r lua %s/]])
  :format(root, dmlua, root, root)))

local function write(name, text)
  local file = assert(io.open(root .. "/" .. name, "wb"))
  file:write(text)
  file:close()
end

local function read(name)
  local file = assert(io.open(root .. "/" .. name, "rb"))
  local text = file:read "a"
  file:close()
  return text
end

local function run(code)
  local pipe = io.popen(("'%s/build/dmlua' -e '%s' 2>&1"):format(root, code))
  local text = pipe:read "a"
  pipe:close()
  return text
end

local PROBE = 'local M = {}\nM.word = "right"\nfunction M.fail() local x; x() end\nreturn M\n'
local PRINT = [[print(require "dm.probe".word)]]
local compile = [[require "dm.session.compiled".write("%s/build/modules.luac", "lua/dm/init.lua "
  .. "lua/dm/probe.lua")]]
local FAIL = [[require "dm.probe".fail()]]

write("lua/dm/probe.lua", PROBE)
local before = run(FAIL)
ok(before:find "lua/dm/probe.lua:3:", "an error in a module names its line")
ok(run(compile:format(root)) == "", "compiled modules are written")
ok(run(FAIL) == before, "the same message, with the same place, where the module was compiled")

local whole = read "build/modules.luac"
-- the last of its words in the file is in the code: a sign that code is taken
local at
for place in whole:gmatch '()right' do at = place end
write("build/modules.luac", whole:sub(1, at - 1) .. "other" .. whole:sub(at + 5))
ok(run(PRINT) == "other\n", "what is compiled is taken where the text is the same")

local function with_text(text)
  write("lua/dm/probe.lua", text)
  return run(PRINT)
end
ok(with_text(PROBE:gsub("right", "fresh")) == "fresh\n", "a changed text is read, of the same length")
ok(with_text(PROBE .. "-- more\n") == "right\n", "and a longer one")
ok(with_text(PROBE:sub(1, -2)) == "right\n", "and a shorter one")
ok(with_text(PROBE) == "other\n", "and what is compiled again when the text is back")

-- a process that runs has the file mapped, and may load a module when another one has been put in its place
ok(run(compile:format(root) .. " " .. PRINT) == "other\n", "a file that is made anew does not change under who reads the old one")
ok(run(PRINT) == "right\n", "and is taken by the next one")

-- files that are cut off, of another program, of another Lua
local wrong = 0
for i = 0, 24 do
  write("build/modules.luac", whole:sub(1, i * #whole // 25))
  if run(PRINT) ~= "right\n" then wrong = wrong + 1 end
end
ok(wrong == 0, "a file that is cut off is not read: " .. wrong)

local head = #"dmlua modules" + 1 + #require "dm.manual".lua + 1
local forged = 0
for place = head + 1, head + 8 * 9, 8 do -- the number of rows, offsets of two rows
  for _, number in ipairs { -1, 1 << 62, #whole + 1 } do
    write("build/modules.luac", whole:sub(1, place - 1) .. ("j"):pack(number) .. whole:sub(place + 8))
    if run(PRINT) ~= "right\n" then forged = forged + 1 end
  end
end
ok(forged == 0, "offsets beyond the file are not followed: " .. forged)

write("build/modules.luac", (whole:gsub("Lua 5%.4%.%d", "Lua 5.4.x", 1):gsub("right", "other")))
ok(run(PRINT) == "right\n", "what another Lua compiled is not read")
write("build/modules.luac", "dmlua modules\0")
ok(run(PRINT) == "right\n", "nor a file of its first word")

os.execute("rm -rf " .. root)
tap.done()
