--- The trivial bundle Q = S x G that a connection lives on: points { x, g }, the group moves g from
-- the left. What a user gave becomes a point or is told; what goes out may have another shape (the
-- vectors of a system's Q, of mechanical connections).
--
-- A bundle, made by `M.of`:
--   group, base   the spaces; kit that of the group
--   n, d          dimensions of S and of G
--   angles        {[i] = true} for the coordinates of S that are angles
--   take(q, what) -> { x, g }, checked;  give(q) -> the same as the user sees it
local blame = require "dm.base.blame"
local core = require "dm.core"
local groups = require "dm.group"
local kits = require "dm.group.kit"

local M = {}

local abs, pi = math.abs, math.pi

--- Text of a number, a vector, an element or a point, on one line.
local show = require "dm.action.points".show
M.show = show

---- what a user gives ----

--- x as a point of the base, n finite numbers or symbols; a bare number will do where n is 1.
function M.base_point(bundle, x, what)
  local out = kits.vector(x, bundle.n, what)
  if not kits.is_finite(out) then error(what .. " is not finite", 0) end
  return out
end

--- g as an element of the group; what is none says what it was.
function M.element(bundle, g, what)
  local fine, out = blame.try(groups.element, bundle.group, g)
  if not fine then error(("%s: %s"):format(what, out), 0) end
  return out
end

local function take(bundle, q, what)
  local point = ("%s must be a point of the bundle, a list { x, g } of %d number%s and an element "
    .. "of %s"):format(what, bundle.n, bundle.n == 1 and "" or "s", tostring(bundle.group))
  if kits.class_of(q) ~= "table" or #q ~= 2 then
    error(("%s (got %s)"):format(point,
      kits.class_of(q) == "table" and ("a list of %d"):format(#q) or kits.class_of(q)), 0)
  end
  local fine, x = blame.try(M.base_point, bundle, q[1], what .. ": x")
  if not fine then error(("%s; %s"):format(x, point), 0) end
  return { x, M.element(bundle, q[2], what .. ": g") }
end

local function check_base(base, where)
  local kit = kits.of(base)
  if base.chart and not kit.manifold then return kit end
  error(("%s: points of the base are given by their coordinates: the base must be dm.R(n), dm.T(n) "
    .. "or a product of these (got %s); take a chart of it"):format(where, tostring(base)), 0)
end

--- The bundle base x group, of spaces.
function M.of(group, base, where)
  local bundle = { group = group, base = base, kit = groups.group(group), n = base.dimension,
    d = group.dimension, angles = check_base(base, where).angles }
  function bundle.take(q, what) return take(bundle, q, what) end
  function bundle.give(q) return core.result { q[1], q[2] } end
  return bundle
end

---- fibres ----

local NEAR = 1e-9  -- how far apart points of one fibre may be, by round-off

-- beside the size of the coordinates, and as it is; whole turns apart are one angle
local function apart(bundle, a, b)
  local worst, gap = 0, 0
  for i = 1, bundle.n do
    local d = a[i] - b[i]
    if type(d) ~= "number" then return 0, 0 end  -- symbols are taken at their word
    if bundle.angles[i] then d = math.fmod(d, 2 * pi) end
    if bundle.angles[i] and abs(d) > pi then d = 2 * pi - abs(d) end
    gap = math.max(gap, abs(d))
    worst = math.max(worst, abs(d) / (1 + (bundle.angles[i] and 0 or abs(a[i]))))
  end
  return worst, gap
end

--- Do two points of the base agree, angles up to whole turns? And how far apart they are.
function M.agree(bundle, a, b)
  local off, gap = apart(bundle, a, b)
  return off <= NEAR, gap
end

--- Raises where two points are of different fibres.
function M.same_fibre(bundle, a, b, text, ...)
  local fine, off = M.agree(bundle, a, b)
  if fine then return end
  error(("%s: the fibres over x = %s and x = %s do not match (they are %.3g apart)")
    :format(text:format(...), show(a), show(b), off), 0)
end

--- h q
function M.move(bundle, h, q) return { q[1], bundle.kit.compose(h, q[2]) } end

--- The k with q = k r, of points of one fibre.
function M.between(bundle, r, q) return bundle.kit.compose(q[2], bundle.kit.inverse(r[2])) end

--- h g h^-1
function M.conjugate(bundle, h, g)
  local kit = bundle.kit
  return kit.compose(kit.compose(h, g), kit.inverse(h))
end

--- The point (x, e).
function M.at_section(bundle, x) return { x, bundle.kit.identity() } end

--- log(a b^-1), and its length: how far two elements are apart.
function M.distance(bundle, a, b)
  local kit = bundle.kit
  local xi = kit.log(kit.compose(a, kit.inverse(b)))
  return core.vector(xi):norm()
end

return M
