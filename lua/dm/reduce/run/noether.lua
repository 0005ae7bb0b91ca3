--- Noether's quantity along a path, of a symmetry of the action up to a divergence and a scale:
-- when the prolonged generator gives pr v(L) + L dtau/dt = dB/dt + c L, then p . xi - E tau - B - c
-- S is constant, S the action from the first row (Olver 1993, 4.4).
local core = require "dm.core"
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local bound = require "dm.base.bound"
local integral = require "dm.reduce.run.integral"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local WHERE = "path:noether"

-- xi, a vector, and tau of what the generator returned
local function read(n, xi, tau)
  if type(xi) == "number" then xi = { xi } end
  local v = lists.numbers(WHERE .. ": the generator", xi, n,
    "%s must give xi, %d number%s, and tau, a number or nothing (got %s)")
  if tau ~= nil and type(tau) ~= "number" then
    option.fail(WHERE, "the generator must give tau as a number (got %s)", type(tau))
  end
  return v, tau or 0
end

local function divergence_at(f, q, t)
  if not f then return 0 end
  local B = f(q, t)
  if type(B) ~= "number" or B - B ~= 0 then
    option.fail(WHERE, "the divergence must give a finite number, B(q, t) (got %s)", option.got(B))
  end
  return B
end

-- the action from the first row, by the rule's own quadrature
local function action_along(path)
  local system = path.system
  local L = bound(system.given.L, system.given.params)
  return integral.along(path, system, function(x, v, t) return { L(x, v, t) } end, 1)[1]
end

M.noether = blame.caller(function(path, o)
  option.check(o, { "generator", "divergence", "scale" }, WHERE, "{ generator = f(q, t) }")
  option.callable(o, "generator", WHERE, "(q, t) -> xi [, tau]")
  option.need(o, "generator", WHERE, "a function of (q, t) that gives xi and, where time moves, "
    .. "tau")
  option.callable(o, "divergence", WHERE, "(q, t) -> B")
  local c = option.number(o, "scale", WHERE, nil, 0)
  local system = path.system
  if system.place then
    option.fail(WHERE, "is for systems on coordinates; on groups path:momentum(G) gives momenta")
  end
  if path.watched then option.fail(WHERE, "needs q and p, but this run recorded only what it "
    .. "watched") end
  if c ~= 0 and not system.given.L then option.fail(WHERE, "a scale needs the action of an L") end
  local n, out, S, energy = system.Q.dimension, {}, c ~= 0 and action_along(path), nil
  local generator = o.generator
  for k = 1, #path do
    local q, p, t = core.vector(path.q[k]), core.vector(path.p[k]), path.t[k]
    local xi, tau = read(n, generator(q, t))
    local value = p:dot(xi) - divergence_at(o.divergence, q, t)
    if tau ~= 0 then
      energy = energy or path:column "energy"
      value = value - energy[k] * tau
    end
    if S then value = value - c * S[k] end
    out[k] = value
  end
  return core.vector(out)
end)

class.method("dm.path", "noether", M.noether, [[
path:noether{generator=, divergence=, scale=} -> dm.vector
p . xi - E tau - B - c S at every row, a number each: what Noether's theorem keeps of a symmetry
generator(q, t) -> xi [, tau] (tau: how time moves) whose prolongation changes L by dB/dt + c L,
divergence(q, t) = B, scale = c (S: the action from the first row, by the rule's own quadrature).
action:invariant finds B and c. Momenta of symmetries of Q alone are path:momentum.]])

return M
