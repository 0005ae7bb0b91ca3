-- dm.example: every transcript is typed again, and the answers are those. A wing is typed into one
-- session, in an empty folder; between two examples its globals are taken away, so that each stands
-- by itself. What needs a program or a library that is not there is left out, and said.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local dmlua = os.getenv "DMLUA" or arg[-1]
local known = require "dm.session.transcripts"

if not require "dm.manual".readline then -- which gives what was typed back
  print "1..0 # SKIP built without readline"
  os.exit()
end

-- typed before the first example and after each: a session as it begins
local PREPARE = [[do local at = {} for k, v in next, _G do at[k] = v end; ]]
  .. [[package.fresh = function(n) for k in next, _G do _G[k] = at[k] end print("end of", n) end end]]
local FRESH = "package.fresh(%d)"

local function typed(text)
  local lines = {}
  for line in (text .. "\n"):gmatch "([^\n]*)\n" do lines[#lines + 1] = line:match "^>>? (.*)$" end
  return lines
end

local function told(command)
  local pipe = io.popen(command)
  local text = pipe:read "a":gsub("\n$", "")
  pipe:close()
  return text
end
local there = dmlua:find "^/" and dmlua or told "pwd" .. "/" .. dmlua

local SESSION = [[cd '%s' && env -i PATH=/usr/bin:/bin HOME=/nonexistent LC_ALL=C.UTF-8 TERM=dumb ]]
  .. [[COLUMNS=400 '%s' -n -i -q < typed 2>&1]]

local function session(lines)
  local folder = told "mktemp -d"
  local file = assert(io.open(folder .. "/typed", "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  local pipe = io.popen(SESSION:format(folder, there))
  local out = pipe:read "a"
  pipe:close()
  os.execute("rm -r '" .. folder .. "'")
  return out
end

-- errors that name what is not built or installed
local MISSING = { "dm/sparse.so is missing", "libqhull%-dev", "gnuplot", "ffmpeg" }
local function is_missing(answer)
  for _, pattern in ipairs(MISSING) do
    local what = answer:match("stdin:1: [^\n]*" .. pattern)
    if what then return what end
  end
end

-- the names of a wing and what a session answers to all of them
local function type_wing(names)
  local lines = { PREPARE }
  for i, name in ipairs(names) do
    for _, line in ipairs(typed(known[name])) do lines[#lines + 1] = line end
    lines[#lines + 1] = FRESH:format(i)
  end
  local out, answers = session(lines), {}
  local from = out:find("\n", 1, true) + 1
  for i in ipairs(names) do
    local first, last = out:find(("> %s\nend of\t%d\n"):format(FRESH:format(i), i), from, true)
    if not first then return answers, out:sub(from) end
    answers[i] = out:sub(from, first - 1):gsub("\n+$", "")
    from = last + 1
  end
  return answers, ""
end

-- digits beyond the ninth differ from processor to processor
local function rounded(text)
  return (text:gsub("\n+$", ""):gsub("%d+%.%d+", function(x) return ("%.9g"):format(x) end))
end

local count, wings = 0, {}
for module in pairs(package.loaded) do
  wings[#wings + 1] = module:match "^dm%.session%.transcripts%.%w+$"
end
table.sort(wings)
for _, wing in ipairs(wings) do
  local names = {}
  for name in pairs(require(wing)) do names[#names + 1] = name end
  table.sort(names)
  local answers, rest = type_wing(names)
  for i, name in ipairs(names) do
    local fine = answers[i] and rounded(answers[i]) == rounded(known[name])
    local lacking = not fine and is_missing(answers[i] or rest)
    ok(fine or lacking, "example of " .. name .. (lacking and " # SKIP " .. lacking or ""),
      answers[i] or rest)
    count = count + 1
  end
end
local all = 0
for _ in pairs(known) do all = all + 1 end
ok(count == all, "no name has two examples", ("%d, %d"):format(count, all))

-- every entry of the reference has one
local reference, lacking, entries = require "dm.session.reference", {}, 0
local function look_for(name)
  entries = entries + 1
  if not dm.example(name) then lacking[#lacking + 1] = name end
end
for name in pairs(reference.functions(dm)) do look_for(name) end
for name in pairs(reference.for_modules()) do look_for(name) end
for class, methods in pairs(reference.classes()) do
  look_for(class)
  for name in pairs(methods) do look_for(class:match "[^.]+$" .. ":" .. name) end
end
ok(#lacking == 0 and entries > 700, "every function, method and class has an example",
  table.concat(lacking, " "))

-- and help shows it below the text
local help, layout, silent = require "dm.session.help", require "dm.session.text", {}
for name, text in pairs(known) do
  local shown = layout.collected(help.ask, name)
  if not shown:find("\n  Example:\n    " .. text:match "^[^\n]*", 1, true) then silent[#silent + 1] = name end
end
ok(#silent == 0, "?name shows the example of every name", table.concat(silent, " "))

ok(dm.example "path.drift" == known["path.drift"] and dm.example "path:drift" == known["path.drift"] and dm.example "vector" == known["dm.vector"],
  "names as in help")
ok(dm.example "rho.invariants" == known["frame.invariants"], "or as its doc writes it")
ok(dm.example "nothing.here" == nil, "nil where there is none")
tap.raises("a name is needed", dm.example, 3)
tap.done()
