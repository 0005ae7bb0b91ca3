--- Coordinates of relative motion: where a common motion q + a s changes neither forces nor
-- constraints, and all masses are constant, the rest moves by itself in coordinates that are
-- orthogonal to a by the mass. The common motion is left out; where it is uniform, or uniformly
-- accelerated, it is known.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local directions = require "dm.scene.directions"
local lists = require "dm.base.lists"
local model_of = require "dm.scene.model"

local M = {}

local abs, max = math.abs, math.max
local entries = lists.entries

local SAME = 1e-10     -- of the sum of what is added up
local STATES = 7       -- at which it is looked at
local FAR = 0.5        -- of the size of the start, by which the common motion is moved there

---- functions of a problem, and their derivatives ----

local function functions_of(problem)
  local n, given, out = problem.n, problem.given, {}
  out.L = core.trace(problem.L, n, n, "number")
  if given.force then
    local force = bound(given.force, given.params)
    out.force = core.trace(function(q, v, t) return core.vector(entries(force(q, v, t))) end, n, n,
      "number")
  end
  if problem.constraint then
    out.constraint = core.trace(function(q, t)
      return core.vector(entries(problem.constraint(q, t)))
    end, n, "number")
  end
  return out
end

-- matrices whose first columns are derivatives by q of all that moves the system; those of L by t
-- may be what they will
local function jacobians(of, n)
  return function(q, v, t)
    local out = { { of.L:hessian(q, v, t), 2 * n } }
    if of.force then out[#out + 1] = { of.force:jacobian(q, v, t) } end
    if of.constraint then out[#out + 1] = { of.constraint:jacobian(q, t) } end
    return out
  end
end

-- L_vv as a matrix
local function mass_of(problem, of)
  local H, n, out = of.L:hessian(problem.q, problem.v, problem.t0), problem.n, {}
  for i = 1, n do
    out[i] = {}
    for k = 1, n do out[i][k] = 0.5 * (H[n + i][n + k] + H[n + k][n + i]) end
  end
  return core.matrix(out)
end

---- coordinates ----

-- coordinates x of the relative motion: left, their numbers; basis, of the common motion; across,
-- the directions of q for each, orthogonal to the basis by the mass; weigh(p), the rates of the
-- common motion of momenta A' p
local function coordinates(problem, basis, mass)
  local n, m, is_common = problem.n, #basis, {}
  for _, a in ipairs(basis) do is_common[a.at] = true end
  local columns, G = {}, core.matrix(m, m)
  for j, a in ipairs(basis) do
    columns[j] = mass * core.vector { table.unpack(a, 1, n) }
    for k, b in ipairs(basis) do
      for i = 1, n do G[k][j] = G[k][j] + b[i] * columns[j][i] end
    end
  end
  local out = { basis = basis, left = {}, across = {} }
  function out.weigh(p) return G:solve(core.vector(p)) end
  for f = 1, n do
    if not is_common[f] then
      local pull, direction = {}, {}
      for j = 1, m do pull[j] = -columns[j][f] end
      local y = directions.along(basis, out.weigh(pull), n)
      for i = 1, n do direction[i] = y[i] + (i == f and 1 or 0) end
      out.left[#out.left + 1], out.across[#out.across + 1] = f, direction
    end
  end
  return out
end

-- x of q, or its rates of v
local function relative_part(at, q)
  local x = {}
  for k, f in ipairs(at.left) do
    x[k] = q[f]
    for _, a in ipairs(at.basis) do
      if a[f] ~= 0 then x[k] = x[k] - a[f] * q[a.at] end
    end
  end
  return core.vector(x)
end

-- A' p, as numbers
local function common_part(at, p)
  local out, size = {}, {}
  for j, a in ipairs(at.basis) do
    out[j], size[j] = 0, 0
    for i = 1, #p do out[j], size[j] = out[j] + a[i] * p[i], size[j] + abs(a[i] * p[i]) end
  end
  return out, size
end

-- C' p, and the sums of what is added up
local function across_part(at, p)
  local out, size = {}, {}
  for k, direction in ipairs(at.across) do
    out[k], size[k] = 0, 0
    for i = 1, #p do
      out[k], size[k] = out[k] + direction[i] * p[i], size[k] + abs(direction[i] * p[i])
    end
  end
  return out, size
end

-- q of x with the common coordinates at zero; q or v of x across the common motion
local function plain_state(at, n)
  return function(x)
    local q = {}
    for i = 1, n do q[i] = 0 end
    for k, f in ipairs(at.left) do q[f] = x[k] end
    return core.vector(q)
  end
end

local function across_state(at, n)
  return function(x) return directions.along(at.across, x, n) end
end

---- is it so? ----

local function is_near(a, b, size)
  for i = 1, #a do
    if not (abs(a[i] - b[i]) <= SAME * size[i]) then return false end
  end
  return true
end

-- forces and momenta of a state: their parts along the common motion and across it
local function parts(at, of, n, mass, q, v, t)
  local g, F = of.L:gradient(q, v, t), of.force and of.force(q, v, t)
  local pull, drift, slope, Mv = {}, {}, {}, mass * v
  for i = 1, n do
    pull[i], slope[i] = g[i] + (F and F[i] or 0), g[n + i]
    drift[i] = g[n + i] - Mv[i]
  end
  local out = {}
  out.pull, out.pull_size = common_part(at, pull)
  out.drift = common_part(at, drift)
  local _, drift_size = common_part(at, slope)
  out.drift_size = drift_size
  out.force, out.force_size = across_part(at, pull)
  out.momentum, out.momentum_size = across_part(at, slope)
  return out
end

local function biggest(a, b)
  local out = {}
  for i = 1, #a do out[i] = max(a[i], b[i]) end
  return out
end

-- state k moved along the common motion
local function moved(problem, at, k)
  local q, v, t = directions.state(problem, 100 + k)
  local far, fast = FAR * (problem.q:norm() + 1e-300), FAR * (problem.v:norm() + 1e-300)
  local s, w = {}, {}
  for j = 1, #at.basis do s[j], w[j] = far * (k - 3.7) / j, fast * (k - 2.3) / j end
  return q + directions.along(at.basis, s, problem.n),
    v + directions.along(at.basis, w, problem.n), t
end

local function same_constraint(of, at, q, own, t)
  if not of.constraint then return true end
  local J, size = of.constraint:jacobian(q, t), {}
  for i = 1, J.rows do
    size[i] = 1e-300
    for k = 1, #q do size[i] = size[i] + abs(J[i][k] * q[k]) end
  end
  return is_near(of.constraint(q, t), of.constraint(own, t), size)
end

-- Does the common motion change nothing across it? Then the forces along it, where they are
-- constant; nil and false where not
local function look(problem, at, of, mass)
  local n, first, uniform, size = problem.n, nil, true, nil
  local across = across_state(at, n)
  for k = 1, STATES do
    local q, v, t = moved(problem, at, k)
    local own, rate = across(relative_part(at, q)), across(relative_part(at, v))
    local here, there = parts(at, of, n, mass, q, v, t), parts(at, of, n, mass, own, rate, t)
    if not (is_near(here.force, there.force, biggest(here.force_size, there.force_size))
      and is_near(here.momentum, there.momentum, biggest(here.momentum_size, there.momentum_size))
      and same_constraint(of, at, q, own, t)) then
      return false
    end
    first = first or here
    size = size and biggest(size, here.pull_size) or here.pull_size
    uniform = uniform and is_near(here.pull, first.pull, size)
      and is_near(here.drift, first.drift, biggest(here.drift_size, first.drift_size))
  end
  local pull = first.pull
  for j = 1, #pull do
    if abs(pull[j]) <= SAME * size[j] then pull[j] = 0 end
  end
  return true, uniform and pull or nil
end

---- the model ----

-- (q, v) at time t: the common motion from the start on
local function carried(problem, at, mass, pull)
  local n, q, v = problem.n, problem.q, problem.v
  local s0 = at.weigh((common_part(at, mass * q)))
  local w0, a0 = at.weigh((common_part(at, mass * v))), at.weigh(pull)
  local across = across_state(at, n)
  return function(x, y, t)
    local tau, s, w = t - problem.t0, {}, {}
    for j = 1, #at.basis do
      s[j], w[j] = s0[j] + tau * w0[j], w0[j]
      if a0[j] ~= 0 then s[j], w[j] = s[j] + a0[j] / 2 * tau * tau, w[j] + a0[j] * tau end
    end
    return across(x) + directions.along(at.basis, s, n),
      across(y) + directions.along(at.basis, w, n)
  end
end

local function with_momenta(problem, f, state)
  local n = problem.n
  local needs, any = core.trace(f, n, n, "number", n):depends()[4], false
  for i = 1, n do any = any or needs[i] end
  local slope = core.derivative(problem.L, n, n, "number")
  return function(x, y, t)
    local q, v = state(x, y, t)
    local g, p = any and slope(q, v, t), {}
    for i = 1, n do p[i] = g and g[n + i] or 0 end
    return f(q, v, t, core.vector(p))
  end
end

-- is f(q, v, t) the same without the common motion?
local function is_relative(problem, at, f, state)
  local n, function_of = problem.n, with_momenta(problem, f, function(q, v) return q, v end)
  local g = core.trace(function(q, v, t) return core.vector(entries(function_of(q, v, t))) end, n,
    n, "number")
  for k = 1, STATES do
    local q, v, t = moved(problem, at, k)
    local own, rate = state(relative_part(at, q), relative_part(at, v))
    local J, size = g:jacobian(q, v, t), {}
    local here = g(q, v, t)
    for i = 1, J.rows do
      size[i] = abs(here[i])
      for j = 1, n do size[i] = size[i] + abs(J[i][j] * q[j]) + abs(J[i][n + j] * v[j]) end
    end
    if not is_near(here, g(own, rate, t), size) then return false end
  end
  return true
end

-- what is watched, of the relative state; nil where it needs a common motion that is not known
local function watched(problem, at, mass, pull, state)
  local out, whole = {}, nil
  for name, f in pairs(problem.watched) do
    if is_relative(problem, at, f, state) then
      out[name] = with_momenta(problem, f, state)
    elseif pull then
      whole = whole or carried(problem, at, mass, pull)
      out[name] = with_momenta(problem, f, whole)
    else
      return nil
    end
  end
  return out
end

local function names_of(problem, at)
  local out = {}
  for k, a in ipairs(at.basis) do out[k] = problem.names[a.at] end
  return table.concat(out, ", ")
end

-- C' F, of symbols
local function across_force(at, F)
  local out = {}
  for k, direction in ipairs(at.across) do
    out[k] = 0
    for i = 1, #F do
      if direction[i] ~= 0 then out[k] = out[k] + direction[i] * F[i] end
    end
  end
  return core.vector(out)
end

local function system_of(problem, at, of, state)
  local names = {}
  for k, f in ipairs(at.left) do names[k] = problem.names[f] end
  return core.system { Q = core.R(#at.left), coordinates = names,
    L = function(x, y, t)
      local q, v = state(x, y)
      return problem.L(q, v, t)
    end,
    force = of.force and function(x, y, t)
      local q, v = state(x, y)
      return across_force(at, of.force(q, v, t))
    end or nil,
    constraint = of.constraint and function(x, t)
      return of.constraint(state(x, x), t)
    end or nil }
end

local function build(problem, options)
  local n, of = problem.n, functions_of(problem)
  local basis = directions.unchanged(problem, jacobians(of, n))
  if #basis == 0 or #basis == n then return nil end
  local mass = mass_of(problem, of)
  local at = coordinates(problem, basis, mass)
  local fine, pull = look(problem, at, of, mass)
  if not fine then return nil end
  local still = pull ~= nil
  for j = 1, pull and #pull or 0 do still = still and pull[j] == 0 end
  local position, across = still and plain_state(at, n) or across_state(at, n), across_state(at, n)
  local function state(x, y) return position(x), across(y) end
  local functions = watched(problem, at, mass, pull, state)
  if not functions then return nil end
  local other = model_of.problem(system_of(problem, at, of, state), {
    q = relative_part(at, problem.q), v = relative_part(at, problem.v), t0 = problem.t0,
    until_t = options.until_t, watch = functions, tolerance = problem.tolerance,
    project = problem.project })
  other.parent = problem.parent or problem
  local out = model_of.given(other)
  out.steps = { ("relative to %s, with which all may be moved"):format(names_of(problem, at)) }
  return out
end

local function is_plain(problem)
  local given = problem.given
  return problem.units and problem.n > 1 and problem.system:structure().constant_mass
    and not (given.rolling or given.control or given.reaction or given.derivatives)
end

--- The model of the relative motion, nil where there is none.
function M.model(problem, options)
  local fine, out = blame.try(function()
    return is_plain(problem) and build(problem, options) or nil
  end)
  return fine and out or nil
end

return M
