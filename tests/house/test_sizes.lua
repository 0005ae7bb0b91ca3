-- Functions fit on a screen or nearly so, files hold one concept, folders can be listed, the top
-- level stays the top level.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local exceptions = require "exceptions"

local FUNCTION = 60 -- lines; what is aimed at is a quarter of that
-- A file holds one concept. Above these lengths its head says why it is long: "Long because ...".
local FILE, HEADER = 400, 200
local FOLDER = 30 -- files of its own; pictures and folders named data aside
local EXAMPLE = 60

local function height(text) return select(2, text:gsub("\n", "")) end

-- ---- functions

-- of C: a body opens at the left margin's statement and ends with "}" there
local function c_functions(text, visit)
  local name, start, n = nil, 0, 0
  for line in text:gmatch "([^\n]*)\n" do
    n = n + 1
    local opens = line:find "^[%a_]" and line:find "%(" and not line:find ";%s*$"
    if opens then name, start = line, n end
    if line:find "^}" and name then
      visit(name, n - start + 1)
      name = nil
    elseif line:find "^[%w ]+%b[] = {" or line:find "^[%w_ %*]+ = {" then
      name = nil
    end
  end
end

-- of Lua: they end with an "end" as far in as the line that opens them
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

local function is_allowed(file, name, length)
  for _, row in ipairs(exceptions.functions) do
    if row[1] == file and name:find(row[2], 1, true) and length <= row[3] then return true end
  end
end

-- ---- files

-- the comment that a file begins with gives a reason for its length
local function has_reason(text)
  local head = text:match "^/%*.-%*/" or ""
  for line in text:gmatch "[^\n]*" do
    if not line:find "^%-%-" then break end
    head = head .. line
  end
  return head:find "Long because %a" ~= nil
end

local long, big, seen = {}, {}, 0
local let_pass = house.exceptions(exceptions.files)
for _, file in ipairs(house.files "^[slet].*%.[chl][ua]?a?$") do
  local text = house.read(file)
  local limit = file:find "^src/.*%.h$" and HEADER or FILE
  if height(text) > limit and not has_reason(text) and not let_pass.owed(file, "long") then
    big[#big + 1] = ("%s has %d lines"):format(file, height(text))
  end
  local each = file:find "%.lua$" and lua_functions or c_functions
  each(text, function(name, length)
    seen = seen + 1
    if length > FUNCTION and not is_allowed(file, name, length) then
      long[#long + 1] = ("%s: %d lines: %s"):format(file, length, name)
    end
  end)
end
house.enough("there are functions to measure", seen, 1000)
house.check(("no function is longer than %d lines"):format(FUNCTION), long)
house.check(("no file is longer than %d lines, no header of src than %d, without a reason")
  :format(FILE, HEADER), big)
house.check("every exception to that is needed", let_pass.idle())

-- ---- folders, examples, the top level

local files, full, folders = {}, {}, 0
for _, file in ipairs(house.files "/") do
  local folder = file:match "^(.*)/"
  local counts = ("src lua tests docs"):find(folder:match "^[^/]+", 1, true)
  if counts and not file:find "^docs/images/" and not file:find "/data/" then
    files[folder] = (files[folder] or 0) + 1
  end
end
for folder, n in pairs(files) do
  folders = folders + 1
  if n > FOLDER then full[#full + 1] = ("%s has %d files"):format(folder, n) end
end
house.enough("there are folders to list", folders, 40)
house.check(("no folder has more than %d files"):format(FOLDER), full)

local examples = {}
for _, file in ipairs(house.files "^examples/.*%.lua$") do
  local lines = height(house.read(file))
  if lines > EXAMPLE then examples[#examples + 1] = ("%s has %d lines"):format(file, lines) end
end
house.check(("no example is longer than %d lines"):format(EXAMPLE), examples)

local top, strangers = {}, {}
-- debian: where dpkg-buildpackage wants .packaging/debian, which is there while it runs these tests
local HOUSE = "Makefile src lua examples tests docs README.md LICENSE"
  .. (os.getenv "DEB_BUILD_ARCH" and " debian" or "")
for name in HOUSE:gmatch "%S+" do top[name] = true end
for _, file in ipairs(house.files ".") do
  local first = file:match "^[^/]+"
  if not top[first] and first:sub(1, 1) ~= "." then strangers[#strangers + 1] = file end
end
house.check("the top level holds nothing else", strangers)
house.finish()
