--- Groups of n x n matrices: what they share, given hat, vee and what is special about them.
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local matrix_functions = class.module(function() return require "dm.group.matrix_functions" end)

local M = {}

local function entries(m)
  local out, n = {}, 0
  for _, row in ipairs(m:totable()) do
    for j = 1, #row do out[n + j] = row[j] end
    n = n + #row
  end
  return out
end

-- Frobenius norm of a - b
local function separation(a, b) return kits.norm(entries(a - b)) end

--- Random elements as products of two exponentials.
function M.from_exponentials(kit)
  return function(stream, i)
    return kit.compose(kit.exp(kits.normals(stream, i, kit.dimension, 0.7)),
      kit.exp(kits.normals(stream, i + 2 ^ 31 | 0, kit.dimension, 0.7)))
  end
end

-- the differential of exp by a few tens of products of n x n matrices, or by a few of d x d ones
local MANY = 3

--- Complete a kit of n x n matrices: elements are these matrices.
function M.complete(kit, n)
  kit.form = ("a matrix of %d x %d"):format(n, n)
  kit.identity = kit.identity or function() return core.identity(n) end
  kit.element = kit.element or function(g) return kits.matrix(g, n, "the group element") end
  kit.compose = kit.compose or function(a, b) return a * b end
  kit.inverse = kit.inverse or function(g) return g:inverse() end
  kit.exp = kit.exp or function(xi) return matrix_functions.exp(kit.hat(xi)) end
  kit.by_series = kit.dexp == nil
  if not kit.dexp and MANY * n ^ 3 < kit.dimension ^ 3 then
    function kit.slope(xi, eta)
      return kit.vee(matrix_functions.dexp(kit.hat(xi), kit.hat(eta)))
    end
  end
  kit.near = function(xi) return core.identity(n) + kit.hat(xi) end
  kit.log = kit.log or function(g) return kit.vee(matrix_functions.log(g)) end
  kit.Ad = kit.Ad or function(g, xi) return kit.vee(g * kit.hat(xi) * kit.inverse(g)) end
  kit.ad = kit.ad or function(xi, eta)
    local x, y = kit.hat(xi), kit.hat(eta)
    return kit.vee(x * y - y * x)
  end
  kit.matrix = kit.matrix or function(g) return g end
  kit.entries = entries
  kit.rebuild = function(list)
    local rows = {}
    for i = 1, n do rows[i] = { table.unpack(list, (i - 1) * n + 1, i * n) } end
    return core.matrix(rows)
  end
  kit.left_tangent = function(g, _, w) return g * w end
  kit.right_tangent = function(g, _, w) return w * g end
  kit.distance = kit.distance or separation
  kit.raw = function(m) return kits.matrix(m, n, "the matrix") end
  return kits.complete(kit)
end

M.entries = entries

return M
