--- What waves do not have: a method of solvers, paths or systems with coordinates that was asked of
-- a wave raises with the reason, or with what serves instead.
local blame = require "dm.base.blame"

local M = {}

-- by the class for waves: the class with coordinates that has the methods, and what it is called
local FELLOW = {
  ["dm.wave_solver"] = { "dm.solver", "solver of a wave" },
  ["dm.wave_path"] = { "dm.path", "path of a wave" },
  ["dm.schroedinger"] = { "dm.system", "Schroedinger equation" },
}

-- reasons of their own, by class and method
local REASON = {
  ["dm.wave_solver.ensemble"] = "a member is a run of its own: call solver:run for each psi, what "
    .. "the steps are made of is kept",
  ["dm.wave_solver.step"] = "run { steps = 1 } makes one step",
  ["dm.wave_solver.solvability"] = "no rule for waves chooses its steps by an energy",
  ["dm.wave_solver.measured_order"] = "run with h and with h/2, and compare psi",
  ["dm.wave_solver.reversal"] = "the rules for waves are symmetric: run back from the complex "
    .. "conjugate of psi",
  ["dm.wave_solver.multipliers"] = "the multiplier of \"two-step\" is solver { norm = true }, and "
    .. "is not kept",
  ["dm.wave_path.energy"] = "it is a column: path:column \"energy\"",
  ["dm.wave_path.momentum"] = "it is a column, the mean: path:column \"momentum\"",
  ["dm.wave_path.noether"] = "it is a column: path:column \"noether\"",
  ["dm.wave_path.npy"] = "rows are written as they come: run { file = \"rows.npy\" }",
  ["dm.wave_path.vtk"] = "path:csv writes the columns, run { file = \"rows.npy\" } psi",
  ["dm.wave_path.frequency"] = "dm.fft of a column has its spectrum, wave:eigen the energies",
  ["dm.wave_path.series"] = "path:column has the numbers over path.t",
  ["dm.wave_path.velocity"] = "wave:current(psi) is what flows",
  ["dm.wave_path.worst"] = "path:drift(column).largest is the largest difference",
  ["dm.schroedinger.energy"] = "wave:observe(psi).energy is that of a state",
  ["dm.schroedinger.momentum"] = "wave:observe(psi).momentum is the mean of a state",
  ["dm.schroedinger.modes"] = "wave:eigen(k) has the energies and states of H",
  ["dm.schroedinger.relative_equilibria"] = "wave:eigen(k) has the stationary states of H",
  ["dm.schroedinger.linearize"] = "with g = 0 it is linear: wave:eigen(k)",
  ["dm.schroedinger.stability"] = "wave:stability_limit(rule) is the largest step",
  ["dm.schroedinger.start"] = "run { psi = } takes a function of x or a complex vector",
}

local GENERAL = "it is one of coordinates q and their momenta"

local function refuse(what, name, why)
  return blame.caller(function() error(("a %s has no '%s': %s"):format(what, name, why), 0) end)
end

--- The metatable `class` of waves refuses what its fellow has and it has not.
function M.refuse(class)
  local own, index = class.__name, class.__index
  local fellow, what = table.unpack(FELLOW[own])
  class.__index = function(object, key)
    local value = index(object, key)
    if value ~= nil or type(key) ~= "string" then return value end
    local methods = debug.getregistry()[fellow].methods
    if methods[key] then return refuse(what, key, REASON[own .. "." .. key] or GENERAL) end
  end
end

return M
