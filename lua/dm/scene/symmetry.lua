--- A symmetry that is told, for a scene: the same problem in coordinates (theta, x) of the group
-- and a section, in which theta is cyclic.
local core = require "dm.core"
local model = require "dm.scene.model"
local option = require "dm.base.options"
local section = require "dm.reduce.routh.section"

local M = {}

local KNOWN = { "action", "section", "dimension", "names", "at", "branch" }

--- Is it a table with an action? Raises where not.
function M.check(symmetry)
  local where = "dm.scene: option 'symmetry'"
  option.check(symmetry, KNOWN, where, "{ action = f(theta, q), section = f(x) ... }")
  option.need(symmetry, "action", where, "a function of (theta, q), as for system:routh")
end

-- what is watched, as functions of the state in (theta, x)
local function lifted(problem, T)
  local out, n = {}, problem.n
  local slope = core.derivative(problem.L, n, n, "number")
  for name, f in pairs(problem.watched) do
    out[name] = function(y, w, t)
      local q, v = T.chart(y), T.slope(y) * w
      local g, p = slope(q, v, t), {}
      for i = 1, n do p[i] = g[n + i] end
      return f(q, v, t, core.vector(p))
    end
  end
  return out
end

local TURNS = { 0.37, -1.1, 2.3 }
local SAME = 1e-9

local function entries_of(value) return type(value) == "number" and { value } or value end

-- is what is watched the same when the group moves the state by theta_i, at the start and near it?
local function is_invariant(problem, i)
  for _, f in pairs(problem.watched) do
    for turn, angle in ipairs(TURNS) do
      local y, w = problem.q + 0, problem.v + 0
      for k = 1, problem.n do
        y[k] = y[k] * (1 + 0.01 * turn * k)
        w[k] = w[k] + 0.02 * turn
      end
      local a = entries_of(f(y, w, problem.t0))
      y[i] = y[i] + angle
      local b = entries_of(f(y, w, problem.t0))
      for k = 1, #a do
        if not (math.abs(a[k] - b[k]) <= SAME * (1 + math.abs(a[k]))) then return false end
      end
    end
  end
  return true
end

--- The problem in (theta, x) and its model; what the group does not change does not need theta.
function M.model(problem, options)
  local symmetry = options.symmetry
  local given = { q = problem.q, v = problem.v }
  for key, value in pairs(symmetry) do given[key] = value end
  local split, start, T = section.split(problem.system, given)
  local other = model.problem(split, { q = start.q, v = start.v, t0 = problem.t0,
    until_t = options.until_t, watch = lifted(problem, T),
    tolerance = problem.tolerance, project = options.project })
  other.parent = problem
  other.group = {}
  for a = 1, #start.cyclic do
    other.group[other.names[a]] = true
    if is_invariant(other, a) then other.needs.q[a] = false end
  end
  local out = model.given(other)
  out.steps = { "in coordinates of the symmetry" }
  return out
end

return M
