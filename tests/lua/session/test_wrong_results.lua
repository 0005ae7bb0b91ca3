-- Functions of a script that return what is wrong: in every transcript, each function that is one return gives something of a
-- wrong type in its place. What is raised are sentences of dmlua, never what Lua says of a value inside dmlua.
local tap = require "tap"
local transcripts = require "dm.session.transcripts"
local within = require("dm.core").within
local ok = tap.ok

local WRONG = { "return dm.vector { 1, 2 }", "return {}", "return print" }
local RAW = { "attempt to ", "'for' ", "table index is ", "invalid value %(at index", "lua/dm/", "to 'unpack'", "to 'format'",
  "to 'insert'", "to 'concat'", "to 'rep'", "to 'ipairs'", "to 'pairs'", "to 'abs'", "to 'max'", "to 'sqrt'" }
-- lines behind the function that meet what it left
local OF_THE_TRANSCRIPT = { ["function.factors"] = true, ["euler_engine.fail"] = true, ["solver.run"] = true }

-- chunks of a transcript, as they are typed
local function chunks_of(text)
  local out = {}
  for line in (text .. "\n"):gmatch "([^\n]*)\n" do
    local mark, typed = line:match "^(>>?) (.*)$"
    if mark == ">" then out[#out + 1] = typed elseif mark then out[#out] = out[#out] .. "\n" .. typed end
  end
  return out
end

local at_start = {}
for name, value in next, _G do at_start[name] = value end
local function forget()
  for name in next, _G do _G[name] = at_start[name] end
end

-- what the chunks raise, from the changed one on
local function raised(chunks)
  for _, chunk in ipairs(chunks) do
    local f = load("return " .. chunk, "=stdin") or load(chunk, "=stdin")
    if not f then return end
    local fine, ended, why = pcall(within, 1, f)
    if not fine then return ended end
    if not ended then return why end
  end
end

local raw = {}
local function judge(name, how, why)
  for _, text in ipairs(type(why) == "string" and not OF_THE_TRANSCRIPT[name] and RAW or {}) do
    if why:find(text) then raw[#raw + 1] = ("%s, %s: %s"):format(name, how, why) end
  end
end

-- every function of a chunk that is one return, with another result
local count = 0
local function change(name, chunks, k)
  local chunk, from = chunks[k], 1
  while true do
    local first, last = chunk:find("function%s*[%w_]*%b()%s*return.-%f[%w]end%f[%W]", from)
    if not first then return end
    local head = chunk:sub(first, last):match "^(function%s*[%w_]*%b()%s*)return"
    for _, wrong in ipairs(WRONG) do
      local changed = table.move(chunks, 1, #chunks, 1, {})
      changed[k] = chunk:sub(1, first - 1) .. head .. wrong .. " end" .. chunk:sub(last + 1)
      count = count + 1
      forget()
      judge(name, chunk:sub(math.max(1, first - 20), first - 1) .. wrong, raised(changed))
    end
    from = last + 1
  end
end

local said = print
print = function() end -- luacheck: ignore
local names = {}
for name, text in next, transcripts do
  if type(text) == "string" and not text:find('file =', 1, true) and not text:find('"[%w_.]+%.%l+"') then names[#names + 1] = name end
end
table.sort(names)
for _, name in ipairs(names) do
  local chunks = chunks_of(transcripts[name])
  for k = 1, #chunks do change(name, chunks, k) end
end
forget()
print = said -- luacheck: ignore
ok(count > 1000, count .. " functions with a wrong result")
ok(#raw == 0, #raw .. " messages of Lua's own", table.concat(raw, "; "))
tap.done()
