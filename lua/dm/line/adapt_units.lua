--- Units of dm.adapt: energies, knots and values are near 1 in what is solved, by powers of 2.
local blame = require "dm.base.blame"
local loads = require "dm.line.load"
local sample = require "dm.line.sample"

local M = {}

--- The line from end to end
function M.line(grid, ends)
  local a = ends[1] == "free" and ends[2] or ends[1]
  local b = ends[2] == "free" and ends[1] or ends[2]
  return { from = grid.from, value = a, slope = (b - a) / (grid.to - grid.from) }
end

local function power_of_2(x)
  return x > 0 and x < math.huge and 2.0 ^ math.floor(math.log(x, 2) + 0.5) or 1.0
end

-- The bend sigma of a line of slope s0 at which W has as much to say as the load; half as much as
-- it ever has, where that is less.
local function bend_of(W, s0, load)
  local first, ratio = s0 ~= 0 and 1e-6 * math.abs(s0) or 1e-100, 0
  local sigma = first
  for _ = 1, 700 do
    local fine, value = blame.try(function()
      return W(s0 + sigma) + W(s0 - sigma) - 2 * W(s0)
    end)
    if not fine or not (value < load * sigma) then return sigma end
    ratio, sigma = math.max(ratio, value / sigma), 2 * sigma
  end
  return ratio > 0 and bend_of(W, s0, 0.5 * ratio) or math.max(math.abs(s0), 1)
end

--- Units of x, u and the energy, and what W, f, x and the ends are in them.
function M.of(W, f, grid, ends)
  local line = M.line(grid, ends)
  local load = f and loads.size(f, grid.from, grid.to, grid.cells) or 0
  local length = power_of_2(grid.to - grid.from)
  local bend = load > 0 and load < math.huge and bend_of(W, line.slope, load)
    or math.abs(line.slope)
  local unit = { x = length, u = power_of_2(bend * length) }
  unit.energy = load > 0 and power_of_2(load * unit.u)
    or power_of_2(length * math.abs(sample.number(W, line.slope)))
  local stretch, work = unit.u / unit.x, unit.x * unit.u / unit.energy
  local function end_of(u) return u == "free" and u or u / unit.u end
  return unit, function(s) return unit.x / unit.energy * W(stretch * s) end,
    f and function(x) return work * f(grid.from + unit.x * x) end,
    { from = 0, to = (grid.to - grid.from) / unit.x, dx = grid.dx / unit.x, cells = grid.cells },
    { end_of(ends[1]), end_of(ends[2]) }
end

--- A result in the units of the question
function M.back(a, unit, grid, ends)
  for i = 1, #a.x do
    a.x[i], a.u[i] = grid.from + unit.x * a.x[i], unit.u * a.u[i]
    a.force[i] = unit.energy / unit.x * a.force[i]
  end
  a.x[#a.x], a.energy = grid.to, unit.energy * a.energy
  if ends[1] ~= "free" then a.u[1] = ends[1] end
  if ends[2] ~= "free" then a.u[#a.u] = ends[2] end
  return a
end

return M
