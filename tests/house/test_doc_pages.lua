-- The pages that are written by hand: their lengths and widths, that the map of architecture.md shows the tree as
-- it is and tells no times, and that what a page names and links is there.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local floors = require "floors"

local GENERATED = { ["docs/reference.md"] = true, ["docs/charts.md"] = true }
local HISTORY = { ["docs/changelog.md"] = true } -- may name what is gone; so may docs/lab
local pages = {}
for _, file in ipairs(house.lines "find README.md docs -name '*.md' | LC_ALL=C sort") do
  if not GENERATED[file] then pages[#pages + 1] = { file = file, text = house.read(file) } end
end
local function text(file)
  for _, page in ipairs(pages) do if page.file == file then return page.text end end
  return ""
end
local function height(file) return select(2, text(file):gsub("\n", "")) end
local function is_there(file)
  local f = io.open(file)
  if f then f:close() end
  return f ~= nil
end

local long = {}
for file, limit in pairs { ["docs/architecture.md"] = 250, ["docs/benchmarks.md"] = 200 } do
  if height(file) == 0 or height(file) > limit then long[#long + 1] = ("%s has %d lines"):format(file, height(file)) end
end
house.check("architecture.md has at most 250 lines, benchmarks.md 200", long)

-- the map
local map = text "docs/architecture.md"
local unnamed, times = {}, {}
for top, list in pairs { src = floors.src, lua = floors.lua } do
  for _, folder in ipairs(list) do
    local parent, inner = folder:match "^(.*)/([^/]+)$"
    local named = map:find("`" .. folder .. "`", 1, true)
    for row in map:gmatch "\n(|[^\n]*)" do -- a folder inside another one may stand in the words of its row
      named = named or parent and row:find("^| `" .. parent .. "`") and row:find("`" .. inner .. "`", 1, true)
    end
    if not named then unnamed[#unnamed + 1] = top .. ": " .. folder end
  end
end
house.check("the map of architecture.md names every folder of src and lua/dm", unnamed)
for line in map:gmatch "[^\n]+" do
  for _, unit in ipairs { "%d ?ns%f[%W]", "%d ?us%f[%W]", "%d ?ms%f[%W]", "%d s%f[%W]", "%d ?%%", "%d times%f[%W]", "%dx%f[%W]" } do
    if line:find(unit) then times[#times + 1] = line end
  end
end
house.check("architecture.md tells no times", times)
local _, words = (map:match "\n## Glossary\n(.*)" or ""):gsub("\n| [^|-]+ |", "")
house.check("its glossary has at most 25 words", words > 6 and words <= 26 and {} or { words - 1 .. " words" })

-- width of prose: blocks, tables and pictures aside; a link counts as what is read
local wide = {}
for _, page in ipairs(pages) do
  local block = false
  for line in page.text:gmatch "[^\n]*" do
    if line:find "^%s*```" then block = not block end
    local read = line:gsub("%]%([^)]*%)", "]")
    if not block and not line:find "^%s*|" and (utf8.len(read) or #read) > 100 then
      wide[#wide + 1] = page.file .. ": " .. line:sub(1, 60)
    end
  end
end
house.check("no prose of the docs is wider than 100 columns", wide)

-- links, and files named in backquotes: from the root, from src, lua or lua/dm, or by their name alone
local lost, known = {}, {}
for _, file in ipairs(house.lines "find src lua tests examples docs .ci Makefile -type f") do
  known[file] = true
  while file do known[file], file = true, file:match "^[^/]*/(.*)$" end
end
for _, page in ipairs(pages) do
  local folder = page.file:match "^(.*/)" or ""
  for target in page.text:gsub("```.-```", ""):gmatch "%]%(([^)#%s]+)" do
    if not target:find "^%a+://" and not is_there(folder .. target) then lost[#lost + 1] = page.file .. " links " .. target end
  end
  if not HISTORY[page.file] and not page.file:find "^docs/lab/" then
    -- what "New file `x`:" names is what a reader makes
    for name in page.text:gsub("New file `[^`]*`", ""):gmatch "`([%w_/]+%.[chld][ua]?[ae]?f?)`" do
      if name:find "%.[ch]$" or name:find "%.lua$" or name:find "%.def$" then
        if not known[name] then lost[#lost + 1] = page.file .. " names " .. name end
      end
    end
  end
end
house.check("what the docs link and name is there", lost)

-- the pages of design, each once in house.md
local unlisted = {}
for _, page in ipairs(pages) do
  local name = page.file:match "^docs/design/(.*)$" or page.file:match "^docs/lab/(.*)$"
  local list = page.file:find "^docs/lab" and text "docs/lab/README.md" or text "docs/design/house.md"
  if name and name ~= "house.md" and name ~= "README.md" and not list:find("](" .. name .. ")", 1, true) then
    unlisted[#unlisted + 1] = page.file
  end
  name = page.file:match "^docs/(benchmarks/.*)$"
  if name and not text("docs/benchmarks.md"):find("](" .. name .. ")", 1, true) then unlisted[#unlisted + 1] = page.file end
end
house.check("every page of design, lab and benchmarks is listed where it is looked for", unlisted)
house.finish()
