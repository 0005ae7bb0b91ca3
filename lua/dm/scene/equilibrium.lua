--- Equilibria near the start of a problem, about which it is linearised.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local abs, max, huge = math.abs, math.max, math.huge

local TRIES, SETTLED = 40, 1e-13
local NEAR = 1e-9     -- of q: steps that do not get shorter any more are round-off
local AWAY = 1e3      -- times the last step: it leaves
local FREE = 1e-13    -- of the largest square: a mode without a spring
local SINGULAR = 1e-26 -- of |K|^2: directions in which nothing pulls back
local SYMMETRIC = 1e-13 -- of the largest entry: K is that of a potential

-- is K symmetric within rounding? And its largest entry
local function is_symmetric(K, n)
  local largest, off = 0, 0
  for i = 1, n do
    for k = 1, n do
      largest, off = max(largest, abs(K[i][k])), max(off, abs(K[i][k] - K[k][i]))
    end
  end
  return off <= SYMMETRIC * largest, largest
end

-- K^-1 pull by the modes of a symmetric K, without those that nothing pulls back; nil where the
-- mass is not positive
local function by_modes(K, mass, pull, n)
  local fine, squares, vectors = blame.try(K.modes, K, mass)
  if not fine then return nil end
  local step, largest = core.zeros(n), 0
  for k = 1, n do largest = max(largest, abs(squares[k])) end
  for k = 1, n do
    if abs(squares[k]) > FREE * largest then
      local x = core.zeros(n)
      for i = 1, n do x[i] = vectors[i][k] end
      step = step + x * (x:dot(pull) / squares[k])
    end
  end
  return step
end

-- the shortest step that K allows
local function by_least_length(K, pull, n)
  local back, square = K:transpose(), 0
  for i = 1, n do
    for k = 1, n do square = square + K[i][k] ^ 2 end
  end
  return (back * K + core.identity(n) * (SINGULAR * square)):solve(back * pull)
end

--- The equilibrium that Newton's method finds from q, of M x'' = pull(x) with d pull/dx = -K:
-- at(q) -> pull, K, mass, or nil where there is none. Directions in which nothing pulls back stay
-- as they are. q, and what is at it; nil where nothing settles.
function M.near(q, at)
  local first, n, last = q, #q, huge
  q = q + 0
  for _ = 1, TRIES do
    local pull, K, mass = at(q)
    if not pull then return nil end
    local symmetric, largest = is_symmetric(K, n)
    if largest == 0 then return nil end
    local step = symmetric and by_modes(K, mass, pull, n) or by_least_length(K, pull, n)
    local length = step:norm()
    if not (length <= last) and length <= NEAR * (1 + q:norm()) then return q, pull, K, mass end
    if not (length < AWAY * last) then return nil end
    q, last = q + step, length
    if length <= SETTLED * (q:norm() + (q - first):norm()) then return q, at(q) end
  end
end

return M
