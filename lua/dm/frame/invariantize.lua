--- Functions and discrete Lagrangians at normalized points, z -> F(rho(z) z): invariant whatever
-- F is (Bogfjellmo ch. 2 and 3).
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local frames = require "dm.frame"
local options = require "dm.base.options"

local M = {}

local NAME = "rho:invariantize"
local fail = options.failing(NAME)

local function invariant_function(self, f)
  f = core.one(f, "the function of rho:invariantize")
  return function(...)
    return f(table.unpack(frames.invariants(self, { ... })))
  end
end

-- how many arguments a Lua function names
local function parameters(f)
  local info = debug.getinfo(f, "u")
  return info.isvararg and math.huge or info.nparams
end

-- h = htilde sigma: Ld0(q0, q1, htilde sigma) + H0 htilde sigma (Bogfjellmo 3.7)
local function reparametrized(Ld, o)
  options.callable(o, "sigma", NAME, "q, or of (q0, q1), that is > 0")
  if parameters(Ld.Ld) < 3 then
    fail "with 'sigma' the step is not a constant: write Ld as a function of (q0, q1, h)"
  end
  local both, H0 = parameters(o.sigma) == 2, o.H0 or 0
  local sigma_of = core.one(o.sigma, "sigma")
  return function(q0, q1, h, params)
    local sigma = sigma_of(q0, both and q1 or nil)
    local step = h * core.where(sigma, sigma, 0 / 0) -- time must not run backwards
    return Ld.Ld(q0, q1, step, params) + H0 * step
  end
end

local function invariant_lagrangian(self, Ld, formula)
  if self.k > 2 then
    fail("Ld(q0, q1) has two points, this frame needs %d: make the frame of the pair, or use "
      .. "dm.invariant_problem", self.k)
  end
  if not formula then
    fail("this discrete Lagrangian is found by solving a rule and has no formula: give one, or one "
      .. "of the midpoint or trapezoidal rule")
  end
  for _, key in ipairs { "constraint", "force", "rolling", "map" } do
    if Ld[key] ~= nil then
      fail("this discrete Lagrangian has '%s', which an invariant one leaves out", key)
    end
  end
  if Ld.Q.dimension ~= self.m then
    fail("Ld is on %s, the action on a space of dimension %d", tostring(Ld.Q), self.m)
  end
  return core.discrete_lagrangian { Q = Ld.Q, h = Ld.h, name = Ld.name,
    coordinates = Ld.coordinates, units = Ld.units, params = Ld.params,
    Ld = function(q0, q1, h, params)
      local z = frames.invariants(self, { q0, q1 })
      return formula(z[1], z[2], h, params)
    end }
end

M.doc = [[
rho:invariantize(f) -> function,  rho:invariantize(Ld) -> dm.discrete_lagrangian
or rho:invariantize{Ld=, sigma=, H0=}: f or Ld at the normalized points, f(rho z1, ..., rho zn):
invariant whatever f is, and f itself where f was invariant. Every solver takes the new Ld; by the
discrete Noether theorem it keeps <p, v> of every generator v to round-off. With sigma(q) or
sigma(q0, q1) > 0 the step h is htilde sigma, for symmetries of sigma (H - H0) at the energy H0
(default 0; Bogfjellmo 3.7): Ld must then be a function of (q0, q1, h) and the h of Ld is htilde.]]

function M.method(self, what)
  if type(what) == "function" then return invariant_function(self, what) end
  if type(what) == "table" and getmetatable(what) == nil then
    options.check(what, { "Ld", "sigma", "H0" }, NAME)
    options.demand(type(what.Ld) == "userdata", what, "Ld", NAME,
      "a dm.discrete_lagrangian")
    return invariant_lagrangian(self, what.Ld,
      what.sigma and reparametrized(what.Ld, what) or what.Ld.Ld)
  end
  local fine, formula = blame.try(function() return what.h and what end)
  if not (fine and formula) then
    error("rho:invariantize takes a function of the points, a dm.discrete_lagrangian or { Ld =, "
      .. "sigma = } (got " .. type(what) .. ")", 0)
  end
  return invariant_lagrangian(self, what, what.Ld)
end

class.method("dm.frame", "invariantize", M.method, M.doc)

return M
