-- The pages that are written by hand: their lengths and widths; that the map of architecture.md
-- shows the tree as it is and tells no times; that what a page names and links is there.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local floors = require "floors"

local GENERATED = { ["docs/reference.md"] = true, ["docs/charts.md"] = true }
-- these may name what is gone
local function is_history(file) return file == "docs/changelog.md" or file:find "^docs/lab/" end

local pages, text = {}, {}
for _, file in ipairs(house.lines "find README.md docs -name '*.md' | LC_ALL=C sort") do
  if not GENERATED[file] then
    pages[#pages + 1] = file
    text[file] = house.read(file)
  end
end
local map = text["docs/architecture.md"]

local long = {}
for file, limit in pairs { ["docs/architecture.md"] = 250, ["docs/benchmarks.md"] = 200 } do
  local n = select(2, text[file]:gsub("\n", ""))
  if n > limit then long[#long + 1] = ("%s has %d lines"):format(file, n) end
end
house.check("architecture.md has at most 250 lines, benchmarks.md 200", long)

-- ---- the map

-- a folder has a row, or stands in the words of the row of the folder that it is in
local function is_named(folder)
  local parent, inner = folder:match "^(.*)/([^/]+)$"
  if map:find("`" .. folder .. "`", 1, true) then return true end
  for row in map:gmatch "\n(|[^\n]*)" do
    local of_parent = parent and row:find("^| `" .. parent .. "`")
    if of_parent and row:find("`" .. inner .. "`", 1, true) then return true end
  end
end
local unnamed, times = {}, {}
for top, list in pairs { src = floors.src, lua = floors.lua } do
  for _, folder in ipairs(list) do
    if not is_named(folder) then unnamed[#unnamed + 1] = top .. ": " .. folder end
  end
end
house.check("the map of architecture.md names every folder of src and lua/dm", unnamed)

-- its rows, a table for src and one for lua/dm, are from the ground up
local function rising(head, list)
  local height, last, wrong = {}, 0, {}
  for i, name in ipairs(list) do height[name] = i end
  for row in (map:match(head .. "[^\n]*\n(.-)\n\n") or ""):gmatch "| ([^|]+) |[^\n]*" do
    for name in row:gmatch "`([^`]+)`" do
      if height[name] and height[name] < last then wrong[#wrong + 1] = name end
      last = height[name] or last
    end
  end
  if last == 0 then wrong[1] = "no table" end
  return wrong
end
house.check("its rows for src go up", rising("| folder of src |", floors.src))
house.check("its rows for lua/dm go up", rising("| folder of lua/dm |", floors.lua))
for line in map:gmatch "[^\n]+" do
  for unit in ("ns us ms s % times x"):gmatch "%S+" do
    if line:find("%d ?" .. unit:gsub("%%", "%%%%") .. "%f[%W]") then times[#times + 1] = line end
  end
end
house.check("architecture.md tells no times", times)
local glossary = map:match "\n## Glossary\n(.*)" or ""
local words = select(2, glossary:gsub("\n| [^|-]+ |", "")) - 1 -- less the head of the table
house.check("its glossary has at most 25 words", words > 5 and words <= 25 and {} or { words })

-- ---- width: blocks, tables and pictures aside; of a link counts what is read
local wide = {}
for _, file in ipairs(pages) do
  local block = false
  for line in text[file]:gmatch "[^\n]*" do
    if line:find "^%s*```" then block = not block end
    local read = line:gsub("%]%([^)]*%)", "]")
    if not block and not line:find "^%s*|" and (utf8.len(read) or #read) > 100 then
      wide[#wide + 1] = file .. ": " .. line:sub(1, 60)
    end
  end
end
house.check("no prose of the docs is wider than 100 columns", wide)

-- ---- links; files in backquotes, by their path or the end of it; names of C
local known, C = {}, house.output "cat $(find src -name '*.[chd]*')"
for _, file in ipairs(house.lines "find src lua tests examples docs .ci Makefile -type f") do
  while file do known[file], file = true, file:match "^[^/]*/(.*)$" end
end
local lost = {}
for _, file in ipairs(pages) do
  local folder = file:match "^(.*/)" or ""
  for target in text[file]:gsub("```.-```", ""):gmatch "%]%(([^)#%s]+)" do
    if not target:find "^%a+://" and not house.is_there(folder .. target) then
      lost[#lost + 1] = file .. " links " .. target
    end
  end
  -- what "New file `x`:" names is what a reader makes
  for name in text[file]:gsub("New file `[^`]*`", ""):gmatch "`([%w_/]+%.%l+)`" do
    local source = name:find "%.[ch]$" or name:find "%.lua$" or name:find "%.def$"
    if source and not known[name] and not is_history(file) then
      lost[#lost + 1] = file .. " names " .. name
    end
  end
  for name in text[file]:gsub("```.-```", ""):gmatch "`([dD][mM][lL]?_[%w_]+)" do
    if not C:find("%f[%w_]" .. name .. "%f[^%w_]") and not is_history(file) then
      lost[#lost + 1] = file .. " names " .. name
    end
  end
end
house.check("what the docs link and name is there", lost)

-- ---- every page has a list that links it
local LISTS = { design = "docs/design/house.md", lab = "docs/lab/README.md" }
local unlisted = {}
for _, file in ipairs(pages) do
  local room, name = file:match "^docs/(%l+)/(.*)$"
  local list, link = LISTS[room] or "docs/benchmarks.md", name
  if room == "benchmarks" then link = "benchmarks/" .. name end
  local wanted = (LISTS[room] or room == "benchmarks") and file ~= list
  if wanted and not text[list]:find("](" .. link .. ")", 1, true) then
    unlisted[#unlisted + 1] = file
  end
end
house.check("every page of design, lab and benchmarks is listed", unlisted)
house.finish()
