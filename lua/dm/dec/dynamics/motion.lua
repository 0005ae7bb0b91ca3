--- Families of meshes: what they are at a time, and how fast their vertices and centres move.
local blame = require "dm.base.blame"
local core = require "dm.core"
local linear = require "dm.base.linear"
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

-- the first step tried, of max(1, |t|): beyond it the remainder, below it round-off is larger
local STEP = 2e-3
local RATIO = 3.7 -- of a step to the next one: no whole number, so that no period is met twice
local AGREE, MOST = 1e-9, 18 -- two steps that agree so well end it; so many are tried
local NEAR = 1e-3 -- where two agreed so well and shorter ones do not, round-off has begun

-- d/dt of a function that gives matrices, of order 6 in h
local function stencil(f, t, h)
  return (45 * (f(t + h) - f(t - h)) - 9 * (f(t + 2 * h) - f(t - 2 * h))
    + (f(t + 3 * h) - f(t - 3 * h))) / (60 * h)
end

-- the first step that stays where f is defined, and the derivative by it
local function first_step(f, t)
  local h, fine, D = STEP * math.max(1, math.abs(t)), nil, nil
  for _ = 1, MOST do
    fine, D = blame.try(stencil, f, t, h)
    if fine then return h, D end
    h = h / RATIO
  end
  error(D, 0)
end

-- The derivative by the step from which the next shorter one differs least: how fast a motion is
-- says neither t nor its points.
local function difference(f, t)
  local h, last = first_step(f, t)
  local least, best = math.huge, last
  for _ = 1, MOST do
    h = h / RATIO
    local now = stencil(f, t, h)
    local size = linear.largest(now)
    if size == 0 then break end -- at rest, or a motion below round-off
    local change = linear.largest(now - last) / size
    if change < least then least, best = change, last end
    if change <= AGREE or least < NEAR and change > 30 * least then break end -- else round-off
    last = now
  end
  return best
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
