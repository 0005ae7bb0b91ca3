--- The slice that a symmetry is cut along when none is given: coordinates held at 0 wherever the
-- orbit of the start comes to such points. Held at any other value r0, a slice of rotations has no
-- points with r < r0, and the mass of the shape vanishes where an orbit comes down to r0.
local blame = require "dm.base.blame"
local core = require "dm.core"
local linear = require "dm.base.linear"

local M = {}

local abs, max = math.abs, math.max

local MOST, CANDIDATES, TURNS = 40, 60, 8
local FLAT = 1e-8   -- of the largest motion by the group at the start: less is no motion

--- m coordinates that the columns d(g . q)/dtheta move most, by elimination, and the product of the
-- pivots; only of `among` where it is given.
function M.moved_most(columns, n, among)
  local held, product = {}, 1
  for a = 1, #columns do
    local best = 0
    for i = 1, n do
      if not held[i] and (not among or among[i])
        and (best == 0 or abs(columns[a][i]) > abs(columns[a][best])) then
        best = i
      end
    end
    if best == 0 or not (abs(columns[a][best]) > 1e-12) then return nil, 0 end
    held[best], product = true, product * abs(columns[a][best])
    for b = a + 1, #columns do
      local factor = columns[b][best] / columns[a][best]
      for i = 1, n do columns[b][i] = columns[b][i] - factor * columns[a][i] end
    end
  end
  return held, product
end

-- all sets of m of the numbers 1 .. n, or the first CANDIDATES + 1 of them
local function sets_of(n, m)
  local out = {}
  local function grow(set, from, left)
    if #out > CANDIDATES then return end
    if left == 0 then
      local one = {}
      for i in pairs(set) do one[i] = true end
      out[#out + 1] = one
      return
    end
    for i = from, n - left + 1 do
      set[i] = true
      grow(set, i + 1, left - 1)
      set[i] = nil
    end
  end
  grow({}, 1, m)
  return out
end

local function columns_at(J, m, n)
  local columns = {}
  for a = 1, m do
    columns[a] = {}
    for i = 1, n do columns[a][i] = J[i][a] end
  end
  return columns
end

-- theta with (g . at)_i = value[i] for the coordinates that are held, by Newton's method; nothing
-- where there is none near
local function solve(orbit, m, n, held, value, theta)
  theta = core.vector(theta)
  for round = 1, MOST do
    local q, J, A, rest = orbit(theta), orbit:jacobian(theta), {}, {}
    for i = 1, n do
      if held[i] then
        rest[#rest + 1], A[#A + 1] = q[i] - value[i], {}
        for a = 1, m do A[#A][a] = J[i][a] end
      end
    end
    local step, size = linear.solution(A, rest), 0
    if not step then return nil end
    for a = 1, m do theta[a] = theta[a] - step[a]; size = max(size, abs(step[a])) end
    if not (size < 1e3) then return nil end
    if size <= 1e-15 * max(1, theta:norm()) then return theta end
    if size < 1e-12 and round == MOST then return theta end
  end
end

-- starts of theta: none, then an eighth of a turn further each, one angle after the other
local function start(m, try)
  local theta = {}
  for a = 1, m do theta[a] = try == 0 and 0 or (try * (2 * a - 1) % TURNS) * math.pi / 4 end
  return theta
end

-- is the slice a better than b: more coordinates at 0, none moved, then the one that the group
-- crosses most steeply, and the later coordinates
local function better(a, b)
  if not b then return true end
  if a.zeros ~= b.zeros then return a.zeros > b.zeros end
  if a.moved ~= b.moved then return b.moved end
  if abs(a.steep - b.steep) > 1e-6 * b.steep then return a.steep > b.steep end
  return a.rest > b.rest + 1e-9
end

-- the slice that holds the coordinates `held` at 0 where `mask` says so, at their value elsewhere
local function candidate(orbit, m, n, held, at, mask, least)
  local value, zeros, bit, best = {}, 0, 1, nil
  for i = 1, n do
    if held[i] then
      value[i] = mask & bit == 0 and 0 or at[i]
      zeros, bit = zeros + (value[i] == 0 and 1 or 0), bit << 1
    end
  end
  for try = 0, 2 * TURNS do
    local fine, theta = blame.try(solve, orbit, m, n, held, value, start(m, try))
    if fine and theta then
      local q, found = orbit(theta), { held = held, value = value, theta = theta, zeros = zeros,
        moved = theta:norm() > 1e-14, rest = 0 }
      local _, steep = M.moved_most(columns_at(orbit:jacobian(theta), m, n), n, held)
      for i = 1, n do found.rest = found.rest + (held[i] and 0 or q[i]) end
      found.steep, found.q = steep, q
      if steep > FLAT * least and better(found, best) then best = found end
      if not found.moved then break end
    end
  end
  return best
end

local function bits(mask)
  local count = 0
  while mask > 0 do count, mask = count + (mask & 1), mask >> 1 end
  return count
end

--- The slice through the orbit of `at`: held coordinates (a set), their values, the point of it on
-- the orbit, and theta with g . at = that point. Nothing where the group does not move `at` in all
-- its directions.
function M.through(move, m, n, at)
  at = core.vector(at)
  local orbit = core.trace(function(theta) return move(theta, at) end, m)
  local most, steep = M.moved_most(columns_at(orbit:jacobian(start(m, 0)), m, n), n)
  if not most then return nil end
  local sets, best = sets_of(n, m), nil
  if #sets > CANDIDATES then sets = { most } end
  for kept = 0, m <= 3 and m - 1 or 0 do  -- as few as will do are held elsewhere than at 0
    for _, held in ipairs(best and {} or sets) do
      for mask = 0, (1 << m) - 2 do
        local found = bits(mask) == kept and candidate(orbit, m, n, held, at, mask, steep)
        if found and better(found, best) then best = found end
      end
    end
  end
  if best then return best end
  local value = {}
  for i = 1, n do if most[i] then value[i] = at[i] end end
  return { held = most, value = value, q = at, theta = core.vector(start(m, 0)) }
end

return M
