-- Names of the sources: one base name for one file, one type name for one type; and no decision by the name of a
-- rule or a group: what is particular to one is said in its row.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local exceptions = require "exceptions"
local core = require "dm.core"

local C = house.files "^src/.*%.[ch]$"
local text = {}
for _, file in ipairs(house.files "^src/.*%.[ch]$") do text[file] = house.read(file) end
for _, file in ipairs(house.files "^lua/.*%.lua$") do text[file] = house.read(file) end

-- what is let pass, rows { file, names, why }: it fails when it is no longer needed
local function debts(rows)
  local unused, M = {}, {}
  for _, row in ipairs(rows) do
    for name in row[2]:gmatch "%S+" do unused[row[1] .. " " .. name] = true end
  end
  function M.owed(file, name)
    local known = unused[file .. " " .. name] ~= nil
    if known then unused[file .. " " .. name] = false end
    return known
  end
  function M.idle()
    local list = {}
    for key, idle in pairs(unused) do if idle then list[#list + 1] = key .. ": take it out of exceptions.lua" end end
    return list
  end
  return M
end

-- the places of each name; those with more than one
local function doubled(places)
  local wrong = {}
  for name, files in pairs(places) do
    local list = {}
    for file in pairs(files) do list[#list + 1] = file end
    if #list > 1 then table.sort(list); wrong[#wrong + 1] = name .. ": " .. table.concat(list, " ") end
  end
  return wrong
end
local function note(places, name, file)
  places[name] = places[name] or {}
  places[name][file] = true
end

-- x.c and x.h of one folder belong together
local base, types = {}, {}
local twice = debts(exceptions.types)
for _, file in ipairs(C) do
  note(base, file:match "([^/]+)%.[ch]$", file:match "^(.*)/")
  local function type_name(name)
    if not twice.owed(file, name) then note(types, name, file) end
  end
  for name in text[file]:gmatch "\n}%s*(dml?_[%w_]+);" do type_name(name) end
  for _, kind in ipairs { "struct", "union", "enum" } do
    for name in text[file]:gmatch("%f[%w]" .. kind .. "%s+(dml?_[%w_]+)%s*{") do type_name(name) end
  end
end
house.check("there are C files and types", #C > 100 and next(types) and {} or { #C .. " files" })
house.check("no base name of C files in two folders", doubled(base))
house.check("no type name in two files", doubled(types))
house.check("every exception to that is needed", twice.idle())

-- names of rules and groups, as users write them
local names, groups = {}, 0
for _, row in ipairs(core.rules()) do names[row.name] = "rule" end
for _, file in ipairs(house.files "^src/geom/.*%.c$") do
  for name in text[file]:gmatch '%.name = "(%w+)"' do names[name], groups = "group", groups + 1 end
end
house.check("there are rules and groups", names.verlet and groups > 5 and {} or { groups .. " groups" })

local function code(file) -- without comments, blanks as one
  local bare = file:find "^lua" and text[file]:gsub("%-%-[^\n]*", "") or text[file]:gsub("/%*.-%*/", "")
  return (bare:gsub("%s+", " "))
end
local function plain(name) return (name:gsub("%p", "%%%0")) end

-- comparisons with a name, and tables of truth values by name
local function decides(words, name)
  local quoted = '"' .. plain(name) .. '"'
  return words:find("str%w*cmp%([^\"]*" .. quoted) or words:find("[=~!]= ?" .. quoted)
    or words:find(quoted .. " ?[=~!]=") or words:find("%[" .. quoted .. "%] ?= ?true")
    or words:find("%f[%w_-]" .. plain(name) .. " ?= ?true")
end

local decisions, by_name = {}, debts(exceptions.decisions)
for file in pairs(text) do
  local words = not file:find "^lua/dm/demos/" and code(file) or ""
  for name, kind in pairs(names) do
    local own = text[file]:find('%.name = "' .. plain(name) .. '"')
    if not own and decides(words, name) and not by_name.owed(file, name) then
      decisions[#decisions + 1] = ("%s decides by the name of the %s %s"):format(file, kind, name)
    end
  end
end
table.sort(decisions)
house.check("no decision by the name of a rule or a group outside its row", decisions)
house.check("every exception to that is needed", by_name.idle())
house.finish()
