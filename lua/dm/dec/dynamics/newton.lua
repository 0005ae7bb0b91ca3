--- Newton's method for a function with a sparse Hessian: downhill by Armijo's rule while it is far,
-- and to round-off in the end.
local core = require "dm.core"
local matrices = require "dm.dec.equations.matrices"

local M = {}

local DENSE = 1200 -- unknowns that dense elimination takes, where there is no dm/sparse.so

---- problems without constraints ----

--- From value, gradient and hessian of x[n] and the set of its entries that are held: the same with
-- slopes and curvature of what is free, and moved(x, d).
function M.flat(problem)
  local keep, free = core.constant(problem.n, 1), 0
  for i = 1, problem.n do if problem.held[i] then keep[i] = 0 else free = free + 1 end end
  return { value = problem.value, gradient = problem.gradient, unknowns = free,
    slopes = function(x) return core.pick(problem.gradient(x), keep) end,
    curvature = function(x) return problem.hessian(x):pick(keep, keep) end,
    moved = function(x, d) return x + core.spread(d, keep) end }
end

---- directions ----

local function solved(S, way, b)
  local factor = S:factor(way)
  return factor and factor.condition > 1e-15 and factor:solve(b) or nil
end

-- S d = b where S is positive definite, else nothing
local function definite(S, b)
  if core.solvers() then return solved(S, "cholesky", b) end
  return solved(S, "gradients", b)
end

-- S d = b for any regular S
local function regular(S, b)
  if core.solvers() then return solved(S, "lu", b) end
  return S.rows <= DENSE and solved(S, "dense", b) or nil
end

-- the largest modulus of the diagonal, not 0
local function size_of(S)
  local largest, diagonal = 0, S:diagonal()
  for i = 1, #diagonal do largest = math.max(largest, math.abs(diagonal[i])) end
  return largest > 0 and largest or 1
end

-- S + shift with a shift that makes it positive definite
local function downhill(S, b)
  local size, shift = size_of(S), 1e-10
  while shift < 1e6 do
    local d = definite(S + matrices.diagonal(core.constant(S.rows, shift * size)), b)
    if d and d:dot(d) - d:dot(d) == 0 then return d end
    shift = 10 * shift
  end
end

---- steps ----

local function is_finite(x) return x - x == 0 end

-- the longest of the steps 1, 1/2, 1/4, ... along d that is good enough
local function search(x, problem, d, good)
  local step = 1
  for _ = 1, 60 do
    local to = problem.moved(x, step * d)
    local value = problem.value(to)
    if is_finite(value) and good(to, value, step) then return to, value, step end
    step = step / 2
  end
end

-- Armijo: a part of what the slope promises, but for round-off
local function by_value(problem, s)
  local rounding = 1e-14 * math.max(math.abs(s.value), 1e-300)
  return function(d)
    local slope = s.slopes:dot(d)
    return search(s.x, problem, d, function(_, value, step)
      return value <= s.value + 1e-4 * step * slope + rounding
    end)
  end
end

-- the norm of the slopes becomes less
local function by_slopes(problem, s)
  return function(d)
    return search(s.x, problem, d, function(to, _, step)
      local norm = problem.slopes(to):norm()
      return is_finite(norm) and norm <= (1 - 1e-4 * step) * s.residual
    end)
  end
end

-- the next point, or nothing
local function step_from(problem, s)
  local b = -1 * s.slopes
  local d = definite(s.S, b)
  if d then
    local x, value, step = by_value(problem, s)(d)
    if x then return x, value, step end
  end
  d = not d and regular(s.S, b) or nil
  if d then
    local x, value, step = by_slopes(problem, s)(d)
    if x then return x, value, step end
  end
  d = downhill(s.S, b)
  if d then return by_value(problem, s)(d) end
end

-- residuals below it, beside |S| |x|, are of round-off once they no longer fall; and a step that is
-- longer than SHORT |x| has not arrived
local ROUNDING, SHORT = 1e-9, 1e-3
-- A residual that has not halved for so many steps is of round-off, too, where the value does not
-- show what a step could gain: of displacements near 0 of a body under stress, say.
local STALLED, UNSEEN = 4, 1e-14
local FLAT = 1e-9 -- curvatures below it, beside the largest, are none

local TEXT = { ok = "stationary", limit = "the iterations were not enough: give more of them",
  no_convergence = "the gradient no longer becomes less: it may have no zero near the start, or a "
    .. "step leads out of where the term is finite" }

-- what the curvature says of the point
local function kind_of(s)
  if definite(s.S, s.slopes) then return "minimum" end
  local lifted = s.S + matrices.diagonal(core.constant(s.S.rows, FLAT * size_of(s.S)))
  return definite(lifted, s.slopes) and "degenerate" or "saddle"
end

local function report_of(s, code, iterations, why)
  s.kind = s.S and kind_of(s)
  return core.result { code = code, text = TEXT[why or code], value = s.value,
    iterations = iterations, residual = s.residual, kind = s.kind }
end

local function look(problem, x)
  local s = { x = x, value = problem.value(x), slopes = problem.slopes(x) }
  s.residual = s.slopes:norm()
  return s
end

-- Is the residual of round-off, once it no longer falls?
local function is_small(s, step, size)
  return s.residual <= ROUNDING * size_of(s.S) * size and step <= SHORT * size
end

-- Is it, once it stays?
local function is_unseen(s, step)
  return s.residual * step <= UNSEEN * math.abs(s.value)
end

-- the better of a point and its successor, if there is one
local function better(s, now)
  if not now or now.residual >= s.residual then return s, 0 end
  now.S = s.S
  return now, 1
end

--- From x to where the slopes vanish to round-off, in at most so many iterations: x, report.
function M.solve(problem, x, most)
  local s, iterations, best, stalled = look(problem, x), 0, math.huge, 0
  if problem.unknowns == 0 then return x, report_of(s, "ok", 0) end
  while true do
    s.S = problem.curvature(s.x)
    local size = s.x:norm()
    if s.residual <= 1e-16 * size_of(s.S) * size then return s.x, report_of(s, "ok", iterations) end
    local to = iterations < most and step_from(problem, s)
    local now = to and look(problem, to)
    if now then now.step = (to - s.x):norm() end
    local step = now and now.step or iterations >= most and s.step or 0
    local small = is_small(s, step, size)
    if s.residual <= 0.5 * best then best, stalled = s.residual, 0 else stalled = stalled + 1 end
    local rests = now and stalled >= STALLED and is_unseen(s, step)
    if not to or rests or small and now.residual > 0.5 * s.residual then
      local last, more = better(s, now)
      if small or rests then return last.x, report_of(last, "ok", iterations + more) end
      local why = iterations >= most and "limit" or nil
      return last.x, report_of(last, "no_convergence", iterations + more, why)
    end
    s, iterations = now, iterations + 1
  end
end

return M
