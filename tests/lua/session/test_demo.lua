-- demonstrations: each shows what it claims, from a shell, on a terminal, and again with other numbers; misuse
local tap = require "tap"
local dm = require "dm"
local demo = require "dm.session.demo"
local ok, raises = tap.ok, tap.raises

local build = os.getenv "B" or arg[-1]:match "^(.*)/"
local dmlua, pty = os.getenv "DMLUA" or arg[-1], build .. "/tests/pty"

local function output(command)
  local pipe = io.popen(command .. " 2>&1; echo \"[$?]\"")
  local text = pipe:read "a"
  pipe:close()
  return text
end

-- run f with what it prints kept
local function quiet(f, ...)
  local kept, own_print, lines = io.output(), print, {}
  local sink = assert(io.tmpfile())
  io.output(sink)
  print = function(...) -- luacheck: ignore
    local list = table.pack(...)
    for i = 1, list.n do list[i] = tostring(list[i]) end
    lines[#lines + 1] = table.concat(list, "\t")
  end
  local result = table.pack(pcall(f, ...))
  print = own_print -- luacheck: ignore
  io.output(kept)
  sink:close()
  return table.concat(lines, "\n"), table.unpack(result)
end

-- every file is in the list, and says what the engine wants to know
local files, listed = {}, {}
for _, name in ipairs(demo.names()) do listed[name] = true end
for file in output "ls lua/dm/demos lua/dm/demos/line":gmatch "([%w_]+)%.lua" do
  if file ~= "init" then files[#files + 1] = file end
end
local strays = {}
for _, name in ipairs(files) do
  if not listed[name] then strays[#strays + 1] = name end
end
ok(#files >= 10 and #files == #demo.names() and #strays == 0, "every demonstration is in the list, ten or more", table.concat(strays, " "))

local thin, long = {}, {}
for _, name in ipairs(demo.names()) do
  local d = demo.find(name)
  local fine = type(d.title) == "string" and #d.about > 80 and #d.steps >= 2 and type(d.claim) == "function" and #d.numbers >= 1
  for _, number in ipairs(d.numbers) do fine = fine and number.least <= number.value and number.value <= number.most and number.what end
  if not fine then thin[#thin + 1] = name end
  for _, step in ipairs(d.steps) do
    for line in step[2]:gmatch "[^\n]+" do
      if #line > 100 then long[#long + 1] = name .. ": " .. line end
    end
  end
end
ok(#thin == 0, "each has a title, a text, steps, numbers and a claim", table.concat(thin, " "))
ok(#long == 0, "and no line of code that is too long to be read", table.concat(long, "\n"))

-- with their own numbers: what is claimed is seen, in the same words from a shell
for _, name in ipairs(demo.names()) do
  local text, fine, seen, sentence = quiet(demo.run, name)
  ok(fine and seen, name .. ": " .. tostring(sentence):gsub("%s+", " "):gsub("#", "no."), not fine and seen or text)
end

-- with the least and the largest of every number: an answer, or a failure in words. Sanitizers see one end of each
for _, name in ipairs(demo.names()) do
  local broken = {}
  for i, number in ipairs(demo.find(name).numbers) do
    for _, value in ipairs(tap.watched and { i % 2 == 0 and number.least or number.most } or { number.least, number.most }) do
      local _, fine, message = quiet(demo.run, name, { [number.name] = value })
      local inside = not fine and (tostring(message):find "attempt to" or tostring(message):find "stack overflow")
      if inside then broken[#broken + 1] = ("%s = %g: %s"):format(number.name, value, tostring(message)) end
    end
  end
  ok(#broken == 0, name .. " bears the ends of its numbers", table.concat(broken, "\n"))
end

-- from a shell
local text = output(dmlua .. " --demo")
ok(text:find("noether      Noether: a symmetry", 1, true) and text:find "%[0%]", "--demo alone lists them", text)
text = output(dmlua .. " --demo noether squash=0.1 </dev/null")
ok(text:find "With squash = 0.1" and text:find "> planet = dm.system" and text:find "%[0%]", "--demo name number=value", text)
ok(output(dmlua .. " --demo=drift </dev/null"):find "The orbit closes", "--demo=name")
ok(output(dmlua .. " --demo noether; true"):find "Noether:" , "its words are no script")
text = output(dmlua .. " --demo nothing")
ok(text:find "no demonstration 'nothing'; there are lagrangian" and text:find "%[1%]" and not text:find "traceback", "an unknown name", text)
ok(output(dmlua .. " --demo noether squash"):find "after the name come numbers", "a word that is no number")
ok(output(dmlua .. " --demo noether mass=1"):find "no number 'mass' to change; it has squash, h", "an unknown number")
ok(output(dmlua .. " --demo noether h=7"):find "must be a number from", "a number out of range")
ok(output(dmlua .. " --help"):find "%-%-demo=name", "--help tells of it")
ok(output(("echo 'demo()\nhelp \"demo\"' | %s -q -n -i"):format(dmlua)):find "Guided demonstrations", "help \"demo\", and demo as a global of sessions")

-- misuse from Lua
raises("no demonstration 'x'", dm.demo, "x")
raises("numbers are given as a table", dm.demo, "noether", 0.1)
raises("by name", dm.demo, "noether", { 0.1 })
raises("whole number", dm.demo, "order", { s = 1.5 })

-- on a terminal: Return goes on, q stops, a number runs again
if require "dm.manual".readline and os.execute(pty .. " true </dev/null >/dev/null 2>&1") then
  local function play(words, script)
    local file = os.tmpname()
    local f = assert(io.open(file, "w"))
    f:write(table.concat(script, "\n"), "\n")
    f:close()
    local got = output(("env TERM=xterm %s %s %s < %s"):format(pty, dmlua, words, file))
    os.remove(file)
    return (got:gsub("\27%[[%d;?]*[a-zA-Z]", ""):gsub("\r", ""))
  end
  -- what asks there is one engine, and all of them have run above
  local names = demo.names()
  for _, name in ipairs { table.unpack(names, 1, tap.samples(#names)) } do
    local d, script = demo.find(name), {}
    for _ = 2, #d.steps do script[#script + 1], script[#script + 2] = "wait q: stop] ", "send \\r" end
    script[#script + 1], script[#script + 2] = "wait done > ", "send \\r"
    text = play("--demo " .. name, script)
    ok(text:find "exit 0" and text:find "Change a number", name .. " on a terminal", text)
  end
  text = play("--demo noether", { "wait q: stop] ", "send q\\r" })
  ok(text:find "exit 0" and not text:find "angular momentum changed", "q stops", text)
  text = play("--demo drift h=0.3", { "wait q: stop] ", "send \\r", "wait q: stop] ", "send \\r", "wait done > ", "send 0.7\\r",
    "wait must be a number from 0.01 to 0.5 (got 0.7)", "wait done > ", "send k = 1\\r", "wait it has h", "wait done > ", "send nonsense\\r",
    "wait must be a number", "wait done > ", "send 0.1\\r", "wait with steps of 0.1", "wait done > ", "send \\004" })
  ok(text:find "exit 0", "a wrong answer is asked again, a plain number is for the first, Ctrl-D ends it", text)
  text = play("-q -n", { "wait 2004h", "send demo 'rolling'\\r", "wait q: stop] ", "send \\r", "wait q: stop] ", "send q\\r", "wait 2004h",
    "send 40 + 2\\r", "wait 42", "wait 2004h", "pause 50", "send \\004" })
  ok(text:find "exit 0", "in a session, which goes on afterwards", text)
  text = play("-q -n", { "wait 2004h", "send demo 'drift'\\r", "wait q: stop] ", "send \\003", "wait demo: stopped", "wait 2004h", "send 40 + 2\\r",
    "wait 42", "wait 2004h", "pause 50", "send \\004" })
  ok(text:find "exit 0", "Ctrl-C leaves it", text)
else
  print "# no terminal can be opened here: what is asked was not tested"
end
tap.done()
