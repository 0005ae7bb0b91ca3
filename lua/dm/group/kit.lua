--- What every group has in common. A kit is a table of functions of elements and algebra vectors
-- that were checked; each group's file gives its own closed forms, and `complete` derives what it
-- left out. The facts of a group are fields of its kit:
--   dimension, coordinates  of the algebra; how many flat coordinates an element has
--   abelian                 do all elements commute?
--   vectors                 are elements vectors, one number or lists of these, so that groups act
--                           on their entries?
--   euclidean               are they R^n, whose coordinates may be cut into points of R^k?
--   angles                  {[i] = true} for the flat coordinates that are angles
--   form                    what an element looks like, in words
--   turns()                 elements that are the identity in other coordinates
--   others()                elements of its other components, which exp does not reach
--   acts                    its standard actions: acts[kind](m) gives map(g, z) on R^m, or nothing
--   liftable                are its flat coordinates related by quadratic functions alone, which
--                           translations keep, as |q| = 1 or g J g^T = J? (mech/group_lift.c)
--   slope(xi, eta)          dexp with fewer operations in charts, of matrices with many dimensions
--   parts                   kits of the factors of a product
--   smooth                  flat coordinates of a run where those of `flat` jump (group/flat.lua)
--   momenta                 of standard actions of other groups on it, by their names: f(g, mu)
--   body                    where its elements put a rigid body: { pose(g) -> rotation matrix,
--                           place or nothing, turning =, moving = entries of the algebra before
--                           the angular velocity and that of the place }
--   by_series               is dexp a series of its matrices?
--   arcs(xi)                squares of the angles by which exp(xi) turns, below pi^2 where log is
--                           its inverse; nothing where it always is
--   manifold                true where it is none: a space without a product of its points
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local linear = class.module(function() return require "dm.base.linear" end)
local matrix_functions = class.module(function() return require "dm.group.matrix_functions" end)

local M = {}

local abs = math.abs

---- the kit of a space ----

local of_space, of_name = setmetatable({}, { __mode = "k" }), {}

-- dimensions that have closed forms in a file of their own
local SMALL = { ["SO(2)"] = "so2", ["SO(3)"] = "so3", ["SE(2)"] = "se2" }

--- The kit of a space, from the file in lua/dm/group that its row in geom/spaces.def names. Spaces
-- with factors have one of their own, others share it by name.
function M.of(space)
  local known = of_space[space] or space.own
  if known then return known end
  local name = not space.parts and tostring(space)
  local kit = name and of_name[name]
  if not kit then
    kit = require("dm.group." .. (SMALL[name] or space.kit)).kit(space.n, space)
    if name then of_name[name] = kit end
  end
  of_space[space] = kit
  return kit
end

--- Are all coordinates of the space angles?
function M.are_angles(space)
  local kit = M.of(space)
  return #kit.angles == kit.coordinates
end

--- Is a group a level set of quadratic functions of its flat coordinates that translations keep
-- (mech/group_lift.c), or have these no relation at all?
function M.is_liftable(kit)
  for _, part in ipairs(kit.parts or {}) do
    if not M.is_liftable(part) then return false end
  end
  return kit.parts ~= nil or kit.liftable or #kit.flat(kit.identity()) == kit.dimension
end

---- arguments ----

-- a list that cannot be set stands for a table
local function class_of(x)
  if type(x) ~= "userdata" then return type(x) end
  local meta = debug.getmetatable(x)
  local class = meta and meta.__name or "userdata"
  return class == "dm.list" and "table" or class
end
M.class_of = class_of

local SCALARS = { number = true, ["dm.symbol"] = true, ["dm.hyperdual"] = true }
function M.is_scalar(x) return SCALARS[class_of(x)] or false end

--- x as a vector of n entries; a bare number will do where n is 1.
function M.vector(x, n, what)
  local plain = core.plain(x, n)
  if plain then return plain end
  local class, length = class_of(x), nil
  if SCALARS[class] then
    x, length = { x }, 1
  elseif class == "dm.vector" or class == "table" then
    length = #x
  end
  if not length then
    error(("%s must be a vector of %d entries (got %s)"):format(what, n, class), 0)
  end
  if length ~= n then error(("%s must have %d entries (got %d)"):format(what, n, length), 0) end
  if class == "dm.vector" then return core.vector(x) end
  local fine, out = blame.try(core.vector, x)
  if not fine then error(("%s: %s"):format(what, blame.bare(out)), 0) end
  return out
end

--- x as a number or symbol; a vector of one entry will do.
function M.scalar(x, what)
  if SCALARS[class_of(x)] then return x end
  return M.vector(x, 1, what)[1]
end

--- x as an n x n matrix.
function M.matrix(x, n, what)
  local class = class_of(x)
  if class ~= "dm.matrix" and class ~= "table" then
    error(("%s must be a matrix of %d x %d (got %s)"):format(what, n, n, class), 0)
  end
  if class == "table" then
    local fine, m = blame.try(core.matrix, x)
    if not fine then
      error(("%s must be a matrix of %d x %d: %s"):format(what, n, n, m:match "%((.*)%)$" or m), 0)
    end
    x = m
  end
  if x.rows ~= n or x.columns ~= n then
    error(("%s must be a matrix of %d x %d (got %d x %d)"):format(what, n, n, x.rows, x.columns), 0)
  end
  return x
end

--- Euclidean norm of a list, without underflow.
function M.norm(list) return core.vector(list):norm() end

--- n numbers, normal with that deviation, of place i of a dm.random.
M.normals = core.normals

-- the entries of a and of its differential are lists; T(compose) by the graph where no closed form
-- is given
local function tangents(kit)
  local entries, rebuild, slopes = kit.entries, kit.rebuild, {}
  local function slope(name, compose)
    if not slopes[name] then
      local n = #entries(kit.identity())
      slopes[name] = core.derivative(
        function(g, h) return core.vector(entries(compose(rebuild(g), rebuild(h)))) end, n, n)
    end
    return slopes[name]
  end
  local function along(name, compose, g, h, w)
    local a, b, c = entries(g), entries(h), entries(w)
    local J, n, out = slope(name, compose)(core.vector(a), core.vector(b)), #b, {}
    for i = 1, n do
      local sum = 0
      for k = 1, n do sum = sum + J[i][n + k] * c[k] end
      out[i] = sum
    end
    return rebuild(out)
  end
  kit.left_tangent = kit.left_tangent or function(g, h, w)
    return along("left", kit.compose, g, h, w)
  end
  kit.right_tangent = kit.right_tangent or function(g, h, w)
    return along("right", function(a, b) return kit.compose(b, a) end, g, h, w)
  end
end

-- differential of exp and of the coadjoint action from ad and Ad
local function differentials(kit)
  local r = kit.dimension
  local function phi(xi)
    return matrix_functions.phi(linear.matrix_of(function(eta) return kit.ad(xi, eta) end, r))
  end
  kit.dexp = kit.dexp or function(xi, eta) return phi(xi) * eta end
  kit.dexpinv = kit.dexpinv or function(xi, eta) return phi(xi):solve(eta) end
  kit.coAd = kit.coAd or function(g, mu)
    local inverse = kit.inverse(g)
    return linear.matrix_of(function(xi) return kit.Ad(inverse, xi) end, r):transpose() * mu
  end
  kit.coad = kit.coad or function(xi, mu)
    return linear.matrix_of(function(eta) return kit.ad(xi, eta) end, r):transpose() * mu
  end
end

local UNREACHED = 1e12  -- entries of 2 (g - 1)(g + 1)^-1 that are nothing but round-off

-- what a matrix group's Cayley map is: x = hat(xi), (1 - x/2)^-1 (1 + x/2), with the differential
-- (1 - x/2)^-1 y (1 + x/2)^-1
local function cayley_of_matrices(kit)
  if not (kit.hat and kit.vee) or kit.no_cayley then return end
  local function half(xi)
    local x = kit.hat(xi) * 0.5
    return x, core.identity(x.rows)
  end
  kit.cayley = kit.cayley or function(xi)
    local x, one = half(xi)
    return kit.from_matrix((one - x):solve(one + x))
  end
  kit.cayleyinv = kit.cayleyinv or function(g)
    local m = kit.matrix(g)
    local one = core.identity(m.rows)
    local fine, x = blame.try(m.solve, m + one, m - one)
    if not fine or linear.is_plain(x) and linear.size(x) > UNREACHED then
      error("the Cayley map does not reach this element: -1 is one of its eigenvalues", 0)
    end
    return kit.vee(x * 2)
  end
  kit.dcay = kit.dcay or function(xi, eta)
    local x, one = half(xi)
    return kit.vee((one - x):solve(kit.hat(eta)) * (one + x):inverse())
  end
  kit.dcayinv = kit.dcayinv or function(xi, eta)
    local x, one = half(xi)
    return kit.vee((one - x) * kit.hat(eta) * (one + x))
  end
end

-- the Pade approximants of exp by way of the Cayley map: kit.cayley(kit.pade(k, xi)), and what the
-- rate eta of xi is that of its argument
local function pade_of_matrices(kit)
  if kit.euclidean then
    function kit.pade(_, xi, eta) return xi, eta end
  elseif kit.cayley and kit.hat and kit.vee and not kit.pade then
    function kit.pade(k, xi, eta)
      local z, dz = matrix_functions.pade(k, kit.hat(xi), eta and kit.hat(eta))
      return kit.vee(z), eta and kit.vee(dz)
    end
  end
end

local function list_of(x)
  local out = {}
  for i = 1, #x do out[i] = x[i] end
  return out
end

--- Derive from what a kit has (identity, compose, inverse, exp, log, Ad, ad, entries, rebuild ...)
-- what it has not.
function M.complete(kit)
  kit.entries = kit.entries or list_of
  kit.rebuild = kit.rebuild or core.vector
  kit.flat, kit.unflat = kit.flat or kit.entries, kit.unflat or kit.rebuild
  kit.bonds = kit.bonds or function() return {} end
  kit.coordinates = kit.coordinates or #kit.flat(kit.identity())
  kit.sample = kit.sample or function(stream, i)
    return kit.exp(M.normals(stream, i, kit.dimension, 1))
  end
  kit.distance = kit.distance or function(a, b)
    return M.norm(kit.log(kit.compose(kit.inverse(a), b)))
  end
  kit.project = kit.project or function(g) return g end
  kit.defect = kit.defect or function() return 0 end
  kit.from_matrix = kit.from_matrix or function(m) return m end
  kit.turns = kit.turns or function() return {} end
  kit.others = kit.others or function() return {} end
  kit.angles, kit.acts = kit.angles or {}, kit.acts or {}
  kit.form = kit.form or ("a vector of %d number%s")
    :format(kit.coordinates, kit.coordinates == 1 and "" or "s")
  kit.near = kit.near or kit.exp  -- touches exp at 0, for derivatives there
  kit.left = kit.compose
  function kit.right(g, h) return kit.compose(h, g) end
  differentials(kit)
  tangents(kit)
  cayley_of_matrices(kit)
  pade_of_matrices(kit)
  return kit
end

--- Is every entry of the list a finite number (or a symbol)?
function M.is_finite(list)
  local size = class_of(list) == "dm.vector" and list:norm()
  if type(size) == "number" and size < math.huge then return true end
  for i = 1, #list do
    local x = list[i]
    if type(x) == "number" and not (abs(x) < math.huge) then return false end
  end
  return true
end

M.list_of = list_of

---- geodesics of a manifold from a point ----

-- the factors of a product that are groups go by left translation, g exp(xi)

function M.tangent(kit, z, w)
  if kit.tangent then return kit.tangent(z, w) end
  return M.vector(w, kit.dimension, "the tangent vector of a group, an element of its algebra,")
end

function M.shoot(kit, z, w)
  if kit.shoot then return kit.shoot(z, w) end
  return kit.compose(z, kit.exp(w))
end

function M.aim(kit, z, y)
  if kit.aim then return kit.aim(z, y) end
  return kit.log(kit.compose(kit.inverse(z), y))
end

return M
