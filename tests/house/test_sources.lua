-- How sources are written: one base name for one file, one type name for one type; lines of 100
-- columns, comments; and no decision by the name of a rule or a group: what is particular to one is
-- said in its row.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local exceptions = require "exceptions"
local core = require "dm.core"

local C = house.files "^src/.*%.[ch]$"
local text = {}
for _, file in ipairs(C) do text[file] = house.read(file) end
for _, file in ipairs(house.files "^lua/.*%.lua$") do text[file] = house.read(file) end

-- ---- names

-- those that have more than one place: places[name] = { place = true }
local function doubled(places)
  local wrong = {}
  for name, set in pairs(places) do
    local list = {}
    for place in pairs(set) do list[#list + 1] = place end
    table.sort(list)
    if #list > 1 then wrong[#wrong + 1] = name .. ": " .. table.concat(list, " ") end
  end
  return wrong
end
local function note(places, name, place)
  places[name] = places[name] or {}
  places[name][place] = true
end

local base, types = {}, {}
local twice = house.exceptions(exceptions.types)
for _, file in ipairs(C) do
  note(base, file:match "([^/]+)%.[ch]$", file:match "^(.*)/") -- x.c and x.h of a folder are one
  local function type_name(name)
    if not twice.owed(file, name) then note(types, name, file) end
  end
  for name in text[file]:gmatch "\n}%s*(dml?_[%w_]+);" do type_name(name) end
  for _, kind in ipairs { "struct", "union", "enum" } do
    local definition = kind .. "%s+(dml?_[%w_]+)%s*{"
    for name in text[file]:gmatch(definition) do type_name(name) end
  end
end
house.enough("there are C files", #C, 100)
house.check("there are types", next(types) and {} or { "none" })
house.check("no base name of C files in two folders", doubled(base))
house.check("no type name in two files", doubled(types))
house.check("every exception to that is needed", twice.idle())

-- ---- numbers

-- Lua's own take a text of digits: dml_checknumber and its relatives do not; math.* stays as Lua's is
local OF_LUA = { ["src/bind/core/bind.c"] = true, ["src/bind/core/bind.h"] = true,
  ["src/bind/value/bind_math.c"] = true }
local texts = {}
for _, file in ipairs(C) do
  for _, name in ipairs { "checknumber", "checkinteger", "optnumber", "optinteger" } do
    if file:find "^src/bind/" and not OF_LUA[file] and text[file]:find("luaL_" .. name, 1, true) then
      texts[#texts + 1] = file .. ": luaL_" .. name
    end
  end
end
house.check("no binding takes a text of digits for a number", texts)

-- ---- lines

local WIDTH, COMMENTS = 100, 0.12 -- columns; of the lines of C that are not blank, at least

local wide, lines, comments = {}, 0, 0
for _, file in ipairs(house.files "^[sl].*%.[chld][ua]?[ae]?f?$") do
  local n, inside, is_c = 0, false, file:find "%.[ch]$"
  for line in house.read(file):gmatch "([^\n]*)\n" do
    n = n + 1
    if (utf8.len(line) or #line) > WIDTH then wide[#wide + 1] = ("%s:%d"):format(file, n) end
    if is_c and line:find "%S" then
      local starts = line:find "^%s*/[*/]"
      lines = lines + 1
      if inside or starts then comments = comments + 1 end
      if starts and line:find "/%*" then inside = true end
      if line:find "%*/" then inside = false end
    end
  end
end
house.check(("no line of src and lua is wider than %d columns"):format(WIDTH), wide)
local share = comments / lines
house.check(("of the lines of C %.2f are comments, or more"):format(COMMENTS),
  share >= COMMENTS and {} or { ("%.3f"):format(share) })

-- ---- stops

-- What is tried by code that goes on is tried by blame.try, which passes Ctrl-C and the ends of
-- deadlines on.
local allowed, keepers = {}, {}
for _, row in ipairs(exceptions.pcalls) do allowed[row[1]] = row[2] end
for _, file in ipairs(house.files "^lua/.*%.lua$") do
  -- transcripts are what a user types
  local count, expected = 0, allowed[file] or 0
  for line in (file:find "/transcripts/" and "" or text[file]):gmatch "[^\n]+" do
    local code = line:gsub("%-%-.*", "")
    for _ in code:gmatch "%f[%w_.:]x?pcall%f[^%w_]" do count = count + 1 end
  end
  if count ~= expected then keepers[#keepers + 1] = ("%s: %d"):format(file, count) end
  allowed[file] = nil
end
for file in pairs(allowed) do keepers[#keepers + 1] = file .. ": take its exception out" end
house.check("lua tries things by blame.try; the pcalls that are left have a reason", keepers)

-- ---- decisions

-- names of rules and groups, as users write them
local names, groups = {}, 0
for _, row in ipairs(core.rules()) do names[row.name] = "rule" end
for _, file in ipairs(house.files "^src/geom/.*%.c$") do
  for name in text[file]:gmatch '%.name = "(%w+)"' do names[name], groups = "group", groups + 1 end
end
house.enough("there are groups", groups, 6)
house.check("there are rules", names.verlet and names.gauss and {} or { "no verlet, no gauss" })

-- a text without comments, blanks as one
local function code(file)
  local bare
  if file:find "^lua" then bare = text[file]:gsub("%-%-[^\n]*", "")
  else bare = text[file]:gsub("/%*.-%*/", "") end
  return (bare:gsub("%s+", " "))
end
local plain = {} -- names as patterns
for name in pairs(names) do plain[name] = name:gsub("%p", "%%%0") end

-- a comparison with a name, or a table of truth values by name
local function decides(words, name, has_true)
  local quoted = '"' .. plain[name] .. '"'
  local stands = words:find('"' .. name .. '"', 1, true) -- plain finds are fast
  local has_cmp = stands and words:find("cmp(", 1, true)
  return has_cmp and words:find("str%w*cmp%([^\"]*" .. quoted)
    or stands and (words:find("[=~!]= ?" .. quoted) or words:find(quoted .. " ?[=~!]=")
      or words:find("%[" .. quoted .. "%] ?= ?true"))
    or has_true and words:find("%f[%w_-]" .. plain[name] .. " ?= ?true")
end

local decisions, by_name = {}, house.exceptions(exceptions.decisions)
for file in pairs(text) do
  local words = not file:find "^lua/dm/demos/" and code(file) or ""
  local has_true = words:find "= ?true"
  for name, kind in pairs(names) do
    local own = not words:find(name, 1, true) or text[file]:find('%.name = "' .. plain[name] .. '"')
    if not own and decides(words, name, has_true) and not by_name.owed(file, name) then
      decisions[#decisions + 1] = ("%s decides by the name of the %s %s"):format(file, kind, name)
    end
  end
end
table.sort(decisions)
house.check("no decision by the name of a rule or a group outside its row", decisions)
house.check("every exception to that is needed", by_name.idle())
house.finish()
