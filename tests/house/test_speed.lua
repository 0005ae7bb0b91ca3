-- Code pays: a file that exists for speed says in its head which row of `make bench` it moves, and by how much:
--   Speed: <problem, or script of tests/bench>[, <row>]: <figure>x ...
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

-- what such files are called
local FAST = { "jit_", "x86", "array_loop", "lattice", "fuse", "_loop", "^lanes", "_lanes", "band%.c", "cache%.c", "trace_log", "contract",
  "reciprocal_root", "small_copy", "written_out", "functions_[48]", "terms_factor", "hamilton_split", "elimination" }
-- sweeps, guesses and lanes of stages are told in the heads of their own folder
local ELSEWHERE = "^src/integ/stage/"

local function is_fast(file)
  if file:find(ELSEWHERE) or not (file:find "%.c$" or file:find "small_copy" or file:find "written_out") then return false end
  local name = file:match "[^/]*$"
  for _, pattern in ipairs(FAST) do
    if name:find(pattern) then return true end
  end
  return false
end

local function is_row(key)
  for _, path in ipairs { "tests/bench/%s.lua", "tests/bench/dm/%s.lua", "tests/bench/gallery/%s.lua" } do
    local f = io.open(path:format(key))
    if f then return f:close() end
  end
  return #house.files("^tests/bench/data/" .. key:gsub("%p", "%%%0")) > 0
end

local silent, wrong, told = {}, {}, 0
for _, file in ipairs(house.files "^src/.*%.[ch]$") do
  local head = house.read(file):match "^/%*.-%*/" or ""
  local line = head:match "Speed: ([^\n]*)"
  local key, gain = (line or ""):match "^([%w._-]+)[,:].-: ?([%d.]+)x"
  if not key then key, gain = (line or ""):match "^([%w._-]+): ?([%d.]+)x" end
  if line and not (key and is_row(key) and tonumber(gain) > 1) then wrong[#wrong + 1] = file .. ": " .. line end
  if line then told = told + 1 end
  if is_fast(file) and not line then silent[#silent + 1] = file end
end
house.check("files that exist for speed are found", told > 30 and {} or { told .. " found" })
house.check("a file that exists for speed names the benchmark that it moves", silent)
house.check("that is a row of make bench, with a figure above 1", wrong)
house.finish()
