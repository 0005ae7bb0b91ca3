--- Linear models: L to second order about an equilibrium near the start, in its modes, of which
-- those that the start does not excite, or nothing watched feels, are left out. They are solved in
-- closed form.
local blame = require "dm.base.blame"
local core = require "dm.core"
local equilibrium = require "dm.scene.equilibrium"
local model_of = require "dm.scene.model"

local M = {}

local abs, sqrt, max = math.abs, math.sqrt, math.max

local MOST = 128               -- coordinates
local FREE = 1e-13             -- of the largest square: a mode without a spring
local SEEN = 0.1               -- of the tolerance: what all modes left out may add up to
local GYROSCOPIC = 1e-12       -- of the mass: couplings of q and v that are none

-- blocks of the Hessian of L by (q, v) as matrices: -L_qq and L_vv; nil where q and v are coupled
local function blocks(H, n)
  local K, mass, largest, coupled = {}, {}, 0, 0
  for i = 1, n do
    K[i], mass[i] = {}, {}
    for k = 1, n do
      K[i][k], mass[i][k] = -0.5 * (H[i][k] + H[k][i]), 0.5 * (H[n + i][n + k] + H[n + k][n + i])
      largest = max(largest, abs(mass[i][k]))
      coupled = max(coupled, abs(H[i][n + k]))
    end
  end
  if coupled > GYROSCOPIC * largest then return nil end
  return core.matrix(K), core.matrix(mass)
end

-- what is at q, for dm.scene.equilibrium: dL/dq, -L_qq, L_vv
local function pull_of(problem, L)
  local n, rest = problem.n, core.zeros(problem.n)
  return function(q)
    local K, mass = blocks(L:hessian(q, rest, problem.t0), n)
    return K and L:gradient(q, rest, problem.t0):slice(1, n), K, mass
  end
end

local function is_finite(row)
  local sum = 0
  for i = 1, #row do sum = sum + 0 * row[i] end
  return sum == 0
end

-- times at which a motion is looked at, in parts of the whole: in step with nothing
local LOOKS = { 0.0131, 0.0557, 0.1459, 0.2361, 0.3820, 0.6180, 0.8541, 0.9757 }

-- states q, v, t by which sensitivities are taken: an equilibrium, the start, and along the motion
local function places_of(problem, q, motion)
  local out = { { q, core.zeros(problem.n), problem.t0 }, { problem.q, problem.v, problem.t0 } }
  for _, part in ipairs(LOOKS) do
    local t = problem.t0 + part * problem.T
    local x, v = motion(t)
    out[#out + 1] = { x, v, t }
  end
  return out
end

--- Rows of all watched numbers by q and v at an equilibrium q, at the start and along a motion q, v
-- = motion(t), where what bends (an energy, a distance squared) does not vanish: { row =,
-- tolerance = }.
function M.sensitivities(problem, q, motion)
  local n, out, places = problem.n, {}, places_of(problem, q, motion)
  local slope = core.derivative(problem.L, n, n, "number")
  for name, f in pairs(problem.watched) do
    local g = core.trace(function(x, v, t)
      local p, s = {}, slope(x, v, t)
      for i = 1, n do p[i] = s[n + i] end
      return f(x, v, t, core.vector(p))
    end, n, n, "number")
    for _, place in ipairs(places) do
      -- where it has no derivative, as a distance at its zero, the other one tells
      local fine, J = blame.try(g.jacobian, g, place[1], place[2], place[3])
      for i = 1, fine and J.rows or 0 do
        if is_finite(J[i]) then
          out[#out + 1] = { row = J[i],
            tolerance = problem.tolerance[name] or problem.tolerance[name .. i] }
        end
      end
    end
  end
  return out
end

-- how much a mode moves what is watched, in tolerances
local function seen(problem, rows, mode)
  local worst = 0
  for _, s in ipairs(rows) do
    local by_q, by_v = 0, 0
    for i = 1, problem.n do
      by_q, by_v = by_q + s.row[i] * mode.x[i], by_v + s.row[problem.n + i] * mode.x[i]
    end
    worst = max(worst, (abs(by_q) * mode.amplitude + abs(by_v) * mode.speed) / s.tolerance)
  end
  return worst
end

-- modes with x, omega^2, where they start, how far they go; push: what is left of the forces at q
-- along a mode without a spring
local function modes_of(problem, q, pull, K, mass)
  local n, T, largest = problem.n, problem.T, 0
  local squares, vectors = K:modes(mass)
  for k = 1, n do largest = max(largest, abs(squares[k])) end
  local d, out = problem.q - q, {}
  local Md, Mv = mass * d, mass * problem.v
  for k = 1, n do
    local x = core.zeros(n)
    for i = 1, n do x[i] = vectors[i][k] end
    local y, w, square = x:dot(Md), x:dot(Mv), squares[k]
    local push = abs(square) <= FREE * largest and x:dot(pull) or 0
    out[k] = { x = x, square = square, y = y, w = w, push = push,
      amplitude = square > 0 and sqrt(y * y + w * w / square) or abs(y) + T * abs(w),
      speed = square > 0 and sqrt(y * y * square + w * w) or abs(w) }
    if square < 0 then -- it grows
      local rate = sqrt(-square)
      out[k].amplitude = (abs(y) + abs(w) / rate) * math.exp(rate * T)
      out[k].speed = rate * out[k].amplitude
    end
    out[k].amplitude = out[k].amplitude + abs(push) * T * T / 2
    out[k].speed = out[k].speed + abs(push) * T
  end
  return out
end

-- what is watched of a model whose state (y, w, t) stands for q, v = state(y, w, t)
local function watched_at(problem, state)
  local out, n = {}, problem.n
  local slope = core.derivative(problem.L, n, n, "number")
  for name, f in pairs(problem.watched) do
    local needs, any = core.trace(f, n, n, "number", n):depends()[4], false
    for i = 1, n do any = any or needs[i] end
    out[name] = function(y, w, t)
      local x, v = state(y, w, t)
      local g, p = any and slope(x, v, t), {}
      for i = 1, n do p[i] = g and g[n + i] or 0 end
      return f(x, v, t, core.vector(p))
    end
  end
  return out
end

-- q and v of the modes at y, w
local function lifted(problem, q, modes)
  return function(y, w)
    local x, v = {}, {}
    for i = 1, problem.n do
      x[i], v[i] = q[i], 0
      for k, mode in ipairs(modes) do
        if mode.x[i] ~= 0 then x[i], v[i] = x[i] + mode.x[i] * y[k], v[i] + mode.x[i] * w[k] end
      end
    end
    return core.vector(x), core.vector(v)
  end
end

local function model_with(problem, options, q, modes, all)
  local k, y, w = #modes, {}, {}
  for i, mode in ipairs(modes) do y[i], w[i] = mode.y, mode.w end
  local system = core.system { Q = core.R(k), L = function(x, v)
    local sum = 0
    for i, mode in ipairs(modes) do sum = sum + (v[i] ^ 2 - mode.square * x[i] ^ 2) / 2 end
    for i, mode in ipairs(modes) do sum = sum + mode.push * x[i] end
    return sum
  end }
  local other = model_of.problem(system, { q = y, v = w, t0 = problem.t0,
    until_t = options.until_t, watch = watched_at(problem, lifted(problem, q, modes)),
    tolerance = problem.tolerance })
  other.parent = problem.parent or problem
  local out = model_of.given(other)
  out.steps = { ("linear about an equilibrium, %d of %d modes"):format(k, all) }
  return out
end

-- y and its rate at a time after the start: solutions of y'' = -square y + push
local function exact_mode(mode, after)
  local c, s, half, root = nil, nil, nil, sqrt(abs(mode.square))
  if mode.square > 0 then
    c, s, half = core.cos(root * after), core.sin(root * after) / root, core.sin(root * after / 2)
  elseif mode.square < 0 then
    c, s = core.cosh(root * after), core.sinh(root * after) / root
    half = core.sinh(root * after / 2)
  else
    c, s = 1, after
  end
  -- of a push, (1 - c)/square
  local far = half and 2 * (half / root) ^ 2 or after ^ 2 / 2
  return c * mode.y + s * mode.w + mode.push * far,
    c * mode.w - mode.square * s * mode.y + mode.push * s
end

--- The model whose motion is known, q, v = motion(t): what is watched becomes functions of time.
-- What is stepped, with any rule and any step, is a system of `size` coordinates that rests.
function M.solved(problem, options, size, motion, words)
  local rest = {}
  for k = 1, size do rest[k] = 0 end
  local system = core.system { Q = core.R(size), L = function(x, v)
    return (v:dot(v) - x:dot(x)) / 2
  end }
  local other = model_of.problem(system, { q = rest, v = rest, t0 = problem.t0,
    until_t = options.until_t, tolerance = problem.tolerance,
    watch = watched_at(problem, function(_, _, t) return motion(t) end) })
  other.parent = problem.parent or problem
  local out = model_of.given(other)
  out.steps = { words }
  out.is_solved = true
  return out
end

-- q and v of some modes as functions of time
local function motion_of(problem, q, modes)
  local state = lifted(problem, q, modes)
  return function(t)
    local y, w = {}, {}
    for k, mode in ipairs(modes) do y[k], w[k] = exact_mode(mode, t - problem.t0) end
    return state(y, w)
  end
end

local function solved_modes(problem, options, q, modes, all)
  return M.solved(problem, options, #modes, motion_of(problem, q, modes),
    ("linear about an equilibrium, %d of %d modes, solved"):format(#modes, all))
end

--- Of a list of parts of a motion as few as are needed: the others add up to less than is seen,
-- by their sizes in tolerances.
function M.largest(parts, size_of)
  local size, order, left, out = {}, {}, 0, {}
  for k, part in ipairs(parts) do size[k], order[k] = size_of(part), k end
  table.sort(order, function(a, b) return size[a] > size[b] or (size[a] == size[b] and a < b) end)
  for at = #order, 2, -1 do
    left = left + size[order[at]]
    if not (left <= SEEN) then break end
    order[at] = nil
  end
  table.sort(order)
  for _, k in ipairs(order) do out[#out + 1] = parts[k] end
  return out
end

local function is_plain(problem)
  local given = problem.given
  return problem.n <= MOST and not (given.force or given.constraint or given.rolling
    or given.control or given.reaction or given.derivatives or problem.project)
    and problem.system:structure().autonomous and not problem.system:structure().linear_in_v
end

--- Linear models of a problem, with the modes that are seen: solved, or, where rules are named, to
-- be stepped by these. None where there is no equilibrium near the start, or forces, constraints,
-- couplings of q and v.
function M.models(problem, options)
  local fine, out = blame.try(function()
    if not is_plain(problem) then return {} end
    local n = problem.n
    local L = core.trace(problem.L, n, n, "number")
    local q, pull, K, mass = equilibrium.near(problem.q, pull_of(problem, L))
    if not q then return {} end
    local modes = modes_of(problem, q, pull, K, mass)
    local rows = M.sensitivities(problem, q, motion_of(problem, q, modes))
    local left = M.largest(modes, function(mode) return seen(problem, rows, mode) end)
    local stepped = options.rules or options.frame
    return { (stepped and model_with or solved_modes)(problem, options, q, left, n) }
  end)
  return fine and out or {}
end

return M
