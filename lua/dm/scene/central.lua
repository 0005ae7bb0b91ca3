--- A symmetry that is found: where turns of the plane or of space change neither L nor what is
-- watched, motion is in a plane, and its angle there is cyclic.
local blame = require "dm.base.blame"
local core = require "dm.core"
local model_of = require "dm.scene.model"

local M = {}

local abs, cos, sin = math.abs, math.cos, math.sin

local SAME, FLAT = 1e-11, 1e-9

-- a turn of two or three coordinates, as a function of vectors; `which` chooses the axes
local function turn(n, which, angle)
  local c, s = cos(angle), sin(angle)
  local i, k = which, which % n + 1
  return function(x)
    local y = core.vector(x)
    y[i], y[k] = c * x[i] - s * x[k], s * x[i] + c * x[k]
    return y
  end
end

local function entries(value) return type(value) == "number" and { value } or value end

local function is_near(a, b)
  a, b = entries(a), entries(b)
  for i = 1, #a do
    if not (abs(a[i] - b[i]) <= SAME * (1 + abs(a[i]))) then return false end
  end
  return true
end

-- states near the start that fall in step with nothing
local STATES = { { 0.37, -0.21 }, { -0.13, 0.41 }, { 0.29, 0.17 } }

local function state(problem, which)
  local a, q, v = STATES[which], problem.q + 0, problem.v + 0
  for i = 1, problem.n do
    q[i] = q[i] * (1 + 0.1 * a[1] * i) + 0.01 * a[2] * i * problem.q:norm()
    v[i] = v[i] + 0.1 * (a[2] - 0.3 * a[1] * i) * (problem.v:norm() + 0.1)
  end
  return q, v
end

-- do turns leave f(q, v, t, p) as it is, with p of the turned state?
local function is_invariant(problem, f)
  for s = 1, #STATES do
    local q, v = state(problem, s)
    local before = f(q, v, problem.t0, problem.system:legendre(q, v, problem.t0))
    for which = 1, problem.n == 2 and 1 or problem.n do
      local R = turn(problem.n, which, 0.7 + 0.3 * s)
      local x, w = R(q), R(v)
      local after = f(x, w, problem.t0, problem.system:legendre(x, w, problem.t0))
      if not is_near(before, after) then return false end
    end
  end
  return true
end

-- unit vectors of the plane of q and v, the first along q, and v in it; nil: v is along q
local function plane(problem)
  local q, v, r = problem.q, problem.v, problem.q:norm()
  if not (r > 0) then return nil end
  local e1 = q / r
  local along = e1:dot(v)
  local across = v - along * e1
  local rate = across:norm()
  if not (rate > FLAT * (v:norm() + 1e-300)) then return nil end
  return e1, across / rate, { r = r, along = along, across = rate }
end

-- (q, v) of (theta, r) and their rates, at theta = 0: the angle itself is nowhere
local function state_of(e1, e2)
  return function(y, w) return y[2] * e1, w[2] * e1 + y[2] * w[1] * e2 end
end

local function lifted(problem, at)
  local out, n = {}, problem.n
  local slope = core.derivative(problem.L, n, n, "number")
  for name, f in pairs(problem.watched) do
    out[name] = function(y, w, t)
      local q, v = at(y, w)
      local g, p = slope(q, v, t), {}
      for i = 1, n do p[i] = g[n + i] end
      return f(q, v, t, core.vector(p))
    end
  end
  return out
end

local function is_central(problem)
  local given = problem.given
  if problem.n < 2 or problem.n > 3 or given.force or given.constraint or given.rolling
    or given.control or given.derivatives or given.params or problem.project then
    return false
  end
  if not is_invariant(problem, problem.L) then return false end
  for _, f in pairs(problem.watched) do
    if not is_invariant(problem, f) then return false end
  end
  return true
end

--- The system in (theta, r) of the plane of motion, theta cyclic; nil where it has no such
-- symmetry.
function M.model(problem, options)
  local fine, e1, e2, start = blame.try(function()
    if is_central(problem) then return plane(problem) end
  end)
  if not (fine and e1) then return nil end
  local at = state_of(e1, e2)
  local system = core.system { Q = core.R(2), coordinates = { "theta", "r" },
    L = function(y, w, t)
      local q, v = at(y, w)
      return problem.L(q, v, t)
    end }
  local other = model_of.problem(system, { q = { 0, start.r },
    v = { start.across / start.r, start.along }, t0 = problem.t0, until_t = options.until_t,
    watch = lifted(problem, at), tolerance = problem.tolerance })
  other.parent = problem.parent or problem
  other.group = { theta = true }
  local out = model_of.given(other)
  out.steps = { "in polar coordinates of the plane of motion, as turns change nothing" }
  return out
end

return M
