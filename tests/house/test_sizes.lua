-- Functions fit on a screen or nearly so, files stay one thing, the top level stays the top level.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

local FUNCTION, FILE, HEADER = 60, 400, 200 -- lines; what is aimed at is a quarter of that

-- lines of the C functions of a text: a body opens at the left margin's statement and ends with "}" there
local function c_functions(text, visit)
  local name, start, n = nil, 0, 0
  for line in text:gmatch "([^\n]*)\n" do
    n = n + 1
    if line:find "^[%a_]" and line:find "%(" and not line:find ";%s*$" then name, start = line, n end
    if line:find "^}" and name then
      visit(name, n - start + 1)
      name = nil
    elseif line:find "^[%w ]+%b[] = {" or line:find "^[%w_ %*]+ = {" then
      name = nil
    end
  end
end

-- Lua functions end with an "end" as far in as the line that opens them
local function lua_functions(text, visit)
  local open, n = {}, 0
  for line in text:gmatch "([^\n]*)\n" do
    n = n + 1
    local indent = #line:match "^ *"
    if line:find "function[ %w_%.:]*%b()%s*$" then open[indent] = { line, n } end
    if line:find "^ *end" and open[indent] then
      visit(open[indent][1], n - open[indent][2] + 1)
      open[indent] = nil
    end
  end
end

local function allowed(file, name, length)
  for _, row in ipairs(require "exceptions".functions) do
    if row[1] == file and name:find(row[2], 1, true) and length <= row[3] then return true end
  end
end

local long, big, seen = {}, {}, 0
for _, file in ipairs(house.files "^[slet].*%.[chl][ua]?a?$") do
  local text = house.read(file)
  local _, lines = text:gsub("\n", "")
  local limit = file:find "^src/.*%.h$" and HEADER or FILE
  if lines > limit then big[#big + 1] = ("%s has %d lines"):format(file, lines) end
  local each = file:find "%.lua$" and lua_functions or c_functions
  each(text, function(name, length)
    seen = seen + 1
    if length > FUNCTION and not allowed(file, name, length) then
      long[#long + 1] = ("%s: %d lines: %s"):format(file, length, name)
    end
  end)
end
house.check("there are functions to measure", seen > 100 and {} or { seen .. " found" })
house.check(("no function is longer than %d lines"):format(FUNCTION), long)
house.check(("no file is longer than %d lines, no header of src than %d"):format(FILE, HEADER), big)

local examples = {}
for _, file in ipairs(house.files "^examples/.*%.lua$") do
  local _, lines = house.read(file):gsub("\n", "")
  if lines > 60 then examples[#examples + 1] = ("%s has %d lines"):format(file, lines) end
end
house.check("no example is longer than 60 lines", examples)

local top, strangers = {}, {}
for name in ("Makefile src lua examples tests docs README.md LICENSE"):gmatch "%S+" do top[name] = true end
for _, file in ipairs(house.files ".") do
  local first = file:match "^[^/]+"
  if not top[first] and first:sub(1, 1) ~= "." then strangers[#strangers + 1] = file end
end
house.check("the top level holds nothing else", strangers)
house.finish()
