--- Derivatives of moving frames, on numbers (Bogfjellmo thm 3, 4 and 12). With J = dZ and psi, the
-- generators as columns, both at I = rho(z) z:
--   T rho at I = -(J psi)^-1 J,   T iota = (1 - psi (J psi)^-1 J) T Psi_rho
--   d/dx I_K = I_K,x + psi_K C,   C = -(J psi)^-1 J I_x
--   S(I) = P . I with the shifted points, P = rho(S z) rho(z)^-1 = rho(iota(S z))
local blame = require "dm.base.blame"
local core = require "dm.core"
local linear = require "dm.base.linear"
local points = require "dm.frame.points"


local M = { docs = {}, CONDITION = 1e10 } -- of J psi: beyond it the frame turns on round-off

local abs, max = math.abs, math.max

---- J, psi, T Psi ----

local function slope_of_section(frame)
  local F = require "dm.frame"
  frame.slope = frame.slope or core.derivative(function(x)
    local value = F.section(frame, F.split(x, frame.k, frame.m))
    -- what cancels is compared with the trace beside 1
    for i = 1, #value do value[i] = 1 + value[i] end
    return core.vector(value)
  end, frame.k * frame.m)
  return frame.slope
end

--- dZ at the points of the frame, r x (k m)
function M.section_slope(frame, list)
  return slope_of_section(frame)(require "dm.frame".flat { table.unpack(list, 1, frame.k) })
end

-- r x (count m), zero behind the points of the frame
local function J_at(frame, list)
  local F = require "dm.frame"
  local given = slope_of_section(frame)(F.flat { table.unpack(list, 1, frame.k) })
  local columns, out = #list * frame.m, {}
  for i = 1, frame.r do
    out[i] = {}
    for j = 1, columns do out[i][j] = j <= frame.k * frame.m and given[i][j] or 0 end
  end
  return core.matrix(out)
end

-- by the directions of frame.basis, where the frame is one up to isotropy
local function psi_at(frame, list)
  local rows, basis = {}, frame.basis
  for _, z in ipairs(list) do
    local v = frame.action:generator(z)
    for i = 1, frame.m do
      local row = {}
      for j = 1, frame.r do row[j] = basis and v[i]:dot(basis[j]) or v[i][j] end
      rows[#rows + 1] = row
    end
  end
  return core.matrix(rows)
end

local function slope_of_action(frame)
  local G = frame.group
  if not frame.motion then
    frame.width = #points.entries(G:flat(G:identity()))
    frame.motion = core.derivative(function(y, z)
      local out = require "dm.action".move(frame.action, G:unflat(y), z)
      return core.vector(points.entries(out))
    end, frame.width, frame.m)
  end
  return frame.motion
end

-- T Psi_g at every point, a block each, applied to tangent vectors w (one for each point)
local function push(frame, g, list, w)
  local slope, y, out = slope_of_action(frame), core.vector(points.entries(frame.group:flat(g))), {}
  for i, z in ipairs(list) do
    local D, v = slope(y, z), {}
    for a = 1, frame.m do
      v[a] = 0
      for b = 1, frame.m do v[a] = v[a] + D[a][frame.width + b] * w[i][b] end
    end
    out[i] = core.vector(v)
  end
  return out
end
M.push = push

-- sum of squares of the entries
local function size(A, rows, columns)
  local sum = 0
  for i = 1, rows do
    for j = 1, columns do sum = sum + A[i][j] ^ 2 end
  end
  return math.sqrt(sum)
end

--- J psi of the cross-section at these very points, and its condition number in the norm of
-- Frobenius; or, if that is larger, how much the frame turns for a relative change of the points,
-- |(J psi)^-1| |J| |z|: near a fixed point psi itself vanishes. Third |(J psi)^-1|.
function M.transversality(frame, list)
  local first = { table.unpack(list, 1, frame.k) }
  local J, r = J_at(frame, first), frame.r
  local A = J * psi_at(frame, first)
  local fine, inverse = blame.try(function() return A:inverse() end)
  local condition, size_of_inverse = math.huge, math.huge
  if fine then
    local turns = size(J, r, frame.k * frame.m) * require("dm.frame").flat(first):norm()
    size_of_inverse = size(inverse, r, r)
    condition = size_of_inverse * math.max(size(A, r, r) / r, turns)
  end
  if condition ~= condition then condition = math.huge end
  return A, condition, size_of_inverse
end

--- How far the points are from the section, as the length of the algebra vector (J psi)^-1 Z that
-- would bring them there: a measure that does not depend on how the section is written. Also the
-- condition number of J psi, and |(J psi)^-1|. Z: the section there, a list.
function M.distance(frame, list, Z)
  local A, condition, size_of_inverse = M.transversality(frame, list)
  if not (condition < M.CONDITION) then return math.huge, condition, math.huge end
  return A:solve(core.vector(Z)):norm(), condition, size_of_inverse
end

--- The distance that a frame may leave: round-off at this condition number, far from what a wrong
-- one does.
function M.allowed(condition) return max(1e-8, 1e-14 * condition) end

local RANK = 1e-9 -- of psi: pivots below it are round-off

-- the dimension of the orbits at general points: the rank of psi
local function orbit_dimension(frame)
  local rows = psi_at(frame, points.sample(frame, 1)):totable()
  local most = math.min(#rows, frame.r)
  local chosen, rank = linear.choose_rows(rows, most, RANK)
  return chosen and most or rank
end

local SAMPLES = 6  -- of general points; what is singular at all of them is singular everywhere

--- Does the section cross the orbits anywhere? Where J psi is singular at general points, and on
-- the section, it is everywhere: an error. on_section(frame): points there, or nothing.
function M.check_orbits(frame, on_section)
  local enough, seen = frame.k * frame.m >= frame.r, 0
  for seed = 1, enough and SAMPLES or 0 do
    local fine, _, condition = blame.try(M.transversality, frame, points.sample(frame, seed))
    if fine and condition < M.CONDITION then return end
    seen = seen + (fine and 1 or 0)
  end
  if enough and seen < SAMPLES then return end
  local dimension = orbit_dimension(frame)
  local there = dimension == frame.r and on_section(frame)
  local _, condition = nil, math.huge
  if there then _, condition = M.transversality(frame, there) end
  if not (condition < M.CONDITION) then require "dm.frame.text".refuse(frame, dimension) end
end

---- what comes of them ----

--- C, d/dx of the invariants, I_x: of points and their velocities
function M.derivative_correction(frame, list, velocities)
  local F = require "dm.frame"
  local g = F.element(frame, list)
  local there, moving = F.moved(frame, g, list), push(frame, g, list, velocities)
  local J, psi = J_at(frame, there), psi_at(frame, there)
  local C = -((J * psi):solve(J * F.flat(moving)))
  local change = F.flat(moving) + psi * C
  return C, F.split(change, #list, frame.m), moving
end

--- T iota, (count m) x (count m)
function M.tangent(frame, list)
  local count, m, columns = #list, frame.m, {}
  for i = 1, count do
    for a = 1, m do
      local w = {}
      for j = 1, count do
        local v = {}
        for b = 1, m do v[b] = (i == j and a == b) and 1 or 0 end
        w[j] = core.vector(v)
      end
      local _, change = M.derivative_correction(frame, list, w)
      columns[#columns + 1] = require "dm.frame".flat(change)
    end
  end
  return core.matrix(columns):transpose()
end

--- which entries of the normalized points do not vary: their values, or false
function M.phantom(frame, count)
  local out, values = {}, {}
  for seed = 1, 60 do
    local fine, list = blame.try(function()
      local z, F = points.sample(frame, seed, max(count, frame.k)), require "dm.frame"
      -- again from the section, where the frame is the identity and rounds least
      for _ = 1, 2 do z = F.moved(frame, F.element(frame, z), z) end
      return z
    end)
    if fine then values[#values + 1] = list end
    if #values == 2 then break end
  end
  if #values < 2 then error("rho:phantom: no frame was found at random points", 0) end
  for i = 1, count do
    out[i] = {}
    for j = 1, frame.m do
      local first, spread = values[1][i][j], 0
      for _, list in ipairs(values) do spread = max(spread, abs(list[i][j] - first)) end
      out[i][j] = spread < 1e-12 * (1 + abs(first)) and (abs(first) < 1e-15 and 0 or first)
    end
  end
  return out
end

-- largest |a - b| over lists of points, NaN when there is one; entries of `angles` by the circle
local function apart(a, b, angles)
  local worst = 0
  for i = 1, #a do
    for j = 1, #a[i] do
      local d = a[i][j] - b[i][j]
      d = angles and angles[j] and 2 * abs(math.sin(d / 2)) or abs(d)
      if not (d <= worst) and worst == worst then worst = d end
    end
  end
  return worst
end
M.apart = apart

-- d/dx of the invariants through the graph of the whole, frame included
local function through_the_graph(frame, list, velocities)
  local F = require "dm.frame"
  local key = #list
  frame.whole = frame.whole or {}
  frame.whole[key] = frame.whole[key] or core.derivative(function(x)
    local z = F.split(x, key, frame.m)
    return F.flat(F.moved(frame, F.element(frame, z), z)):map(function(w) return 1 + w end)
  end, key * frame.m)
  return F.split(frame.whole[key](F.flat(list)) * F.flat(velocities), key, frame.m)
end

--- defects of the identities between invariants, their shifts and derivatives
function M.syzygies(frame, list, velocities)
  local F = require "dm.frame"
  local g = F.element(frame, list)
  local there = F.moved(frame, g, list)
  local P = F.element(frame, { table.unpack(there, 2, frame.k + 1) })
  local shifted = { table.unpack(list, 2) }
  local left = F.moved(frame, F.element(frame, shifted), shifted)
  local right = F.moved(frame, P, { table.unpack(there, 2) })
  local out = core.result { shift = apart(left, right, frame.action.angles) }
  if velocities then
    local _, change = M.derivative_correction(frame, list, velocities)
    out.derivative = apart(change, through_the_graph(frame, list, velocities))
  end
  return out
end

M.docs.transversality = [[
rho:transversality(z1, ..., zk) -> dm.matrix, number
J psi (r x r) at these points, and its condition number: J the derivative of the cross-section, psi
the generators of the action. A frame exists near points of the section where it is regular.]]
M.docs.tangent = [[
rho:tangent(z1, ..., zn) -> dm.matrix
The derivative of the normalized points in the points, T iota = (1 - psi (J psi)^-1 J) T Psi_rho
(Bogfjellmo thm 3), n dim M x n dim M.]]
M.docs.correction = [[
rho:correction(z1, ..., zk+1) -> group element
Of one point more than the frame is made of, since it compares the frame of the first k points with
that of the last k: P = rho(z2, ..., zk+1) rho(z1, ..., zk)^-1, as the frame of the normalized
points (Bogfjellmo thm 12): S(I) = P . I.]]
M.docs.derivative_correction = [[
rho:derivative_correction(points, velocities) -> C, changes, moved
How invariants change when the points move with these velocities: C = -(J psi)^-1 J I_x (dim G
numbers), d/dx I_j = I_j,x + psi C (a vector for each point), and I_x, the velocities moved by the
frame (Bogfjellmo thm 4).]]
M.docs.syzygies = [[
rho:syzygies(points [, velocities]) -> {shift, derivative}
Defects of the relations between invariants at k + 1 points or more: of S(I_J) = P . I_J1, and with
velocities of the formula for d/dx I against the derivative of the graph. Round-off, where the frame
is one.]]
M.docs.phantom = [[
rho:phantom([n]) -> list of lists
For the n (default k) normalized points: the value of each entry that is the same everywhere, false
for one that varies.]]

return M
