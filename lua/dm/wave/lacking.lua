--- What waves do not have: a method of solvers, paths or systems with coordinates that was asked of
-- a wave raises with the reason, or with what serves instead.
local blame = require "dm.base.blame"

local M = {}

-- by the name of the class for waves: the class that has the methods, what it is called, and
-- reasons of their own
local OF = {
  ["dm.wave_solver"] = { "dm.solver", "solver of a wave", {
    ensemble = "a member is a run of its own: call solver:run for each psi, what the steps are "
      .. "made of is kept",
    step = "run { steps = 1 } makes one step",
    solvability = "no rule for waves chooses its steps by an energy",
    measured_order = "run with h and with h/2, and compare psi",
    reversal = "the rules for waves are symmetric: run back from the complex conjugate of psi",
    multipliers = "the multiplier of \"two-step\" is solver { norm = true }, and is not kept",
  } },
  ["dm.wave_path"] = { "dm.path", "path of a wave", {
    energy = "it is a column: path:column \"energy\"",
    momentum = "it is a column, the mean: path:column \"momentum\"",
    noether = "it is a column: path:column \"noether\"",
    npy = "rows are written as they come: run { file = \"rows.npy\" }",
    vtk = "path:csv writes the columns, run { file = \"rows.npy\" } psi",
    frequency = "dm.fft of a column has its spectrum, wave:eigen the energies",
    series = "path:column has the numbers over path.t",
    velocity = "wave:current(psi) is what flows",
    worst = "path:drift(column).largest is the largest difference",
  } },
  ["dm.schroedinger"] = { "dm.system", "Schroedinger equation", {
    energy = "wave:observe(psi).energy is that of a state",
    momentum = "wave:observe(psi).momentum is the mean of a state",
    modes = "wave:eigen(k) has the energies and states of H",
    relative_equilibria = "wave:eigen(k) has the stationary states of H",
    linearize = "with g = 0 it is linear: wave:eigen(k)",
    stability = "wave:stability_limit(rule) is the largest step",
    start = "run { psi = } takes a function of x or a complex vector",
  } },
}

local GENERAL = "it is one of coordinates q and their momenta"

local function refuse(what, name, why)
  return blame.caller(function() error(("a %s has no '%s': %s"):format(what, name, why), 0) end)
end

--- The metatable `class` of waves refuses what its fellow has and it has not.
function M.refuse(class)
  local row, index = OF[class.__name], class.__index
  local fellow, what, reasons = table.unpack(row)
  class.__index = function(object, key)
    local value = index(object, key)
    if value ~= nil or type(key) ~= "string" then return value end
    local methods = debug.getregistry()[fellow].methods
    if methods[key] then return refuse(what, key, reasons[key] or GENERAL) end
  end
end

return M
