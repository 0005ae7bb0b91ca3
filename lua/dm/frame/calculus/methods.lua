--- What dm.differential_invariants knows of variations: Euler-Lagrange equations, operators,
-- conserved quantities, extremals. Methods of dm.calculus.
local core = require "dm.core"
local blame = require "dm.base.blame"
local current = require "dm.frame.calculus.current"
local extremal = require "dm.frame.calculus.extremal"
local F = require "dm.frame.calculus.field"
local formula = require "dm.frame.calculus.formula"
local lagrangian = require "dm.frame.calculus.lagrangian"
local layout = require "dm.frame.calculus.layout"
local matrix = require "dm.frame.calculus.matrix"
local option = require "dm.base.options"
local variation = require "dm.frame.calculus.variation"


local function method(name, f, doc) core.method("dm.calculus", name, blame.caller(f), doc) end

local function named_variations(C)
  local out = {}
  for c, k in ipairs(C.dependent) do out[c] = "E of " .. layout.name(C, k) end
  return out
end

method("euler_lagrange", function(self, L)
  local C = self.C
  return formula.new(C, variation.euler_lagrange(C, lagrangian.of(C, L)),
    C.q > 1 and { labels = named_variations(C) } or nil)
end, [[
calculus:euler_lagrange(L) -> dm.formula
The Euler-Lagrange equations of the integral of L omega in invariants, a formula for each normalized
variation iota(du - u_x dx): H* E(L) with what the change of omega adds. L(I): a function of
I.kappa[1], kappa, I.kappa[2], D kappa, ... (by several variables in the order of a jet). For
kappa^2/2 in the plane kappa_ss + kappa^3/2. Raises for an unknown invariant.]])

method("operator", function(self) return matrix.of(self.C) end, [[
calculus:operator() -> H, H*
The operator of d_V kappa = H(t), how the named invariants change with the normalized variations t1,
t2, ... (one: without a name), and its adjoint; dm.invariant_operator, which print. In the plane
D^2 + kappa^2.]])

---- conservation laws, values at jets ----

local function jet_of(C, jet, where)
  local list = {}
  local fine = blame.try(function()
    for i = 1, #jet do list[i] = jet[i] + 0.0 end
  end)
  local length, order = 0, 0
  while fine and length < #list do
    length, order = layout.length(C, order), order + 1
  end
  if not fine or length ~= #list or #list == 0 then
    option.fail(where, "takes a jet, %d numbers of the point and then derivatives of order 1, 2, "
      .. "... "
      .. "(%s numbers)", C.n, ("%d, %d, %d"):format(layout.length(C, 1), layout.length(C, 2),
      layout.length(C, 3)))
  end
  return core.vector(list)
end

-- the invariants that a jet of numbers has, as values of formulas
local function at_jet(C, jet)
  local rho = current.frame(C, jet)
  local I, known = current.normalized(C, jet, rho), {}
  return rho, function(_, info) return current.invariant(C, I, known, info.invariant,
    info.place) end
end

method("conservation_law", function(self, L)
  local C = self.C
  if C.p ~= 1 then
    option.fail("calculus:conservation_law", "is for curves, not for %d independent variables", C.p)
  end
  local v, labels = current.of(C, lagrangian.of(C, L)), {}
  for a = 1, C.r do labels[a] = "v_" .. a end
  local function value(f, jet)
    local rho, at = at_jet(C, jet_of(C, jet, "conservation_law:value"))
    local out = {}
    for a = 1, C.r do out[a] = F.map(f[a].expression, at) end
    local G = C.action.group
    return G:coAd(G:inverse(rho), core.vector(out))
  end
  return formula.new(C, v, { labels = labels, value = value })
end, [[
calculus:conservation_law(L) -> dm.formula
The components of v with Ad(rho)^-1 v = c along extremals of the integral of L omega (Noether's
theorem in invariants): c_a = sum_b v_b (Ad rho)_ba. Its value takes a jet of the curve, f:value{x,
u, u_x, ...}, and gives c, the same all along the curve.]])

method("invariants", function(self, jet)
  local C = self.C
  local list = jet_of(C, jet, "calculus:invariants")
  local _, at = at_jet(C, list)
  local out = {}
  for j, row in ipairs(C.named) do
    local values = {}
    for place = 1, #C.words.list do
      local fine, x = blame.try(at, nil, { invariant = j, place = place })
      if not fine then break end
      values[place] = x
    end
    out[row.name] = values
  end
  return core.result(out)
end, [[
calculus:invariants(jet) -> { kappa = { kappa, kappa_s, ... }, ... }
The named invariants and as many of their derivatives as a jet of numbers has: what
f:value takes.]])

method("extremal", function(self, o)
  return core.result(extremal.run(self.C, lagrangian.of, o))
end, [[
calculus:extremal{L=, start=, frame=, length=, steps=, rule=} -> { points, frame, s, kappa, path }
The curve of an extremal of the integral of L omega, of that length in omega: E(L) = 0 stepped from
start = { kappa = { kappa, kappa_s } } (as many numbers as the equation has orders) with the frame,
in `steps` (100) steps of a rule (default "gauss(4)"). points: dm.matrix, a row each;
frame: the elements g = rho^-1 that bring the normalized point to the curve; the option frame is the
first of them (default the identity); s; every named invariant as a vector; path, the run itself.
Raises where E(L) is not linear in the highest derivatives, or degenerate.]])

return {}
