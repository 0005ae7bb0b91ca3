-- Ctrl-C ends what would go on for half a minute and more: a process sends SIGINT to itself a moment after it has begun, and is
-- killed, which fails, only when it has not ended long after that
local tap = require "tap"
local core = require "dm.core"

local dmlua = (os.getenv "B" or "build") .. "/dmlua"
local MATRIX = [[
local dm = require "dm"
local K = dm.mesh { bcc = %d }
local A = K:laplacian(0).stiffness + 0.001 * require "dm.dec.equations.matrices".diagonal(K:dual_volume(0))
]]
local has_solvers = core.solvers() ~= nil
local has_qhull = pcall(core.delaunay, core.matrix { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 } })
-- what is made before, what goes on
local ENDLESS = {
  { "a Cholesky factorization", MATRIX:format(30), "A:factor 'cholesky'", has_solvers },
  { "an LU factorization", MATRIX:format(24), "A:factor 'lu'", has_solvers },
  { "the signs of a factorization L D L^T", MATRIX:format(24), "A:negatives()", has_solvers },
  { "a Delaunay triangulation", [[
local core = require "dm.core"
local P, x = core.zeros(300000, 3), 1
for i = 1, #P do
  for j = 1, 3 do x = x * 48271 % 2147483647 P[i][j] = x / 2147483647 end
end
local delaunay = require "dm".delaunay]], "delaunay(P)", has_qhull },
  { "Betti numbers", "local K = require 'dm'.mesh { bcc = 12 }", "while true do K:skeleton(3):betti() end" },
  { "meshes", "local mesh = require 'dm'.mesh", "while true do mesh { cube_tiling = 24 } end" },
  { "quality of a mesh", "local K = require 'dm'.mesh { bcc = 12 }", "while true do K:quality() end" },
}
local INTERRUPTS = "\nos.execute '(sleep 0.3; kill -INT $PPID) &'\n"

for _, row in ipairs(ENDLESS) do
  local name, before, script, is_there = table.unpack(row)
  if is_there == false then
    tap.ok(true, name .. " # SKIP its library is not there")
  else
    local file = os.tmpname()
    local out = assert(io.open(file, "w"))
    out:write(before, INTERRUPTS, script, "\nprint 'whole'\n")
    out:close()
    local pipe = assert(io.popen(("timeout --foreground -s KILL 60 %s %s 2>&1; echo code $?"):format(dmlua, file)))
    local said = pipe:read "a"
    pipe:close()
    os.remove(file)
    tap.ok(said:find "interrupted!" and said:find "code 130" and not said:find "whole", name .. " is interrupted", said)
  end
end
tap.done()
