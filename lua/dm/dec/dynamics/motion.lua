--- Families of meshes: what they are at a time, and how fast their vertices and centres move.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "dm.diffeo"
local fail = option.failing(WHERE)

-- what the family gives at t
local function value_at(phi, t)
  local x = phi.family(t)
  if option.got(x) == "dm.mesh" or lists.count(x) then return x end
  fail("the family must give a mesh or a list of points (got %s at t = %s)", option.got(x),
    tostring(t))
end

--- The mesh at time t. Its duals are made like those of the first one.
function M.mesh_at(phi, t)
  local x, K = value_at(phi, t), phi.from
  if option.got(x) == "dm.mesh" then return x end
  if #x ~= K:count(0) then
    fail("the family gives %d points at t = %.6g, but the mesh has %d vertices", #x, t, K:count(0))
  end
  return core.complex { points = x, simplices = K:simplices(K.dimension), dual = K.dual }
end

---- derivatives ----

-- the derivative parts of points that are functions of a hyper-dual number; nil where it is refused
local function exact(phi, t)
  local fine, points = blame.try(phi.family, core.hyperdual(t, 1))
  if not fine or option.got(points) == "dm.mesh" or not lists.count(points) then return nil end
  local rows = {}
  for i = 1, #points do
    local row, p = {}, points[i]
    for c = 1, lists.count(p) or 0 do
      row[c] = option.got(p[c]) == "dm.hyperdual" and p[c].a or type(p[c]) == "number" and 0 or nil
      if not row[c] then return nil end
    end
    rows[i] = row
  end
  return #rows == phi.from:count(0) and core.matrix(rows) or nil
end

local STEP = 2e-3 -- of max(1, |t|): beyond it the remainder, below it round-off is larger

-- d/dt of a function that gives matrices, of order 6
local function difference(f, t)
  local h = STEP * math.max(1, math.abs(t))
  return (45 * (f(t + h) - f(t - h)) - 9 * (f(t + 2 * h) - f(t - 2 * h))
    + (f(t + 3 * h) - f(t - 3 * h))) / (60 * h)
end

--- The velocity of the vertices, a matrix with a row each.
function M.velocity(phi, t)
  local V = exact(phi, t)
  return V or difference(function(s) return M.mesh_at(phi, s):points() end, t)
end

--- That of the circumcentres of the k-cells.
function M.dual_velocity(phi, t, k)
  return difference(function(s) return M.mesh_at(phi, s):circumcentres(k) end, t)
end

return M
