--- Semidirect products: lists {g, v} with (g, v)(h, w) = (g h, v + g w). Algebra: that of G, then
-- V.
local core = require "dm.core"
local flats = require "dm.group.flat"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local matrix_functions = require "dm.group.matrix_functions"
local product = require "dm.group.product"

local M = {}

local function split(xi, r)
  local n = #xi
  local a, b = {}, {}
  for i = 1, r do a[i] = xi[i] end
  for i = r + 1, n do b[i - r] = xi[i] end
  return core.vector(a), core.vector(b)
end

local function joined(a, b)
  local out = kits.list_of(a)
  for i = 1, #b do out[#out + 1] = b[i] end
  return core.vector(out)
end

-- the standard action of G on V: matrix times vector
local function matrix_action(part, n, name)
  local m = part.matrix(part.identity())
  if m.rows ~= n then
    error(("dm.semidirect: %s has matrices of %d x %d and does not act on R^%d: give the action "
      .. "as a function of (g, v)")
      :format(name, m.rows, m.columns, n), 0)
  end
  return function(g, v) return part.matrix(g) * v end
end

-- matrices E_a of the derivative of the action along the algebra: E_a v = d/dt (exp(t e_a) v)
local function slopes(part, act, n)
  local r = part.dimension
  local slope = core.derivative(function(xi, v) return core.vector(act(part.exp(xi), v)) end, r, n)
  local columns = {}
  for j = 1, n do columns[j] = slope(core.zeros(r), linear.unit(n, j)) end
  local out = {}
  for a = 1, r do out[a] = linear.fill(n, n, function(i, j) return columns[j][i][a] end) end
  return out
end

-- the action must be linear in v and one of the group
local function check(part, act, n)
  local stream = core.random(5)
  local g, h = part.sample(stream, 0), part.sample(stream, 1)
  local v, w = kits.normals(stream, 2, n, 1), kits.normals(stream, 3, n, 1)
  local function image(a, x)
    return kits.vector(act(a, x), n, "what the action of dm.semidirect returns")
  end
  local linear_defect = (image(g, v + w * 2) - image(g, v) - image(g, w) * 2):norm()
  local group_defect = (image(part.compose(g, h), v) - image(g, image(h, v))):norm()
  local scale = 1e-9 * (1 + image(g, image(h, v)):norm() + image(g, v + w * 2):norm())
  if not (linear_defect <= scale) then
    error(("dm.semidirect: the action is not linear in v (by %g at a random point)")
      :format(linear_defect), 0)
  end
  if not (group_defect <= scale) then
    error(("dm.semidirect: g(h v) is not (g h) v (by %g at a random point)")
      :format(group_defect), 0)
  end
end

local function algebra(kit, part, rate)
  local r = part.dimension
  local function phi(x) return matrix_functions.phi(rate(x)) end
  function kit.exp(xi)
    local x, u = split(xi, r)
    return { part.exp(x), phi(x) * u }
  end
  function kit.near(xi)
    local x, u = split(xi, r)
    return { part.near(x), u }
  end
  function kit.log(g)
    local x = part.log(g[1])
    return joined(x, phi(x):solve(g[2]))
  end
  function kit.ad(xi, eta)
    local x, u = split(xi, r)
    local y, w = split(eta, r)
    return joined(part.ad(x, y), rate(x) * w - rate(y) * u)
  end
end

-- homogeneous matrices {{g, v}, {0, 1}}, where g acts by its matrix
local function matrix_maps(kit, part, n)
  local function corner(m, v, last)
    return linear.fill(n + 1, n + 1, function(i, j)
      if i > n then return j > n and last or 0 end
      return j > n and v[i] or m[i][j]
    end)
  end
  local function block(m) return linear.fill(n, n, function(i, j) return m[i][j] end) end
  local function column(m) return m:column(n + 1):slice(1, n) end
  function kit.matrix(g) return corner(part.matrix(g[1]), g[2], 1) end
  function kit.hat(xi)
    local x, u = split(xi, part.dimension)
    return corner(part.hat(x), u, 0)
  end
  function kit.vee(m) return joined(part.vee(block(m)), column(m)) end
  function kit.from_matrix(m) return { part.from_matrix(block(m)), column(m) } end
  kit.no_cayley = part.no_cayley
end

-- does the algebra leave V alone?
local function is_trivial(E)
  for _, slope in ipairs(E) do
    if linear.largest(slope) > 0 then return false end
  end
  return true
end

-- what a direct product does factor by factor, and this one does not
local NOT_BY_FACTORS = { "Ad", "coAd", "coad", "dexp", "slope", "dexpinv", "cayley", "cayleyinv",
  "dcay", "dcayinv", "matrix", "hat", "vee", "left_tangent", "right_tangent", "distance",
  "from_matrix" }

-- those of g, then v (group/flat.lua)
local function coordinates(kit, part, n)
  local first = flats.of(part)
  local m = #first.flat(part.identity())
  local function split_list(list)
    local a, v = {}, {}
    for i = 1, m do a[i] = list[i] end
    for i = 1, n do v[i] = list[m + i] end
    return a, core.vector(v)
  end
  local function carry(a, b)
    local g, v = split_list(a)
    local h, w = split_list(b)
    local moved = kit.compose({ first.element(g), v }, { part.identity(), w })[2]
    return kits.list_of(joined(first.carry(g, h), moved))
  end
  -- v' = g w for the velocity (x, w)
  local function velocity(list, rates)
    local a = split_list(list)
    local b, rate = split_list(rates)
    local x, back = first.velocity(a, b), part.inverse(first.element(a))
    local w = kit.compose({ back, core.zeros(n) }, { part.identity(), rate })[2]
    local turning, behind = split(x, part.dimension)
    return kits.list_of(joined(joined(turning, w), behind))
  end
  local function scale(list)
    local out = kits.list_of(first.scale((split_list(list))))
    for _ = 1, n do out[#out + 1] = 1 end
    return out
  end
  local homogeneous = first.velocity ~= nil
  local function of(name)
    return function(xi)
      local x = split(xi, part.dimension)
      return kits.list_of(joined(first[name](x), kit[name](xi)[2]))
    end
  end
  return { carry = carry, exp = of "exp", near = of "near", scales = first.scales,
    scale = homogeneous and scale or nil, velocity = homogeneous and velocity or nil,
    apart = function(list)
      local a, v = split_list(list)
      return kits.list_of(joined(first.apart(a), v))
    end,
    mend = function(list)
      local a, v = split_list(list)
      return kits.list_of(joined(first.mend(a), v * 0))
    end,
    follow = function(list, last)
      local a, v = split_list(list)
      return kits.list_of(joined(first.follow(a, last), v))
    end,
    tidy = function(list)
      local a, v = split_list(list)
      return kits.list_of(joined(first.tidy(a), v))
    end }
end

-- z -> g z + v of {g, v} on V
local function affine(move, n)
  return function(m)
    if m == n then return function(g, z) return move(g[1], z) + g[2] end end
  end
end

function M.kit(_, space)
  local name = tostring(space.parts[1])
  local given = core.one(space.representation, "the action of dm.semidirect")
  local part, vectors = kits.of(space.parts[1]), kits.of(space.parts[2])
  if part.manifold then error(("dm.semidirect: %s is a manifold, not a group"):format(name), 0) end
  local n, r = vectors.dimension, part.dimension
  local act = given or matrix_action(part, n, name)
  check(part, act, n)
  local E = slopes(part, act, n)
  local function rate(x)
    local sum = E[1] * x[1]
    for a = 2, r do sum = sum + E[a] * x[a] end
    return sum
  end
  local function move(g, v) return core.vector(act(g, v)) end
  local kit = product.of { part, vectors }
  kit.parts, kit.vectors, kit.acts = nil, false, { affine = affine(move, n) }
  kit.abelian = part.abelian and is_trivial(E)
  kit.liftable = kits.is_liftable(part)  -- v has no relation
  for _, key in ipairs(NOT_BY_FACTORS) do kit[key] = nil end
  algebra(kit, part, rate)
  function kit.compose(a, b) return { part.compose(a[1], b[1]), a[2] + move(a[1], b[2]) } end
  function kit.inverse(g)
    local back = part.inverse(g[1])
    return { back, -move(back, g[2]) }
  end
  function kit.Ad(g, xi)
    local x, u = split(xi, r)
    local turned = part.Ad(g[1], x)
    return joined(turned, move(g[1], u) - rate(turned) * g[2])
  end
  kit.no_cayley = true
  function kit.arcs(xi) return part.arcs and part.arcs((split(xi, r))) or {} end
  kit.smooth = coordinates(kit, part, n)
  if not given then matrix_maps(kit, part, n) end
  return kits.complete(kit)
end

return M
