-- Rooms that read a part of the equations of a mesh leave all methods of its operators there: each
-- is the first that a process asks for.
local tap = require "tap"

local firsts = {
  multigrid = "dm.multigrid { dm.mesh { grid = 1 }, dm.mesh { grid = 2 } }",
  flow = "dm.mesh { icosphere = 1 }:euler { vorticity = function(x) return x end }",
  stationary = "dm.mesh { grid = 1 }:stationary { term = function(a) return a:dot(a) end }" }
local ask = " print(dm.mesh { grid = 2 }:laplacian(0, { fixed = 'boundary' }):eigen(1).values[1])"

for name, first in pairs(firsts) do
  local pipe = assert(io.popen(("%s -e \"local _ = %s%s\" 2>&1"):format(os.getenv "DMLUA" or "build/dmlua", first, ask)))
  local text = pipe:read "a"
  pipe:close()
  -- one free vertex, with four neighbours at 1/2 and the area 1/4
  tap.near(tonumber(text) or math.huge, 16, 1e-12, "eigenvalues after " .. name)
end
tap.done()
