--- The discrete Routh equations of an Ld(q0, q1), stepped in C. W(x0, x1) = Ld(x0, x1, psi) - mu .
-- psi, stationary in psi, is a discrete Lagrangian of its own (dm.root); its step comes with it as
-- a function (step.lua), which finds x1 and psi together.
local core = require "dm.core"
local forces = require "dm.reduce.discrete.forces"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local psi_of = require "dm.reduce.discrete.psi"
local step_of = require "dm.reduce.discrete.step"

local M = {}

-- W -> the discrete shape it belongs to
local known = setmetatable({}, { __mode = "k" })

--- The discrete shape of a path of its solver, or nothing.
function M.of(system) return known[system] end

-- what acts beside Ld, of a pair of shapes, along them
local function acting(D, straight)
  local info, out = D.info, {}
  local function over(f)
    return f and function(x0, x1)
      return f(psi_of.lifted(info, x0, x1, D.root(x0, x1, straight(x0, x1))))
    end
  end
  local given = D.forces or {}
  out.force = over(given.push and function(q0, q1, J0, J1)
    local F1, F2 = given.push(q0, q1)
    return { forces.of_shape(info, J0, F1), forces.of_shape(info, J1, F2) }
  end)
  out.rolling = over(given.rolling and function(q0, q1)
    return core.vector(given.rolling(q0, q1))
  end)
  out.reaction = over(given.reaction and function(q0, q1, J0)
    local rows = given.reaction(q0, q1)
    for c, E in ipairs(rows) do rows[c] = forces.of_shape(info, J0, E) end
    return rows
  end)
  return out
end

local function make(D)
  local straight = psi_of.straight(D)
  local step, size = step_of.of(D)
  local beside = acting(D, straight)
  local W = core.with_step { force = beside.force, rolling = beside.rolling,
    reaction = beside.reaction, Q = core.R(D.info.d), h = D.h,
    coordinates = D.shape.coordinates, name = "discrete Routhian", constraint = D.constraint,
    Ld = function(x0, x1) return D.root:value(x0, x1, straight(x0, x1)) end,
    map = function(x, y) return lists.part(step(x, y, x), 0, size) end }
  known[W] = D
  return W
end

-- Does the rule of Ld on the shape take the steps of Ld? A partitioned Runge-Kutta rule does, with
-- its velocities at the points of its quadrature, where theta is a coordinate.
local function is_stepped_by_its_rule(D)
  if D.Ld.Ld or D.info.ambient then return false end
  local d = D.Ld:coefficients().d
  return d.rows == d.columns and d == core.identity(d.rows)
end

function M.solver(D, options)
  if is_stepped_by_its_rule(D) then
    local own = lists.copy(options or {})
    own.rule, own.h = own.rule or D.Ld.rule, own.h or D.h
    return D.shape:solver(own)
  end
  D.W = D.W or make(D)
  return D.W:solver(options)
end

---- reconstruction ----

-- the step from (x, y) as the run took it, to the shape `there` where that is known: psi, x, y
local function follow(D, x, y, there, last)
  local d, step, before_psi = D.info.d, step_of.of(D)
  local all = step(x, y, there or x)
  local x1, y1 = lists.part(all, 0, d), lists.part(all, d, d)
  if there and not ((x1 - there):norm() <= 1e-8 * (1 + there:norm())) then
    return psi_of.pair(D, x, there, last).psi, there, y1 -- the run has found another root
  end
  return lists.part(all, before_psi, D.info.m), x1, y1
end

-- the group variable at every row, from theta on
local function group_along(D, path, theta)
  local out = { core.vector(theta) }
  local psi = core.zeros(D.info.m)
  for k = 2, #path do
    local steps = math.floor((path.t[k] - path.t[k - 1]) / path.h + 0.5)
    local x, y, sum = path.q[k - 1]:copy(), path.p[k - 1]:copy(), out[k - 1]
    for i = 1, steps do
      psi, x, y = follow(D, x, y, i == steps and path.q[k]:copy() or nil, psi)
      sum = sum + psi
    end
    out[k] = sum
  end
  return out
end

--- Columns t, q, p in the coordinates (theta, x) of a path of the solver above: psi_mu is added
-- from step to step, also between rows that are further apart.
function M.columns(D, path, theta)
  local info, group = D.info, group_along(D, path, theta)
  local n, columns = info.n, { path:column "t" }
  for c = 2, 2 * n + 1 do columns[c] = {} end
  for k = 1, #path do
    local q, p = model.embed(info, path.q[k], group[k]), model.embed(info, path.p[k], info.mu)
    for i = 1, n do columns[1 + i][k], columns[1 + n + i][k] = q[i], p[i] end
  end
  return columns
end

return M
