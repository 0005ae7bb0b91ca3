--- The discrete Lagrange-Poincare operators of three shapes and two elements.
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local space = require "dm.reduce.lagrange_poincare.space"

local M = {}

local WHERE = "lp:residual"
local part = lists.part

-- -D1, D2 and the left derivative by f of a formula l
local function of_formula(lp)
  local S, value = lp.space, lp.way.value
  local kit, d, r = S.kit, S.d, S.r
  local width = #kit.entries(kit.identity())
  local n = math.max(d, 1)
  local slope = core.derivative(function(x0, x1, e, f)
    local near = kit.compose(kit.rebuild(f), kit.near(e))
    return value(x0, x1, near, lp.h)
  end, n, n, r, width)
  return function(x0, x1, f)
    local zero = core.zeros(n)
    local G = slope(d > 0 and x0 or zero, d > 0 and x1 or zero, core.zeros(r),
      core.vector(kit.entries(f)))
    local mu1 = part(G, 2 * n, r)
    return d > 0 and -part(G, 0, d) or core.vector {}, kit.coAd(f, mu1),
      d > 0 and part(G, n, d) or core.vector {}, mu1
  end
end

-- the same of a system and a rule, by its discrete Lagrangian
local function of_rule(lp)
  local S = lp.space
  local Ld = core.discrete_lagrangian(lp.system, { rule = lp.by, h = lp.h })
  return function(x0, x1, f)
    local q0, q1 = space.element(S, x0, S.kit.identity()), space.element(S, x1, f)
    local p0, mu0 = space.parts(S, Ld:legendre_minus(q0, q1))
    local p1, mu1 = space.parts(S, Ld:legendre_plus(q0, q1))
    return p0, mu0, p1, mu1
  end
end

local function shapes_of(lp, list)
  if lp.space.d == 0 and list == nil then list = { {}, {}, {} } end
  if type(list) ~= "table" or #list ~= 3 then
    option.fail(WHERE, "takes three shapes { x0, x1, x2 } and two elements { f0, f1 }")
  end
  local out = {}
  for k = 1, 3 do
    local x = type(list[k]) == "number" and { list[k] } or list[k]
    out[k] = lp.space.d == 0 and core.vector {}
      or lists.numbers(("%s: x%d"):format(WHERE, k - 1), x, lp.space.d,
        "%s must be %d number%s (got %s)")
  end
  return out
end

--- lp:residual: see init.lua.
function M.residual(lp, xs, fs)
  local S, x = lp.space, shapes_of(lp, xs)
  if type(fs) ~= "table" or #fs ~= 2 then
    option.fail(WHERE, "takes three shapes { x0, x1, x2 } and two elements { f0, f1 }")
  end
  local groups, f = require "dm.group", {}
  for k = 1, 2 do f[k] = groups.element(lp.group, fs[k]) end
  lp.momenta = lp.momenta or (lp.way.value and of_formula or of_rule)(lp)
  local _, _, p1, mu1 = lp.momenta(x[1], x[2], f[1])
  local p0, mu0 = lp.momenta(x[2], x[3], f[2])
  local ver = mu1 - mu0
  if S.d == 0 then return ver, core.vector {} end
  local hor = p1 - p0
  if lp.connection then hor = hor - lp.connection:continuous(x[2]):transpose() * ver end
  return ver, hor
end

return M
