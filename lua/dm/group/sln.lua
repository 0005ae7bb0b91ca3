--- SL(n): flat coordinates are the entries of the matrix.
local acts = require "dm.group.acts"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = class.module(function() return require "dm.base.linear" end)
local matrices = require "dm.group.matrices"
local smooth = require "dm.group.smooth"

local M = {}

local abs = math.abs

---- SL(2): {{a, b}, {c, -a}} squared is -t with t = -a^2 - b c ----

local function hat2(xi) return core.matrix { { xi[1], xi[2] }, { xi[3], -xi[1] } } end

local function square2(xi) return -(xi[1] * xi[1] + xi[2] * xi[3]) end

local function exp2(xi)
  local t = square2(xi)
  return core.identity(2) * smooth.stumpff(0, t) + hat2(xi) * smooth.stumpff(1, t)
end

-- x/sin x at c = cos x, t = sin^2 x: two halvings of the angle near the identity, atan2 and the
-- logarithm away from it
local NEAR = 0.5
local function angle_ratio(c, t)
  local choose, guarded = smooth.choose, smooth.guarded
  -- > 0: by atan2
  local turned = choose(c, function() return t - NEAR end, function() return 1 end)
  local function near()
    local c1 = core.sqrt(0.5 * (1 + guarded(c, c)))
    local t1 = t / (4 * c1 * c1)
    local c2 = core.sqrt(0.5 * (1 + c1))
    return smooth.arc_signed(c2, t1 / (4 * c2 * c2)) / (c1 * c2)
  end
  local function circular()
    local s = core.sqrt(guarded(turned, t))
    return core.atan(s, c) / s
  end
  local function hyperbolic()
    local s = core.sqrt(guarded(-NEAR - t, -t))
    return core.log(s + guarded(c, c)) / s
  end
  return choose(turned, circular, function() return choose(-NEAR - t, hyperbolic, near) end)
end

--- The logarithm of a matrix of determinant 1: (g - c) x/sin x, c = cos x half its trace
function M.log2(g)
  local c, d = 0.5 * (g[1][1] + g[2][2]), 0.5 * (g[1][1] - g[2][2])
  local t = -(d * d + g[1][2] * g[2][1])
  if type(c) == "number" and type(t) == "number" and c <= 0 and not (t > 0) then
    if d == 0 and g[1][2] == 0 and g[2][1] == 0 then return core.vector { 0, -math.pi, math.pi } end
    error(("the matrix has no real logarithm: its trace is %g, and it is no rotation")
      :format(2 * c), 0)
  end
  local ratio = angle_ratio(c, t)
  return core.vector { d * ratio, g[1][2] * ratio, g[2][1] * ratio }
end

local function adjugate(g) return core.matrix { { g[2][2], -g[1][2] }, { -g[2][1], g[1][1] } } end

---- SL(n): the trace is zero, so that the last entry is left out ----

local function unit_determinant(g, n)
  local det = g:det()
  if type(det) == "number" and not (det > 0) then
    error(("no positive multiple of the matrix has determinant 1: its own is %g"):format(det), 0)
  end
  return g * det ^ (-1 / n)
end

--- Coordinates of n x n matrices of determinant 1 (group/flat.lua): g^-1 g' less its trace over n,
-- and that.
function M.homogeneous(kit, n)
  local function scale(list)
    local det, out = kit.rebuild(list):det(), {}
    local s = n == 2 and core.sqrt(det) or det ^ (1 / n)
    for i = 1, n * n do out[i] = s end
    return out
  end
  local function velocity(list, rates)
    local W = kit.inverse(kit.rebuild(list)) * kit.rebuild(rates)
    local trace = 0
    for i = 1, n do trace = trace + W[i][i] * (1 / n) end
    local out = kits.list_of(kit.vee(W - core.identity(n) * trace))
    out[#out + 1] = trace
    return out
  end
  return { scale = scale, velocity = velocity, scales = 1 }
end

function M.kit(n)
  local kit = { dimension = n * n - 1, no_cayley = n > 2, liftable = n == 2 }
  kit.acts = { linear = acts.linear(kit, n), projective = acts.projective(kit, n) }
  function kit.hat(xi)
    local trace = 0
    for i = 1, n - 1 do trace = trace + xi[(i - 1) * n + i] end
    return linear.fill(n, n, function(i, j)
      return i == n and j == n and -trace or xi[(i - 1) * n + j]
    end)
  end
  function kit.vee(m)
    local list = matrices.entries(m)
    list[n * n] = nil
    return core.vector(list)
  end
  function kit.bonds(list) return { kit.rebuild(list):det() - 1 } end
  function kit.project(g) return unit_determinant(g, n) end
  function kit.defect(g)
    local det = g:det()
    return abs(det - 1) / math.max(1, linear.largest(g)) ^ n,
      ("its determinant is %.9g, not 1"):format(det)
  end
  if n == 2 then kit.hat, kit.exp, kit.log, kit.inverse = hat2, exp2, M.log2, adjugate end
  kit.sample = matrices.from_exponentials(kit)
  kit.smooth = M.homogeneous(kit, n)
  return matrices.complete(kit, n)
end

return M
