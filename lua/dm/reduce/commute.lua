--- dm.commute: the cube of Routh reduction (Leok, figure 2.1) run for a system: continuous and
-- discrete, unreduced and reduced, in velocities and momenta. Its discrete faces commute to
-- round-off, those between continuous and discrete to the order of the rule.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local option = require "dm.base.options"
local routh = require "dm.reduce.routh"
local starts = require "dm.base.start"

local M = {}

local abs, max, log = math.abs, math.max, math.log

local class = { __name = "dm.cube" }

function class.__tostring(c)
  local out = { ("%s, h = %.6g, %d steps, mu = %s"):format(c.rule, c.h, c.steps, tostring(c.mu)) }
  for _, row in ipairs(c) do
    local what = row.order and ("%9.2e  order %.2f"):format(row.difference, row.order)
      or ("%9.2e"):format(row.difference)
    out[#out + 1] = ("  %-48s %-22s %s"):format(row.name, what, row.commutes and "commutes"
      or "DOES NOT COMMUTE")
  end
  if c.apart then
    out[#out + 1] = ("  reduced and unreduced steps of this rule are not the same: they agree to "
      .. "order %.2f (those of partitioned Runge-Kutta rules are)"):format(c.apart)
  end
  if c.without then out[#out + 1] = "  without the faces of DEL and DR: " .. c.without end
  return table.concat(out, "\n")
end

local ROUND_OFF = 1e-10  -- of a few dozen steps, relative
local PAIRS = 24         -- at most so many pairs of points are looked at one by one

local function distance(a, b)
  local worst = 0
  for i = 1, #a do worst = max(worst, abs(a[i] - b[i]) / max(1, abs(b[i]))) end
  return worst
end

-- the largest of f(k) over pairs of rows k, k + 1
local function over_pairs(count, f)
  local worst, every = 0, max(1, count // PAIRS)
  for k = 1, count, every do worst = max(worst, f(k)) end
  return worst
end

local function add(rows, name, difference)
  rows[#rows + 1] = { name = name, difference = difference, commutes = difference <= ROUND_OFF }
end

-- rows of an unreduced path in the coordinates (theta, x) of the reduction, as lists of x, p_x and
-- theta
local function projected(full, reduction)
  local x, y, theta = {}, {}, {}
  for k = 1, #full do
    x[k], y[k], theta[k] = {}, {}, {}
    for j, i in ipairs(reduction.shape) do x[k][j], y[k][j] = full.q[k][i], full.p[k][i] end
    for a, i in ipairs(reduction.cyclic) do theta[k][a] = full.q[k][i] end
  end
  return x, y, theta
end

local function discrete_faces(rows, c)
  local D, Ld, full, reduced = c.D, c.D.Ld, c.full, c.reduced
  local x, y, theta = projected(full, c.reduction)
  local count = #full - 1
  add(rows, "DEL -> SPRK: discrete Legendre transforms", over_pairs(count, function(k)
    return max(distance(Ld:legendre_minus(full.q[k], full.q[k + 1]), full.p[k]),
      distance(Ld:legendre_plus(full.q[k], full.q[k + 1]), full.p[k + 1]))
  end))
  add(rows, "DEL -> DR: projection, literal equations", over_pairs(count - 1, function(k)
    return D:residual(x[k], x[k + 1], x[k + 2]):norm() / max(1, core.vector(y[k + 1]):norm())
  end))
  add(rows, "DR: the next point = RSPRK", over_pairs(count - 1, function(k)
    return distance(D:step(reduced.q[k], reduced.q[k + 1]), reduced.q[k + 2])
  end))
  add(rows, "DR -> RSPRK: reduced Legendre transforms", over_pairs(count, function(k)
    local s0 = c.shape:magnetic_momentum(reduced.q[k], reduced.p[k])
    local s1 = c.shape:magnetic_momentum(reduced.q[k + 1], reduced.p[k + 1])
    return max(distance(D:legendre_minus(reduced.q[k], reduced.q[k + 1]), s0),
      distance(D:legendre_plus(reduced.q[k], reduced.q[k + 1]), s1))
  end))
  add(rows, "psi_mu = the angle of a step", over_pairs(count, function(k)
    local psi, worst = D:psi(x[k], x[k + 1]), 0
    for a = 1, #psi do worst = max(worst, abs(theta[k + 1][a] - theta[k][a] - psi[a])) end
    return worst
  end))
end

-- where stepping does not commute with reduction, as by curves of less degree than their quadrature
-- has points: the order in h to which it does
local function order_apart(c)
  local gap = {}
  for k = 1, 2 do
    local h, steps = c.h / k, c.steps * k
    local full = c.system:solver({ rule = c.rule, h = h }):run { q = c.q, v = c.v, steps = steps,
      every = steps }
    local reduced = c.shape:solver({ rule = c.rule, h = h }):run { q = c.x, v = c.u, steps = steps,
      every = steps }
    local x, y = projected(full, c.reduction)
    gap[k] = max(distance(reduced.q[#reduced], x[#x]), distance(reduced.p[#reduced], y[#y]))
  end
  return gap[2] > 0 and log(gap[1] / gap[2], 2) or nil
end

local function step_faces(rows, c)
  local full, reduced = c.full, c.reduced
  local x, y, theta = projected(full, c.reduction)
  local worst = 0
  for k = 1, #full do
    worst = max(worst, distance(reduced.q[k], x[k]), distance(reduced.p[k], y[k]))
  end
  add(rows, "SPRK -> RSPRK: projection", worst)
  if worst > ROUND_OFF then rows.apart = order_apart(c) end
  worst = 0
  for a, i in ipairs(c.reduction.cyclic) do
    for k = 1, #full do worst = max(worst, abs(full.p[k][i] - c.mu[a]) / max(1, abs(c.mu[a]))) end
  end
  add(rows, "SPRK: momentum map", worst)
  local back = reduced:reconstruct { theta = theta[1] }
  worst = 0
  for k = 1, #full do worst = max(worst, distance(back.q[k], full.q[k])) end
  add(rows, "RSPRK -> SPRK: reconstruction", worst)
end

local function literal_face(rows, c)
  local fine, step = blame.try(c.shape.rsprk, c.shape, { rule = c.rule, h = c.h })
  if not fine then return end
  local reduced, worst = c.reduced, 0
  local a, s = reduced.q[1], c.shape:magnetic_momentum(reduced.q[1], reduced.p[1])
  for k = 2, math.min(#reduced, 11) do
    a, s = step(a, s)
    worst = max(worst, distance(a, reduced.q[k]),
      distance(s, c.shape:magnetic_momentum(reduced.q[k], reduced.p[k])))
  end
  add(rows, "RSPRK: with beta = moved classical Routhian", worst)
end

---- between continuous and discrete ----

local REFERENCE = "gauss(6)"

-- ends of runs over the same time: by the reference, with h, h/2
local function ends(system, c, q, v)
  local T, out = c.h * c.steps, {}
  local function last(rule, h, steps)
    local path = system:solver({ rule = rule, h = h }):run { q = q, v = v, steps = steps,
      every = steps }
    return path.q[#path], path.p[#path]
  end
  local fine = math.ceil(4 * c.steps)
  out.q, out.p = last(REFERENCE, T / fine, fine)
  out.q1, out.p1 = last(c.rule, c.h, c.steps)
  out.q2, out.p2 = last(c.rule, c.h / 2, 2 * c.steps)
  return out
end

local function add_order(rows, name, order, one, two)
  local measured = two > 0 and log(one / two, 2) or math.huge
  local fine = measured > order - 0.5 or one < 1e-11
  rows[#rows + 1] = { name = name, difference = one, order = measured, commutes = fine }
end

local function continuous_faces(rows, c)
  local above = ends(c.system, c, c.q, c.v)
  local below = ends(c.shape, c, c.x, c.u)
  local order = c.shape:solver({ rule = c.rule, h = c.h }).order
  local x, y = {}, {}
  for j, i in ipairs(c.reduction.shape) do x[j], y[j] = above.q[i], above.p[i] end
  add(rows, "EL -> Routh: projection of the exact motion",
    max(distance(below.q, x), distance(below.p, y)))
  add_order(rows, "X_H -> SPRK: discretization", order,
    max(distance(above.q1, above.q), distance(above.p1, above.p)),
    max(distance(above.q2, above.q), distance(above.p2, above.p)))
  add_order(rows, "X_H_mu -> RSPRK: discretization", order,
    max(distance(below.q1, below.q), distance(below.p1, below.p)),
    max(distance(below.q2, below.q), distance(below.p2, below.p)))
end

local OWN = { rule = true, h = true, steps = true }
local KNOWN = { "rule", "h", "steps", table.unpack(routh.OPTIONS) }

local function read(system, options)
  if kits.class_of(system) ~= "dm.system" or type(options) ~= "table" or not options.q
    or not options.v then
    error("dm.commute takes a system and { q =, v =, rule =, h =, steps =, cyclic = ... }", 0)
  end
  option.check(options, KNOWN, "dm.commute")
  option.positive(options, "h", "dm.commute", "a step")
  option.need(options, "h", "dm.commute", "a step > 0")
  local steps = option.whole(options, "steps", "dm.commute", 4, 10000, 40)
  local how, q, v = {}, options.q, options.v
  for key, value in pairs(options) do
    if not OWN[key] then how[key] = value end
  end
  local shape = system:routh(how)
  if options.action then
    local info = routh.info(shape)
    q, v = info.ambient.split(q, v)
    system = info.full
    shape = system:routh { cyclic = info.cyclic, mu = info.mu, q = q, v = v,
      connection = options.connection }
  end
  local x, u, theta = shape:start(q, v)
  local reduction = shape:reduction()
  return { system = system, q = q, v = v, shape = shape, reduction = reduction, mu = reduction.mu,
    x = x, u = u, theta = theta,
    rule = options.rule or "gauss(2)", h = options.h, steps = steps }
end

local doc = [[
dm.commute(system, {q=, v=, h=, rule=, steps=, cyclic=, action=, mu=, ...}) -> dm.cube
A dm.cube is {rule, h, steps, mu, commutes, {name, difference, order, commutes}, ...}. The cube of
discrete Routh reduction for a system (Leok, figure 2.1): Euler-Lagrange and Hamilton's equations,
Routh's equations, and for each its discrete one (DEL, SPRK, DR, RSPRK), run from one start and
compared edge by edge. Edges among discrete corners commute to round-off where the rule is a
partitioned Runge-Kutta rule; those from continuous to discrete to its order, which is measured.
print shows the table; commutes: all of them; without: why the faces of DEL and DR are not there, if
so (time, constraints, forces, rules without an Ld); apart: the order in h to which reduced and
unreduced steps agree, for rules with which they are not the same. Options as in system:routh,
connection too: with an action the cube is that of the system in (theta, x), in which rules commute
with reduction.]]

M.commute = blame.caller(function(system, options)
  options = starts.lists(options, system)
  local c = read(system, options)
  c.full = c.system:solver({ rule = c.rule, h = c.h }):run { q = c.q, v = c.v, steps = c.steps }
  c.reduced = c.shape:solver({ rule = c.rule, h = c.h }):run { q = c.x, v = c.u, steps = c.steps }
  local rows = setmetatable({ rule = c.rule, h = c.h, steps = c.steps, mu = c.mu }, class)
  local fine, D = blame.try(c.shape.discrete, c.shape, { rule = c.rule, h = c.h })
  if fine then
    c.D = D
    discrete_faces(rows, c)
  else
    rows.without = tostring(D):gsub("^.-%.lua:%d+: ", "")
  end
  step_faces(rows, c)
  literal_face(rows, c)
  continuous_faces(rows, c)
  rows.commutes = true
  for _, row in ipairs(rows) do rows.commutes = rows.commutes and row.commutes end
  return rows
end)

core.docs[M.commute] = doc

return M
