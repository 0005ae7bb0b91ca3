--- Symmetries of an action integral up to a divergence and a scale: generators (xi, tau) of (q, t)
-- with
--   f = L_q xi + L_v (D xi - v D tau) + L_t tau + L D tau = D B + c L,   D = d/dt along q(t).
-- f - c L is a total derivative where the Euler operator E takes it to 0 (Olver 1993, thm 4.7), so
-- c is found from E(f) = c E(L), and B_q = d(f - c L)/dv; B is the integral of B_q on a line.
local blame = require "dm.base.blame"
local core = require "dm.core"
local bound = require "dm.base.bound"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"

local M = {}

local part = lists.part
local abs, max = math.abs, math.max

local SAMPLES, SLACK = 12, 1e-8
local LEAST = 1e-300
local ROUND, HALVINGS = 2e-14, 24  -- of the integral that B is: relative; of its smallest pieces

---- f and its Euler operator ----

-- rows of the generators at (q, t): n of xi, one of tau
local function rows_of(action, n)
  local generator_rows = require "dm.action".generator_rows
  local moves_time = action.dimension == n + 1
  return function(q, t)
    local z = moves_time and lists.joined(q, { t }) or q
    local rows, tau = generator_rows(action, z), {}
    for a = 1, action.group.dimension do tau[a] = moves_time and rows[n + 1][a] or 0 end
    return rows, tau
  end
end

-- f of generator a, a function of (q, v, t)
local function change_of(L, rows, n, a)
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local moving = core.derivative(function(q, t)
    local xi, tau = rows(q, t)
    local out = {}
    for i = 1, n do out[i] = xi[i][a] end
    out[n + 1] = tau[a]
    return core.vector(out)
  end, n, "number")
  return function(q, v, t)
    local g, xi, tau, J = slope(q, v, t), nil, nil, moving(q, t)
    xi, tau = rows(q, t)
    local function total(i)
      local sum = J[i][n + 1]
      for j = 1, n do sum = sum + J[i][j] * v[j] end
      return sum
    end
    local rate = total(n + 1)
    local sum = g[2 * n + 1] * tau[a] + L(q, v, t) * rate
    for i = 1, n do
      sum = sum + g[i] * xi[i][a] + g[n + i] * (total(i) - v[i] * rate)
    end
    return sum
  end
end

-- E(f) at (q, v, acceleration, t): f_q - D f_v
local function euler(f, n)
  local F = core.trace(function(q, v, t) return f(q, v, t) end, n, n, "number")
  return function(q, v, acceleration, t)
    local g, H, out = F:gradient(q, v, t), F:hessian(q, v, t), {}
    for i = 1, n do
      local sum = g[i] - H[n + i][2 * n + 1]
      for j = 1, n do
        sum = sum - H[n + i][n + j] * acceleration[j] - H[n + i][j] * v[j]
      end
      out[i] = sum
    end
    return out
  end
end

---- the scale ----

-- c with E(f) = c E(L) at random states, or nothing; and how large f is there, of the size of L
local function scale_of(f, L, n)
  local Ef, EL, stream = euler(f, n), euler(L, n), core.random(4407)
  local above, below, pairs_of, size, largest, whole = 0, 0, {}, 0, 0, LEAST
  for i = 1, SAMPLES do
    local q, v = kits.normals(stream, 5 * i, n, 1), kits.normals(stream, 5 * i + 1, n, 1)
    local acceleration, t = kits.normals(stream, 5 * i + 2, n, 1), stream:uniform(5 * i + 3, 0, -1,
      1)
    local fine, x, y = blame.try(function()
      return Ef(q, v, acceleration, t), EL(q, v, acceleration, t)
    end)
    for k = 1, fine and kits.is_finite(x) and kits.is_finite(y) and n or 0 do
      above, below = above + x[k] * y[k], below + y[k] * y[k]
      pairs_of[#pairs_of + 1] = { x[k], y[k] }
      size = max(size, abs(x[k]), abs(y[k]))
    end
    if fine then largest, whole = max(largest, abs(f(q, v, t))), max(whole, abs(L(q, v, t))) end
  end
  if #pairs_of == 0 then return nil end
  local c = below > 0 and above / below or 0
  local near = math.floor(c * 12 + 0.5) / 12
  if abs(c - near) < 1e-9 then c = near end
  for _, pair in ipairs(pairs_of) do
    if abs(pair[1] - c * pair[2]) > SLACK * size then return nil end
  end
  return c, largest / whole
end

---- the divergence ----

-- the integral of f over [a, b] by 12 points of Gauss, halved until that changes nothing; nothing
-- where it never comes to that
local function integral(f, a, b)
  local nodes, weights = core.quadrature { named = "gauss(12)" }
  local function once(from, to)
    local sum, size = 0, 0
    for k = 1, #nodes do
      local term = weights[k] * (to - from) * f(from + (to - from) * nodes[k])
      sum, size = sum + term, size + abs(term)
    end
    return sum, size
  end
  local function refined(from, to, whole, size, depth)
    local middle = (from + to) / 2
    local left, left_size = once(from, middle)
    local right, right_size = once(middle, to)
    size = max(size, left_size + right_size)
    if abs(left + right - whole) <= ROUND * size then return left + right end
    if depth == 0 or size - size ~= 0 then return nil end
    left = refined(from, middle, left, size, depth - 1)
    right = left and refined(middle, to, right, size, depth - 1)
    return right and left + right
  end
  local whole, size = once(a, b)
  return refined(a, b, whole, size, HALVINGS)
end

-- where g is finite: q of zeros, of ones or at random, apart as bodies are; t = 0 or 1
local function origin_of(g, n)
  local zero, stream = core.zeros(n), core.random(17)
  for i = 0, SAMPLES do
    local q = i < 2 and zero:map(function() return i end) or kits.normals(stream, i, n, 1)
    for t = 0, 1 do
      local fine, value = blame.try(g, q, zero, t)
      if fine and type(value) == "number" and value - value == 0 then return q, t end
    end
  end
  return zero, 0
end

-- B(q, t) of g = B_q v + B_t, from a point where it is finite
local function potential(g, n)
  local by_v = core.derivative(function(q, v, t) return g(q, v, t) end, n, n, "number")
  local zero = core.zeros(n)
  local base, origin = origin_of(g, n)
  return function(q, t)
    q = core.vector(q)
    local dq = q - base
    local along = integral(function(s) return part(by_v(base + dq * s, zero, t), n, n):dot(dq) end,
      0, 1)
    local before = along and integral(function(time) return g(base, zero, time) end, origin, t)
    if before then return along + before end
    error(("the divergence B(q, t) of this symmetry has no finite integral from q = %s, t = %g to "
      .. "q = %s, t = %g: give path:noether your own, divergence = function(q, t)"):format(
      tostring(base), origin, tostring(q), t), 0)
  end
end

-- is a function of (q, t) zero at random places, beside L there?
local function is_zero(B, L, n)
  local stream, largest, whole = core.random(91), 0, 0
  for i = 1, 8 do
    local q = kits.normals(stream, i, n, 1)
    local fine, x = blame.try(B, q, 0.3 * i)
    if not fine or x ~= x then return false end
    local known, y = blame.try(L, q, kits.normals(stream, 100 + i, n, 1), 0.3 * i)
    largest, whole = max(largest, abs(x)), max(whole, known and abs(y) or 0)
  end
  return largest <= 1e-10 * whole
end

---- the answer ----

local class = { __name = "dm.symmetry" }

function class.__tostring(s)
  local words = {}
  if s.divergence then words[#words + 1] = "a divergence" end
  if s.scale then words[#words + 1] = ("a scale, %.10g"):format(s.scale) end
  if #words == 0 then return "symmetry" end
  return "symmetry up to " .. table.concat(words, " and ")
end

local function symmetry_of(L, rows, n, a)
  local f = change_of(L, rows, n, a)
  local c, largest = scale_of(f, L, n)
  if not c then return nil end
  local out = { generator = function(q, t)
    local xi, tau = rows(core.vector(q), t)
    local v = {}
    for i = 1, n do v[i] = xi[i][a] end
    return core.vector(v), tau[a]
  end }
  if c ~= 0 then out.scale = c end
  local B = potential(function(q, v, t) return f(q, v, t) - c * L(q, v, t) end, n)
  if not is_zero(B, L, n) then out.divergence = B end
  return setmetatable(out, class), largest
end

--- The symmetry of a system that each generator of the action is, up to divergence and scale: of a
-- group of one dimension a table { generator, divergence, scale }, as path:noether takes it, else a
-- list of them; nothing where one is none. Also how much L changes at most.
function M.of_system(action, system)
  local n, out, most = system.Q.dimension, {}, 0
  local L, rows = bound(system.given.L, system.given.params), rows_of(action, n)
  for a = 1, action.group.dimension do
    local one, largest = symmetry_of(L, rows, n, a)
    if not one then return nil, 0, a end
    out[a], most = one, max(most, largest)
  end
  return #out == 1 and out[1] or core.result(out), most
end

return M
