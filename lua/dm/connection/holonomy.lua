--- Holonomy of a loop of shapes: its lift from q0 ends at h q0. In a trivialization h = g0
-- (A(x_(m-1), x_m) ... A(x_0, x_1))^-1 g0^-1; for a small loop log h / area tends to minus the
-- curvature.
local blame = require "dm.base.blame"
local bundles = require "dm.connection.bundle"
local connections = require "dm.connection"
local groupoid = require "dm.connection.groupoid"

local M = {}

local abs, pi = math.abs, math.pi

local COARSE = "A:holonomy: the loop is too coarse: coordinate %d, an angle, goes by %.6g from "
  .. "point %d to point %d; steps must stay below half a turn: take more points (an angle goes on "
  .. "past 2 pi, it does not jump back)"

-- steps of half a turn have no shortest way
local function check_steps(B, x)
  for l = 1, #x - 1 do
    for i in pairs(B.angles) do
      local step = x[l + 1][i] - x[l][i]
      if type(step) == "number" and abs(step) > pi * (1 - 1e-12) then
        error(COARSE:format(i, step, l, l + 1), 0)
      end
    end
  end
end

local function check_closed(B, x)
  local fine, off = bundles.agree(B, x[1], x[#x])
  if fine then return end
  error(("A:holonomy: the loop is not closed: its ends are %.3g apart, %s and %s; the last point "
    .. "must be the first%s"):format(off, bundles.show(x[1]), bundles.show(x[#x]),
      next(B.angles) and " (angles up to whole turns)" or ""), 0)
end

-- the lift of the loop, or which step has none
local function lifted(own, x, q)
  for l = 1, #x - 1 do
    local fine, next_point = blame.try(own.second, q, x[l + 1])
    if not fine then
      error(("A:holonomy: step %d, from %s to %s, has no lift: %s; if the loop is too coarse "
        .. "there, take more points"):format(l, bundles.show(x[l]), bundles.show(x[l + 1]),
          blame.bare(next_point)), 0)
    end
    q = next_point
  end
  return q
end

connections.method("holonomy", function(A, loop, q0)
  local own, B = A.own, A.own.bundle
  local x = groupoid.shapes(B, loop, 2, "A:holonomy")
  check_closed(B, x)
  check_steps(B, x)
  q0 = q0 == nil and bundles.at_section(B, x[1]) or B.take(q0, "q0")
  bundles.same_fibre(B, q0[1], x[1], "A:holonomy: q0 must lie over the first point of the loop")
  return bundles.between(B, q0, lifted(own, x, { x[1], q0[2] }))
end, [[
A:holonomy({x0, ..., xm} [, q0]) -> h
The lift of a closed loop of shapes from q0 (left out: { x0, identity }) ends at h q0. xm must be
x0, angles of dm.T(n) up to whole turns. Raises where the loop is open, and where an angle takes
half a turn or more in a step: the loop is too coarse.]])

return M
