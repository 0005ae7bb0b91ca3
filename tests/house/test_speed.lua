-- Code pays: a file that exists for speed says in the comment at its head, or in that of its header
-- (x.h for x.c and x_more.c), which row of `make bench` it moves, and by how much:
--   Speed: ROW: 1.3x, against what
-- ROW is a problem of tests/bench/data, "P4", or a script of tests/bench and words of its row:
-- "routh, 2 rotors by gauss(1)".
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

-- what such files are called, and folders that hold nothing else
local FAST = { "^src/code/native/", "^src/code/loops/", "/stage/lanes/", "/stage/sweep/",
  "/[^/]*lattice", "/[^/]*fuse", "/[^/]*_loop", "/lanes%.c", "_lanes%.c", "_avx%d*%.c", "band%.c",
  "cache%.c", "trace_log", "contract", "reciprocal_root", "small_copy", "written_out",
  "functions_[48]", "terms_factor", "hamilton_split", "elimination" }
local function is_fast(file)
  if not (file:find "%.c$" or file:find "small_copy" or file:find "written_out") then return false end
  for _, pattern in ipairs(FAST) do
    if file:find(pattern) then return true end
  end
  return false
end

local problems = {}
for _, file in ipairs(house.files "^tests/bench/data/.*%.txt$") do
  problems[file:match "([^/]+)%.txt$"] = true
end
local bench = house.output("cat tests/bench/*.lua tests/bench/*/*.lua tests/bench/c/*.c"):lower()

-- what is wrong with a row; nothing where there is such a one
local function missing(row)
  local name, words = row:match "^([%w_.-]+),? ?(.*)$"
  if not name then return "no row: " .. row end
  for key in pairs(problems) do
    if key == name or key:sub(1, #name + 1) == name .. "-" then return end
  end
  local script = house.is_there("tests/bench/" .. name .. ".lua")
  if not script then return "neither a problem nor a script of tests/bench: " .. name end
  for word in words:gmatch "%a%a%a%a+" do
    if bench:find(word:lower(), 1, true) then return end
  end
  return "no such row of " .. name .. ": " .. words
end

-- the comment that a file begins with, in one line
local function head(file)
  local comment = house.read(file):match "^/%*(.-)%*/" or ""
  return (comment:gsub("\n%s*%*?", " "):gsub("%s+", " "))
end

local said, silent, wrong, told = {}, {}, {}, 0
local files = house.files "^src/.*%.[ch]$"
for _, file in ipairs(files) do
  local row, figure = head(file):match "Speed: (.-): ?(%d[%d.]*)x"
  said[file] = head(file):find "Speed:" ~= nil
  if said[file] then
    told = told + 1
    local why = row and missing(row) or not row and "no row with a figure"
      or tonumber(figure) <= 1 and "no gain"
    if why then wrong[#wrong + 1] = file .. ": " .. why end
  end
end
-- its own head, or that of a header that it belongs to
local function speaks(file)
  if said[file] then return true end
  local stem = file:gsub("%.[ch]$", "")
  while stem do
    if said[stem .. ".h"] then return true end
    stem = stem:match "^(.+)_[^_/]*$"
  end
  return false
end
for _, file in ipairs(files) do
  if is_fast(file) and not speaks(file) then silent[#silent + 1] = file end
end
house.enough("files that exist for speed are found", told, 30)
house.check("a file that exists for speed names the benchmark that it moves", silent)
house.check("that is a row of make bench, with a figure above 1", wrong)
house.finish()
