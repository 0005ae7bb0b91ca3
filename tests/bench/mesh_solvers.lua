-- make bench: Poisson's equation on an icosphere, the next solve with the same matrix, 17 eigenpairs of functions; then three sizes of
-- what is no factorization, for its growth. The same by hand in C with the same libraries: tests/bench/c/by_hand/mesh_solvers.c, which
-- make bench runs after it. Argument: level of the icosphere.
local dm = require "dm"
local core = require "dm.core"

if not core.solvers() then
  print "\nmesh solvers: without dm/sparse.so there is nothing to compare"
  return
end

local function seconds(f)
  collectgarbage()
  local began = dm.cpu() -- os.clock sees nothing of factors, which another process makes
  local out = f()
  return dm.cpu() - began, out
end
local function row(name, time, rest) print(("%-34s dmlua     %9.1f ms%s"):format(name, time * 1e3, rest or "")) end
local function height(K) return K:form(0, function(_, _, z) return z end) end

local level = tonumber(arg[1]) or 7
print "\nmesh solvers: an icosphere"
do
  local K = dm.mesh { icosphere = level }
  local f, best = height(K), math.huge
  row("Poisson, first solve", (seconds(function() return K:poisson { f = f } end)), ("   (%d unknowns)"):format(K:count(0)))
  for _ = 1, 5 do best = math.min(best, (seconds(function() return K:poisson { f = f } end))) end
  row("Poisson, next solve", best)
end
local K = dm.mesh { icosphere = level - 2 }
local time, found = seconds(function() return K:laplacian(0):eigen(17) end)
row("17 eigenpairs", time, ("   (the last is %.9f, %d solves)"):format(found.values[17], found.solves))

print "growth over three sizes, ns a vertex: what is no factorization"
for _, what in ipairs { "Laplacian of 1-forms as a matrix", "conjugate gradients, an iteration" } do
  local text = {}
  for l = level - 3, level - 1 do
    local M = dm.mesh { icosphere = l }
    local unit = M:count(0)
    if what:find "Laplacian" then
      time = seconds(function() return M:laplacian(1) end)
    else
      local report
      time = seconds(function() report = select(2, M:poisson { f = height(M), solver = "gradients" }) end)
      unit = unit * report.iterations
    end
    text[#text + 1] = ("%8.0f"):format(time / unit * 1e9)
  end
  print(("%-34s dmlua     %s"):format(what, table.concat(text)))
end
