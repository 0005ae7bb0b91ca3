--- dm.group: groups that a script defines, by a basis of matrices or by their product on vectors.
-- What is left out is derived; the axioms are tested at random points.
local axioms = require "dm.group.own.axioms"
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local matrices = require "dm.group.own.matrices"
local options = require "dm.base.options"

local M = {}

local abs, max = math.abs, math.max

local WHERE = "dm.group"

---- the algebra, from its brackets ----

-- numbers that are round-off of zero or of whole numbers
local function rounded(x, size)
  local whole = math.floor(x + 0.5)
  return abs(x - whole) <= 1e-13 * size and whole or x
end

-- [xi, eta] from those of the basis, c[i][j][k]
local function bracket_of(c, r)
  local list, size = {}, 1
  for i = 1, r do
    for j = 1, r do size = max(size, core.vector(c[i][j]):norm()) end
  end
  for i = 1, r do
    for j = 1, r do
      for k = 1, r do
        local x = rounded(c[i][j][k], size)
        if x ~= 0 then list[#list + 1] = { i, j, k, x } end
      end
    end
  end
  return function(xi, eta)
    local out = {}
    for k = 1, r do out[k] = 0 end
    for _, e in ipairs(list) do out[e[3]] = out[e[3]] + e[4] * xi[e[1]] * eta[e[2]] end
    return core.vector(out)
  end, #list == 0
end

-- how often ad can be applied before all is zero, or nothing
local function depth_of(kit)
  local r, stream = kit.dimension, core.random(13)
  local xi, eta = kits.normals(stream, 0, r, 1), kits.normals(stream, 1, r, 1)
  local size = eta:norm()
  for k = 1, r do
    eta = kit.ad(xi, eta)
    if eta:norm() <= 1e-12 * size then return k end
  end
end

-- sum_k ad^k/(k + 1)!, which ends
local function nilpotent_dexp(kit, depth)
  return function(xi, eta)
    local sum, term = eta, eta
    for k = 1, depth - 1 do
      term = kit.ad(xi, term) * (1 / (k + 1))
      sum = sum + term
    end
    return sum
  end
end

-- ad, and what follows from it
local function set_algebra(kit, c)
  kit.ad, kit.abelian = bracket_of(c, kit.dimension)
  local depth = depth_of(kit)
  if depth then kit.dexp = nilpotent_dexp(kit, depth) end
end

---- groups of vectors ----

local FUNCTIONS = { "mul", "inv", "exp", "log" }

local function check_functions(given)
  options.whole(given, "dimension", WHERE, 1)
  options.need(given, "dimension", WHERE, "that of the algebra")
  options.need(given, "identity", WHERE, "the neutral element, a vector")
  for _, key in ipairs(FUNCTIONS) do
    options.need(given, key, WHERE, "a function, or give a basis of matrices")
    options.callable(given, key, WHERE)
  end
  options.callable(given, "Ad", WHERE, "(g, xi)")
  options.callable(given, "ad", WHERE, "(xi, eta)")
end

-- f of the user, whose result must have so many entries
local function returning(given, key, length)
  local f = core.one(given[key], ("%s: '%s'"):format(WHERE, key))
  return function(...)
    return kits.vector(f(...), length, ("%s: what '%s' returns"):format(WHERE, key))
  end
end

-- exp has a derivative at 0, of full rank: its columns are the directions at the identity
local function directions(kit, N)
  local r = kit.dimension
  kit.exp(core.zeros(r)) -- what is wrong with it as a function is said as it is
  local fine, E = blame.try(function()
    return core.derivative(function(xi) return kit.exp(xi) end, r)(core.zeros(r))
  end)
  if not fine or not (linear.largest(E) < math.huge) then
    options.fail(WHERE, "exp has no derivative at 0: write sin(x)/x and the like there by their "
      .. "series, with dm.where")
  end
  if not linear.choose_rows(E:totable(), r, 1e-10 * max(linear.largest(E), 1e-300)) then
    options.fail(WHERE, "the derivative of exp at 0 has no full rank: are there %d directions?", r)
  end
  local gram = E:transpose() * E
  return E, linear.fill(r, N, function(i, j) return gram:solve(E:transpose())[i][j] end)
end

-- Ad_g eta: d/de g (1 + E e) g^-1 at e = 0, seen from the algebra
local function derived_Ad(kit, E, back, N)
  local r, e = kit.dimension, kit.identity()
  local slope = core.derivative(function(g, x)
    return kit.compose(kit.compose(g, e + E * x), kit.inverse(g))
  end, N, r)
  return function(g, eta)
    local J, moved = slope(core.vector(g), core.zeros(r)), {}
    for i = 1, N do
      local sum = 0
      for k = 1, r do sum = sum + J[i][N + k] * eta[k] end
      moved[i] = sum
    end
    return back * core.vector(moved)
  end
end

-- c[i][j] = [e_i, e_j], the derivative of Ad along e_i
local function derived_brackets(kit, E)
  local r, e, c = kit.dimension, kit.identity(), {}
  for i = 1, r do c[i] = {} end
  for j = 1, r do
    local unit = linear.unit(r, j)
    local J = core.derivative(function(x) return kit.Ad(e + E * x, unit) end, r)(core.zeros(r))
    for i = 1, r do c[i][j] = J:column(i) end
  end
  return c
end

local function given_brackets(ad, r)
  local c = {}
  for i = 1, r do
    c[i] = {}
    for j = 1, r do c[i][j] = ad(linear.unit(r, i), linear.unit(r, j)) end
  end
  return c
end

-- the translation of vectors by each other, where all vectors are elements
local function translation(kit, N)
  return function(m)
    if m == N then return function(g, z) return kit.compose(g, z) end end
  end
end

local function of_vectors(given)
  check_functions(given)
  local identity = core.vector(given.identity)
  local N, r = #identity, lists.whole(given.dimension)
  if N < r then
    options.fail(WHERE, "elements of %d numbers cannot make a group of dimension %d", N, r)
  end
  local kit = { dimension = r, vectors = true, compose = returning(given, "mul", N),
    inverse = returning(given, "inv", N), exp = returning(given, "exp", N),
    log = returning(given, "log", r) }
  function kit.identity() return identity end
  function kit.element(g) return kits.vector(g, N, "the group element") end
  kit.raw = kit.element
  local E, back = directions(kit, N)
  function kit.near(xi) return identity + E * xi end
  kit.Ad = given.Ad and returning(given, "Ad", r) or derived_Ad(kit, E, back, N)
  local ad = given.ad and returning(given, "ad", r)
  local c = ad and given_brackets(ad, r) or derived_brackets(kit, E)
  kit.form = ("a vector of %d number%s"):format(N, N == 1 and "" or "s")
  if N == r then
    kit.acts = { translation = translation(kit, N) }
  else
    function kit.defect(g)
      local off = (kit.compose(g, kit.inverse(g)) - identity):norm()
      local fine, x = blame.try(kit.log, g)
      return fine and max(off, (kit.exp(x) - g):norm() / max(1, g:norm())) or off
    end
    function kit.project(g) return kit.exp(kit.log(g)) end
  end
  function kit.finish() return kits.complete(kit) end
  return kit, c
end

---- dm.group ----

local BY_BASIS = { "basis", "form", "name" }
local BY_PRODUCT = { "dimension", "identity", "mul", "inv", "exp", "log", "Ad", "ad", "name" }

M.group = blame.caller(function(given)
  local by_basis = type(given) == "table" and given.basis ~= nil
  options.check(given, by_basis and BY_BASIS or BY_PRODUCT, WHERE,
    "{ basis = { E1, ... } } or { dimension =, identity =, mul =, inv =, exp =, log = }")
  local name = options.text(given, "name", WHERE, "a group of one's own")
  local kit, c = (by_basis and matrices.kit or of_vectors)(given)
  set_algebra(kit, c)
  kit.finish()
  kit.finish = nil
  axioms.check(kit, name, given)
  return core.own_group(name, kit.dimension, kit)
end)

core.docs[M.group] = [[
dm.group{basis=, form=, name=} -> dm.space   or   {dimension=, identity=, mul=, inv=, exp=, log=}
A group of one's own. basis: square matrices E1, ... of numbers, a basis of the algebra, which must
be closed under brackets; elements are the matrices that their exponentials make, with g^T J g = J
where form = J is given. Or elements are vectors of as many numbers as `identity` has, with the
functions mul(a, b), inv(g), exp(xi), log(g) of vectors; xi has `dimension` entries. exp must have
its derivative at 0. Ad(g, xi), ad(xi, eta) and all differentials are derived from the graph where
they are left out. The axioms are tested at random points: an error names the first that fails, and
where. Such a group goes wherever a built-in one does: systems, products, actions, momentum maps,
moving frames, lie(s).]]

return M
