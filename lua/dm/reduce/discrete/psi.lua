--- psi_mu of a discrete Lagrangian that the group leaves as it is: the group variable psi for which
-- dLd/dpsi (x0, x1, psi) = mu, an implicit function; with it the canonical momenta -dLd/dx0 and
-- dLd/dx1. Its derivatives are those of the graph.
local blame = require "dm.base.blame"
local core = require "dm.core"
local forces = require "dm.reduce.discrete.forces"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local shape_of = require "dm.reduce.routh.shape"

local M = {}

local abs = math.abs

-- the points of Ld over the shapes x0 and x1, psi apart, and the derivatives of the chart there
local function lifted(info, x0, x1, psi)
  local z0, z1, A = model.embed(info, x0), model.embed(info, x1, psi), info.ambient
  if not A then return z0, z1 end
  return A.chart(z0), A.chart(z1), A.slope(z0), A.slope(z1)
end
M.lifted = lifted

---- psi_mu ----

--- h theta' of the straight line from x0 to x1, for symbols too; 0 where it has no formula.
function M.straight(D)
  local info, h = D.info, D.h
  if info.root then return function() return core.zeros(info.m) end end
  return function(x0, x1)
    return h * core.vector((model.group_velocity(info, (x0 + x1) / 2, (x1 - x0) / h, 0)))
  end
end

-- (psi, w) as a function of (x0, x1, guess of psi), where A - mu . psi is stationary
local function root_of(D)
  local info, A = D.info, D.action
  return core.root { name = "psi_mu", unknowns = info.m + A.inner,
    failure = "is the step too long for this momentum?",
    start = function(x0, x1, guess)
      local q0, q1 = lifted(info, x0, x1, guess)
      return lists.joined(guess, A.start(q0, q1))
    end,
    stationary = function(y, x0, x1)
      local q0, q1 = lifted(info, x0, x1, y)
      local value = A.value(q0, q1, A.inner > 0 and lists.part(y, info.m, A.inner) or nil)
      for a = 1, info.m do value = value - info.mu[a] * y[a] end
      return value
    end }
end

--- D.root and D.both: (x0, x1, guess) -> psi[m], -dLd/dx0 [d], dLd/dx1 [d] and, with forces, F1, F2
-- along the shape [d each], as one vector.
function M.make(D)
  local info, A, push = D.info, D.action, D.forces and D.forces.push
  local n, m = info.n, info.m
  D.root = root_of(D)
  D.both = core.trace(function(x0, x1, guess)
    local y = D.root(x0, x1, guess)
    local q0, q1, J0, J1 = lifted(info, x0, x1, y)
    local slope = A.slope(q0, q1, A.inner > 0 and lists.part(y, m, A.inner) or nil)
    local out = lists.joined(lists.part(y, 0, m), -forces.of_shape(info, J0, slope))
    out = lists.joined(out, forces.of_shape(info, J1, lists.part(slope, n, n)))
    if not push then return out end
    local F1, F2 = push(q0, q1)
    return lists.joined(out,
      lists.joined(forces.of_shape(info, J0, F1), forces.of_shape(info, J1, F2)))
  end, info.d, info.d, m)
end

-- h theta' of the straight line on numbers: traced once, since D is of the L that it was made for
local function line_of(D)
  local line = rawget(D, "line")
  if line then return line end
  local info, h = D.info, D.h
  if info.root then
    local rate = shape_of.rate_of(info)
    function line(x0, x1) return h * rate((x0 + x1) / 2, (x1 - x0) / h, 0) end
  else
    line = core.trace(M.straight(D), info.d, info.d)
  end
  D.line = line
  return line
end

-- the same, 0 where the line has no velocity of the group
local function first_guess(D, x0, x1)
  local fine, guess = blame.try(line_of(D), x0, x1)
  if not fine then return core.zeros(D.info.m) end
  local sum = 0
  for a = 1, D.info.m do sum = sum + abs(guess[a]) end
  if sum < math.huge then return guess end
  local out = {}
  for a = 1, D.info.m do out[a] = abs(guess[a]) < math.huge and guess[a] or 0 end
  return core.vector(out)
end

local NONE = "no psi_mu between x0 = %s and x1 = %s: %s (h = %.6g)"

-- f(x0, x1, guess), or an error that names the shapes
local function at_pair(D, f, x0, x1, guess)
  local fine, out = blame.try(f, x0, x1, guess or first_guess(D, x0, x1))
  if fine then return out end
  local why = tostring(out):match "psi_mu has no value.*" or tostring(out)
  error(NONE:format(tostring(x0), tostring(x1), why, D.h), 0)
end

--- psi, and the canonical momenta y0 = -dLd/dx0 - F1, y1 = dLd/dx1 + F2 at both ends.
function M.pair(D, x0, x1, guess)
  local info, both = D.info, at_pair(D, D.both, x0, x1, guess)
  local m, d = info.m, info.d
  local out = { psi = lists.part(both, 0, m), y0 = lists.part(both, m, d),
    y1 = lists.part(both, m + d, d) }
  if D.forces and D.forces.push then
    out.y0 = out.y0 - lists.part(both, m + 2 * d, d)
    out.y1 = out.y1 + lists.part(both, m + 3 * d, d)
  end
  return out
end

--- Derivatives in (x0, x1): psi_x0, psi_x1 (m x d), and y0_x1, that of -dLd/dx0 (d x d).
function M.derivatives(D, x0, x1, psi)
  local info = D.info
  local m, d = info.m, info.d
  local J = at_pair(D, function(...) return D.both:jacobian(...) end, x0, x1, psi)
  local function block(row, rows, column)
    local out = {}
    for i = 1, rows do out[i] = lists.part(J[row + i], column, d) end
    return out
  end
  return { psi_x0 = block(0, m, 0), psi_x1 = block(0, m, d), y0_x1 = block(m, d, d) }
end

return M
