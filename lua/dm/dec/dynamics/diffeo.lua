--- dm.diffeo: discrete diffeomorphisms (Leok 3.13): a mesh and its image are two realizations of
-- one abstract complex, so a map is a pair of meshes with the same simplices, and a motion a family
-- of pairs with the same first one.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local field = require "dm.dec.field"
local form = require "dm.dec.form"
local linear = require "dm.dec.cell_map"
local motion = require "dm.dec.dynamics.motion"
local option = require "dm.base.options"
local pair = require "dm.dec.dynamics.pair"

local M = {}

local Diffeo = core.class({ __name = "dm.diffeo" }, [[
dm.diffeo: a discrete diffeomorphism, or a family of them, made by dm.diffeo(K1, K2 | f)
fields: from, to (meshes; of a family to is nil); phi(t) is the member of a family at time t]])

local WHERE = "dm.diffeo"
local fail = option.failing(WHERE)

local function is_mesh(x) return option.got(x) == "dm.mesh" end

---- what is one ----

local function check_mesh(K, which)
  if not is_mesh(K) then fail("%s must be a mesh (got %s)", which, option.got(K)) end
  if not K.ambient then
    fail("%s has no points: make it with points =", which)
  end
end

-- the first cell whose vertices differ, or nil
local function other_cell(K, L)
  local n = K.dimension
  if L.dimension ~= n then return n end
  local cells, images = K:simplices(n), L:simplices(n)
  for i = 1, math.max(#cells, #images) do
    if not cells[i] or not images[i] or not pair.same(cells[i], images[i]) then return n, i end
  end
  return K:count(0) ~= L:count(0) and 0 or nil
end

local function check_same_complex(K, L)
  local degree, i = other_cell(K, L)
  if degree then
    fail("the meshes are not realizations of one complex: they differ at cell %s of degree %d; "
      .. "dm.simplicial_map takes maps of vertices", tostring(i or "numbers"), degree)
  end
end

-- no cell may change its orientation where the space has one
local function check_orientation(K, L)
  local n = K.dimension
  if K.ambient ~= n or L.ambient ~= n then return end
  local before, after, cells = linear.signs(K), linear.signs(L), nil
  for i = 1, #before do
    if before[i] ~= after[i] then
      cells = K:simplices(n)
      fail("the map inverts cell {%s}: its volume changes the sign", table.concat(cells[i], ", "))
    end
  end
end

local function new(K, L)
  check_same_complex(K, L)
  check_orientation(K, L)
  return setmetatable({ from = K, to = L }, Diffeo)
end

--- A map, or a family.
M.diffeo = blame.caller(function(K, L)
  check_mesh(K, "the first argument")
  if type(L) == "function" then
    -- images: meshes by time, while somebody has them
    return setmetatable({ from = K, family = option.single(L, "f(t)"),
      images = setmetatable({}, { __mode = "v" }) }, Diffeo)
  end
  check_mesh(L, "the second argument")
  return new(K, L)
end)

core.docs[M.diffeo] = [[
dm.diffeo(K1, K2) -> dm.diffeo   or   dm.diffeo(K1, f) -> dm.diffeo
The map of a mesh to another one with the same simplices and other points: vertices go to vertices,
each cell to its namesake by a linear map. f(t): a family, whose values are meshes or lists of
points; phi(t) is its member. Raises where the meshes are of two complexes, and where a cell is
inverted (in a space of the dimension of the mesh); degenerate images are no meshes, so dm.mesh
names their cell (Leok 3.13).]]

---- families ----

Diffeo.__call = blame.caller(function(phi, t)
  if not phi.family then option.fail("phi(t)", "this map does not depend on time") end
  if type(t) ~= "number" or t - t ~= 0 then
    option.fail("phi(t)", "a time is needed (got %s)", option.got(t))
  end
  local image = phi.images[t] -- forms and fields of it are of this very mesh
  if image then return setmetatable({ from = phi.from, to = image }, Diffeo) end
  local member = new(phi.from, motion.mesh_at(phi, t))
  phi.images[t] = member.to
  return member
end)

-- the map itself: not a family
local function single(phi, where)
  if phi.family then option.fail(where, "this is a family: take a member, phi(t)") end
  return phi
end

function Diffeo.__tostring(phi)
  return ("%s of a %s"):format(phi.family and "a family of diffeomorphisms" or "diffeomorphism",
    phi.from)
end

---- maps ----

local function is_diffeo(x) return getmetatable(x) == Diffeo end

local function same_mesh(K, L)
  if rawequal(K, L) then return true end
  return K.ambient == L.ambient and K.dual == L.dual and not other_cell(K, L)
    and K:points() == L:points()
end

class.method("dm.diffeo", "inverse", function(phi)
  single(phi, "diffeo:inverse")
  return setmetatable({ from = phi.to, to = phi.from }, Diffeo)
end, "phi:inverse() -> dm.diffeo\nThe map back.")

class.method("dm.diffeo", "compose", function(phi, psi)
  local where = "diffeo:compose"
  if not is_diffeo(psi) then
    option.fail(where, "a dm.diffeo is needed (got %s)", option.got(psi))
  end
  single(phi, where)
  single(psi, where)
  if same_mesh(psi.to, phi.from) then return new(psi.from, phi.to) end
  if same_mesh(phi.to, psi.from) then return new(phi.from, psi.to) end
  option.fail(where, "the maps cannot be composed: neither ends on the mesh where the other begins")
end, [[
phi:compose(psi) -> dm.diffeo
phi after psi, where psi ends on the mesh that phi begins with; else psi after phi. Raises where
neither fits.]])

class.method("dm.diffeo", "pair", function(phi)
  single(phi, "diffeo:pair")
  return pair.pair(phi.from, phi.to)
end, "phi:pair() -> dm.pair\nThe element (from, to) of the pair groupoid of realizations.")

---- forms ----

local function carried(a, from, to, where)
  if not form.is_form(a) or not rawequal(a.mesh, from) then
    option.fail(where, "a form or a field of vectors of the %s is needed (got %s)", "mesh it is "
      .. "carried from", form.is_form(a) and "a form of another mesh" or option.got(a))
  end
  return form.new(to, a.degree, a.side, a.values)
end

-- X of a mesh as a field on another one
local function moved(X, from, to, where)
  if not rawequal(X.mesh, from) then option.fail(where, "the field is of another mesh") end
  if X.on ~= "cells" then
    option.fail(where, "vectors at vertices have no linear map that is theirs: take fields on "
      .. "cells, K:vector_field(f, { on = \"cells\" })")
  end
  return field.new(to, "cells", linear.carry(X.values, from, to))
end

class.method("dm.diffeo", "pull", function(phi, a)
  single(phi, "diffeo:pull")
  if field.is_field(a) then return moved(a, phi.to, phi.from, "diffeo:pull") end
  return carried(a, phi.to, phi.from, "diffeo:pull")
end, [[
phi:pull(a) -> dm.form or dm.vector_field
A form of the image as a form of the first mesh: its value on a cell is that of a on the image of
the cell. It commutes with d and with the natural wedge, not with the metric one, nor with stars. A
field of vectors on cells by the inverse of the linear map of each cell.]])

class.method("dm.diffeo", "push", function(phi, a)
  single(phi, "diffeo:push")
  if field.is_field(a) then return moved(a, phi.from, phi.to, "diffeo:push") end
  return carried(a, phi.from, phi.to, "diffeo:push")
end, [[
phi:push(a) -> dm.form or dm.vector_field
A form of the first mesh on the image, the pull-back by the inverse. A field of vectors on cells by
the linear map of each cell.]])

-- the degree asked for, that of the meshes by default
local function degree_of(phi, k, where)
  local n = phi.from.dimension
  if k == nil then return n end
  if math.type(k) ~= "integer" or k < 0 or k > n then
    option.fail(where, "a degree from 0 to %d is needed (got %s)", n, option.got(k))
  end
  return k
end

class.method("dm.diffeo", "dual", function(phi, k)
  single(phi, "diffeo:dual")
  k = degree_of(phi, k, "diffeo:dual")
  return phi.from:circumcentres(k), phi.to:circumcentres(k)
end, [[
phi:dual(k) -> dm.matrix, dm.matrix
The map of dual vertices: circumcentres of the k-cells (k = n by default), and those of their
images, a row each. The centre of an image is not the image of the centre.]])

---- velocities ----

-- the velocity of the vertices of a family at time t
local function velocity_of(phi, t, where)
  if not phi.family then option.fail(where, "this map does not depend on time: give a family") end
  if type(t) ~= "number" or t - t ~= 0 then
    option.fail(where, "a time is needed (got %s)", option.got(t))
  end
  return motion.velocity(phi, t)
end

class.method("dm.diffeo", "material_velocity", function(phi, t)
  return field.new(phi.from, "vertices", velocity_of(phi, t, "diffeo:material_velocity"))
end, [[
phi:material_velocity(t) -> dm.vector_field
V(X, t) = d/dt phi_t(X) at the vertices X of the first mesh: exact where the family is a function of
t that gives points, by differences of order 6 where it gives meshes.]])

class.method("dm.diffeo", "spatial_velocity", function(phi, t)
  local values = velocity_of(phi, t, "diffeo:spatial_velocity")
  return field.new(phi(t).to, "vertices", values)
end, [[
phi:spatial_velocity(t) -> dm.vector_field
v(x, t) = V(X, t) at the points x = phi_t(X): a field on the mesh at time t.]])

class.method("dm.diffeo", "dual_velocity", function(phi, t, k)
  k = degree_of(phi, k, "diffeo:dual_velocity")
  velocity_of(phi, t, "diffeo:dual_velocity")
  return motion.dual_velocity(phi, t, k)
end, [[
phi:dual_velocity(t [, k]) -> dm.matrix
The velocity of the circumcentres of the k-cells (k = n by default) at time t, a row each.]])

return M
