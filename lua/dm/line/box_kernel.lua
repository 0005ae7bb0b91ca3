--- Starts of boxes whose M has a kernel that does not lie along components: y (K z_x - grad S(z))
-- = 0 for all y with y M = 0 is solved for all boxes at once, by Newton's method. What is not given
-- is found; where all is given, it is moved along the kernel.
local algebra = require "dm.line.box_algebra"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "solver:run"
local TINY = 1e-10

--- Is the kernel of M spanned by components?
function M.is_aligned(boxes)
  local rows = 0
  for r = 1, boxes.d do rows = rows + (algebra.is_zero(boxes.M[r]) and 1 or 0) end
  return rows == #algebra.bonds(boxes)
end

---- directions ----

-- the part of v that is orthogonal to orthonormal vectors, of length 1; nil: there is none
local function orthogonal(v, to)
  local size = v:norm()
  for _ = 1, 2 do -- twice: the first leaves rounding of what it takes away
    for _, e in ipairs(to) do v = v - v:dot(e) * e end
  end
  local left = v:norm()
  return left > TINY * size and v / left or nil
end

local function unit(d, c)
  local e = core.zeros(d)
  e[c] = 1
  return e
end

-- As many directions as bonds in which the start is open: components that are not given, then the
-- kernel; and a basis of what is across them, which stays.
local function directions(boxes, given, bonds)
  local open, across = {}, {}
  for c = 1, boxes.d do
    if not given[c] then open[#open + 1] = unit(boxes.d, c) end
  end
  if #open > #bonds then
    option.fail(WHERE, "%d components are not given, and as M z_t has a kernel of dimension %d, "
      .. "which lies along none of them, %d follow: give %d more", #open, #bonds, #bonds,
      #open - #bonds)
  end
  for _, y in ipairs(bonds) do
    local e = #open < #bonds and orthogonal(y, open)
    if e then open[#open + 1] = e end
  end
  local all = { table.unpack(open) }
  for c = 1, boxes.d do
    local e = orthogonal(unit(boxes.d, c), all)
    if e then all[#all + 1], across[#across + 1] = e, e end
  end
  return across
end

---- the equations ----

-- In a box: what stays at its left node, and y (K D z - grad S(m z)) for all y.
local function equations(boxes, slope, bonds, across)
  local d, dx, K = boxes.d, boxes.dx, boxes.K
  return function(lower, upper)
    local a, b, c = lists.part(lower, 0, d), lists.part(upper, 0, d), lists.part(upper, d, d)
    local out, gradient, rates = {}, boxes.gradient((b + c) / 2), (c - b) / dx
    for k, e in ipairs(across) do out[k] = (b - a):dot(e) end
    for _, y in ipairs(bonds) do
      local sum = 0
      for r = 1, d do
        for s = 1, y[r] ~= 0 and d or 0 do
          local x = y[r] * K[r][s]
          if x ~= 0 then sum = sum + x * (rates[s] + (slope[s] or 0)) end
        end
        if y[r] ~= 0 then sum = sum - y[r] * gradient[r] end
      end
      out[#out + 1] = sum
    end
    return out
  end
end

local function joined(boxes, given)
  local out = core.zeros(boxes.cells * boxes.d)
  for c, values in pairs(given) do
    for i = 1, boxes.cells do out[(i - 1) * boxes.d + c] = values[i] end
  end
  return out
end

local OPEN = "the rows without z_t, y (K z_x - grad S) = 0 for all y with y M = 0, do not "
  .. "determine the start (%s): %s"

--- All components as vectors by number, from those that are given, which satisfy the bonds.
function M.solve(boxes, given, slope)
  local bonds, d = {}, boxes.d
  for _, y in ipairs(algebra.bonds(boxes)) do bonds[#bonds + 1] = orthogonal(y, bonds) end
  local across = directions(boxes, given, bonds)
  local strip = core.strip(equations(boxes, slope, bonds, across), { values = d,
    cells = boxes.cells, ring = true, boxes = true, held = core.zeros(boxes.cells * d),
    absorbs = { 0, 0 }, place = core.zeros(boxes.cells) })
  local outcome = strip:run { u = joined(boxes, given), t0 = 0, h = 1, steps = 1 }
  if outcome.code ~= "ok" then
    option.fail(WHERE, OPEN, outcome.code, outcome.code == "singular"
      and "M and S leave a direction of the kernel open there, or the ring has an even number of "
      .. "cells; write the equations with that direction as a component of its own"
      or "Newton's method finds no solution from what is given")
  end
  local out, z = {}, outcome.u[2]
  for c = 1, d do
    out[c] = core.zeros(boxes.cells)
    for i = 1, boxes.cells do out[c][i] = z[(i - 1) * d + c] end
  end
  return out
end

return M
