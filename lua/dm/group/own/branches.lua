--- Logarithms of other branches, for groups of a basis. The principal logarithm of exp(x) need not
-- lie in the algebra where x does: two planes that turn at the rates 1 and 2 by 2 and 4 rad, a
-- diagonal of SU(3) by 2.5, 2.5 and -5. Seen from an element exp(x) that is not far it does:
-- exp(-x) g = exp(d) with d in the algebra says that g is on the group. Its logarithms are the
-- principal one and whole turns of the planes in which g turns.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local matrix_functions = require "dm.group.matrix_functions"

local M = {}

local LOOSE = 1e-6 -- how far g may be from exp of its logarithm
local STARTS = 64  -- elements that g is seen from
local REACH = 16   -- rad, of the farthest of them
local NEAR = 0.01  -- how far g may be from an element of another branch that it is taken for
local MOST = { 8, 8, 3, 2, 2, 1, 1, 1 } -- whole turns of a plane, of so many
local TRIES, ASIDE, ITERATIONS, ROUND_OFF = 8, 0.1, 12, 1e-13
local SAME = 1e-7  -- how far apart equal eigenvalues may be, beside them

--- |g - h| beside g.
local function distance(g, h) return linear.largest(g - h) / math.max(1, linear.largest(g)) end

-- d with exp(d) near g, and how far; nothing where g has no principal logarithm
local function principal(kit, g)
  local fine, d = blame.try(kit.principal, g)
  if fine then return d, distance(g, kit.exp(d)) end
end

-- elements exp(x) exp(d) near g, and how far each is, seen from one exp(x) after the other
local function views(kit, g)
  local stream, k = core.random(13), 0
  return function()
    while k < STARTS do
      k = k + 1
      local x = kits.normals(stream, k, kit.dimension, 1)
      x = x * (REACH * k / STARTS / math.max(linear.size(kit.hat(x)), 1e-300))
      local fine, d = blame.try(kit.principal, kit.exp(-x) * g)
      local h = fine and kit.exp(x) * kit.exp(d)
      if h then return h, distance(g, h) end
    end
  end
end

--- The element near g: that of the principal logarithm, but where g is very near another one.
function M.project(kit, g)
  local _, off
  if linear.is_plain(g) then _, off = principal(kit, g) end
  if off and off > LOOSE then
    for h, seen in views(kit, g) do
      if seen <= NEAR then return h end
    end
  end
  return kit.exp(kit.principal(g))
end

---- other logarithms ----

local function is_same(e, f)
  return math.abs(e.a - f.a) + math.abs(e.b - f.b) <= SAME * (math.abs(e.a) + math.abs(e.b))
end

-- eigenvalues a + i b with b >= 0, each once, with how often it occurs
local function eigenvalues(g)
  local re, im = g:eigenvalues()
  local out = {}
  for i = 1, #re do
    local e, known = { a = re[i], b = im[i], count = 1 }, nil
    for _, other in ipairs(out) do
      if is_same(other, e) then known = other end
    end
    if known then known.count = known.count + 1 elseif e.b >= 0 then out[#out + 1] = e end
  end
  return out
end

-- Rotations J of the planes of complex eigenvalues, J^2 = -1 there and J = 0 elsewhere: g is as
-- a + b J on its plane, and the product R of g - other eigenvalues as u + v J, so that
-- J = R (v + u (g - a)/b) / (u^2 + v^2).
local function turns(g)
  local one, list, out = core.identity(g.rows), eigenvalues(g), {}
  for _, e in ipairs(list) do
    if e.b > SAME * math.abs(e.a) then
      local R, u, v = one, 1, 0
      local function times(factor, x, y) R, u, v = R * factor, u * x - v * y, u * y + v * x end
      for _, other in ipairs(list) do
        local shifted, x = g - other.a * one, e.a - other.a
        for _ = 1, other ~= e and other.count or 0 do
          if other.b == 0 then
            times(shifted, x, e.b)
          else
            times(shifted * shifted + other.b ^ 2 * one, x ^ 2 - e.b ^ 2 + other.b ^ 2, 2 * x * e.b)
          end
        end
      end
      local size = u * u + v * v
      out[#out + 1] = R * (v / size * one + u / (size * e.b) * (g - e.a * one))
    end
  end
  return out
end

-- the part of a matrix across the algebra
local function across(kit, m) return m - kit.hat(kit.vee(m)) end

-- sum a_ij b_ij
local function inner(a, b) return (a:transpose() * b):trace() end

-- The shortest of L + 2 pi sum n_j J_j that lies in the algebra, L the principal logarithm; nil.
-- The last n_j is what the others ask for, unless its plane turns within the algebra.
local function other_branch(kit, g)
  local L, J = matrix_functions.log(g), turns(g)
  local most, sides, best, least = MOST[#J] or 0, {}, nil, math.huge
  for j, turn in ipairs(J) do
    J[j] = 2 * math.pi * turn
    sides[j] = across(kit, J[j])
  end
  local function go(k, off, X)
    if k > #J then
      local x = kit.vee(X)
      if linear.largest(off) <= LOOSE and x:norm() < least then best, least = x, x:norm() end
      return
    end
    local from, to, size = -most, most, inner(sides[k], sides[k])
    if k == #J and size > LOOSE then
      from = math.floor(0.5 - inner(sides[k], off) / size)
      to = from
    end
    for n = from, to do go(k + 1, off + n * sides[k], X + n * J[k]) end
  end
  go(1, across(kit, L), L)
  return best and distance(g, kit.exp(best)) <= LOOSE and best or nil
end

-- Where eigenvalues are -1, in pairs, as of half turns, or nearly so: from the logarithm of an
-- element beside g, by Newton's method, g = exp(r) exp(x) with exp(x + dexpinv(x, r)) near; nil.
local function on_cut(kit, g)
  local stream = core.random(29)
  for k = 1, TRIES do
    local aside = kits.normals(stream, k, kit.dimension, 1)
    aside = aside * (ASIDE / math.max(linear.size(kit.hat(aside)), 1e-300))
    local x, off = principal(kit, kit.exp(aside) * g)
    for _ = 1, x and off <= LOOSE and ITERATIONS or 0 do
      local r = principal(kit, g * kit.exp(-x))
      local fine, step = blame.try(kit.dexpinv, x, r or x)
      if not (r and fine) then break end
      x = x + step
      if distance(g, kit.exp(x)) <= ROUND_OFF then return x end
    end
  end
end

--- The logarithm of a matrix of numbers; of symbols the principal one.
function M.log(kit, g)
  if not linear.is_plain(g) then return kit.principal(g) end
  local d, off = principal(kit, g)
  if d and off <= LOOSE then return d end
  if not d then return on_cut(kit, g) or kit.principal(g) end -- says why there is none
  return other_branch(kit, g) or on_cut(kit, g)
    or error("no logarithm of the matrix lies in the algebra", 0)
end

--- How far g is from the group, by its principal logarithm, or its square's, where it has one.
function M.defect(kit, g)
  local d, off = principal(kit, g)
  if not d then off = select(2, principal(kit, g * g)) end
  if not off or off <= LOOSE then return off or 0 end
  local x = d and other_branch(kit, g)
  if x then return distance(g, kit.exp(x)) end
  for _, seen in views(kit, g) do
    if seen < off then off = seen end
    if off <= LOOSE then break end
  end
  return off
end

return M
