-- equations without dm/sparse.so: the same tests of them pass, and what is too large names the packages
local tap = require "tap"
local ok = tap.ok

-- the last lines of a script, and whether it ended well
local function run(file, ...)
  local command = ("DMLUA_SPARSE=no %s %s 2>&1"):format(os.getenv "DMLUA" or "build/dmlua", file)
  local pipe = assert(io.popen(command))
  local text = pipe:read "a"
  return pipe:close(), text
end
for _, name in ipairs { "matrices", "eigen", "equations" } do
  local fine, text = run("tests/lua/dec/test_" .. name .. ".lua")
  ok(fine, name .. " without the libraries", text:match "not ok[^\n]*\n[^\n]*")
end
local script = os.tmpname()
local function told(code, words)
  local f <close> = assert(io.open(script, "w"))
  f:write(code)
  f:close()
  local _, text = run(script)
  for _, word in ipairs(words) do
    ok(text:find(word, 1, true) ~= nil, "it names " .. word, text)
  end
end
told("print(select(2, pcall(function() return dm.mesh { hex_torus = 35 }:laplacian(0):eigen(3) end)))",
  { "1225 unknowns", "libsuitesparse-dev", "libarpack2-dev" })
told("print(select(2, dm.mesh { icosphere = 3 }:poisson { f = function(x) return x end }))", { "conjugate gradients", "iterations" })
told("print(select(2, pcall(function() return dm.mesh { grid = 20 }:darcy { pressure = 1 } end)))",
  { "libsuitesparse-dev" })
told("print(dm.mesh { icosphere = 1 }:poisson { f = 1, solver = 'lu' })", { "libsuitesparse-dev" })
os.remove(script)
tap.done()
