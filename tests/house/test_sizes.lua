-- Functions fit on a screen or nearly so, files hold one concept, folders can be listed, the top level stays the
-- top level.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

local FUNCTION = 60 -- lines; what is aimed at is a quarter of that
-- A file holds one concept. Above these lengths its head says why that one is long: "Long because ...".
local FILE, HEADER = 400, 200
local FOLDER = 30 -- files of its own; pictures and folders named data aside

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

-- the comment that a file begins with gives a reason for its length
local function has_reason(text)
  local head = text:match "^/%*.-%*/" or ""
  for line in text:gmatch "[^\n]*" do
    if not line:find "^%-%-" then break end
    head = head .. line
  end
  return head:find "Long because %a" ~= nil
end

-- a file that is let pass until it is shorter
local known = {}
for _, row in ipairs(require "exceptions".files) do known[row[1]] = row[2] end
local function let_pass(file, lines, limit)
  if not known[file] or lines <= limit or lines > known[file] then return false end
  known[file] = nil
  return true
end

local long, big, seen = {}, {}, 0
for _, file in ipairs(house.files "^[slet].*%.[chl][ua]?a?$") do
  local text = house.read(file)
  local _, lines = text:gsub("\n", "")
  local limit = file:find "^src/.*%.h$" and HEADER or FILE
  if lines > limit and not has_reason(text) and not let_pass(file, lines, limit) then
    big[#big + 1] = ("%s has %d lines"):format(file, lines)
  end
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
house.check(("no file is longer than %d lines, no header of src than %d, without a reason"):format(FILE, HEADER), big)
local idle = {}
for file in pairs(known) do idle[#idle + 1] = file .. ": take its row out of exceptions.lua" end
house.check("every exception to that is needed", idle)

local files, full = {}, {}
for _, file in ipairs(house.files "/") do
  local folder = file:match "^(.*)/"
  local counts = folder:find "^src" or folder:find "^lua" or folder:find "^tests" or folder:find "^docs"
  if counts and not file:find "^docs/images/" and not file:find "/data/" then files[folder] = (files[folder] or 0) + 1 end
end
for folder, n in pairs(files) do
  if n > FOLDER then full[#full + 1] = ("%s has %d files"):format(folder, n) end
end
house.check("there are folders to list", (files["src/base"] or 0) > 3 and (files["docs"] or 0) > 3 and {} or { "none" })
house.check(("no folder has more than %d files"):format(FOLDER), full)

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
