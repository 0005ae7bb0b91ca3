-- what others call an option, a method or a piece of syntax is told in the words of here
local tap = require "tap"
local dm = require "dm"
local raises, ok = tap.raises, tap.ok
local core = require "dm.core"

local spring = dm.system { Q = dm.R(1), L = function(q, v) return (v[1] ^ 2 - q[1] ^ 2) / 2 end }
local corners = { { 0, 0 }, { 1, 0 }, { 0, 1 } }

-- options, whether C or Lua takes them: 'triangle' is spelt alike, but means another thing
raises("did you mean 'h'?", spring.solver, spring, { rule = "verlet", dt = 0.1 })
raises("did you mean 'simplices'?", dm.mesh, { points = corners, triangles = { { 1, 2, 3 } } })
raises("did you mean 'points'?", dm.mesh, { vertices = corners })
local grid = dm.mesh { grid = 2 }
raises("did you mean 'f'?", grid.poisson, grid, { rhs = 1 })
raises("did you mean 'fixed'?", grid.poisson, grid, { f = 1, boundary = 0 })
raises("did you mean 'file'?", dm.plot, { 1, 2 }, { 1, 2 }, { filename = "x.png" })

-- methods
local missing = require "dm.session.missing"
for _, row in ipairs { { "dm.system", "hamiltonian", "energy" }, { "dm.system", "solve", "solver" },
  { "dm.matrix", "inv", "inverse" }, { "dm.path", "save", "csv" } } do
  local text = missing.of(row[1], row[2])
  ok(text:find(("did you mean '%s'?"):format(row[3]), 1, true), row[2], text)
end

-- a name that is there, one that is misspelt, one that is neither: 'map' is no misprint of 'mean'
ok(core.nearest("step", { "h", "step" }) == "step", "what is there is meant")
ok(core.nearest("stpe", { "h", "step" }) == "step" and core.nearest("step", { "h" }) == "h", "else what is like it")
ok(core.nearest("mean", { "map", "norm" }) == nil, "two of four letters are no misprint")

tap.done()
