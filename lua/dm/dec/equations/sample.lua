--- Numbers on cells from what a script gives for them: a number, a function of the point, a form, a
-- list or a vector.
local blame = require "dm.base.blame"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"
local pointwise = require "dm.dec.pointwise"

local M = {}

local function finite(x) return type(x) == "number" and x - x == 0 end

-- f at row i of a matrix of points, a number; `maybe`: or nil
function M.at_point(f, points, i, where, what, maybe)
  local point = points[i]:totable()
  local x = pointwise.told(#point, core.one(f, what), table.unpack(point))
  if maybe and x == nil then return nil end
  if not finite(x) then
    option.fail(where, "%s must give finite numbers (got %s at point %d)", what, option.got(x), i)
  end
  return x
end

--- One number for every cell. points(): where functions are asked, a matrix with a row for each
-- cell; kind = { degree, side } of forms that may be given; count: of the cells.
function M.values(x, K, kind, count, points, where, what)
  if finite(x) then return core.constant(count, x) end
  if form.is_form(x) then
    if not rawequal(x.mesh, K) or x.degree ~= kind.degree or x.side ~= kind.side then
      option.fail(where, "%s must be a %s %d-form of this mesh (got a %s)", what, kind.side,
        kind.degree, form.name(x))
    end
    return x.values
  end
  if type(x) == "function" then
    local at, out = points(), core.vector(count)
    for i = 1, count do out[i] = M.at_point(x, at, i, where, what) end
    return out
  end
  local fine, values = blame.try(core.vector, x)
  if x == nil or not fine or #values ~= count then
    option.fail(where, "%s must be a number, a function of the point, a form or a list of %d "
      .. "numbers (got %s)", what, count, option.got(x))
  end
  return values
end

--- x(i) of boundary facet i, from a number, or a function that is asked at the circumcentre of the
-- facet and may give nil; without x: nil everywhere.
function M.on_facets(K, x, where, what)
  local centres
  if x == nil then return function() end end
  if finite(x) then return function() return x end end
  if type(x) == "function" then
    return function(i)
      centres = centres or K:circumcentres(K.dimension - 1)
      return M.at_point(x, centres, i, where, what, true)
    end
  end
  option.fail(where, "%s must be a number or a function of the point (got %s)", what, option.got(x))
end

--- The mean of the points of every k-cell.
function M.barycentres(K, k)
  local points, cells, out = K:points(), K:simplices(k), {}
  for i, cell in ipairs(cells) do
    local sum = points[cell[1]]
    for j = 2, #cell do sum = sum + points[cell[j]] end
    out[i] = sum / #cell
  end
  return out
end

return M
