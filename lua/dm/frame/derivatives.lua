--- Derivatives of moving frames, on numbers (Bogfjellmo thm 3, 4 and 12). With J = dZ and psi, the
-- generators as columns, both at I = rho(z) z:
--   T rho at I = -(J psi)^-1 J,   T iota = (1 - psi (J psi)^-1 J) T Psi_rho
--   d/dx I_K = I_K,x + psi_K C,   C = -(J psi)^-1 J I_x
--   S(I) = P . I with the shifted points, P = rho(S z) rho(z)^-1 = rho(iota(S z))
local F = require "dm.frame"
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local partial = require "dm.frame.partial"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"

local M = {}

local abs, max = math.abs, math.max

local function method(name, f, doc) core.method("dm.frame", name, blame.caller(f), doc) end

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

--- C, d/dx of the invariants, I_x: of points and their velocities
function M.derivative_correction(frame, list, velocities)
  local g = F.element(frame, list)
  local there, moving = F.moved(frame, g, list), push(frame, g, list, velocities)
  local J, psi = tangent.J_at(frame, there), tangent.psi_at(frame, there)
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
      columns[#columns + 1] = F.flat(change)
    end
  end
  return core.matrix(columns):transpose()
end

-- a number of few digits, which rounding has moved by its last two bits at most
local function short(x)
  if abs(x) < 1e-15 then return 0 end
  local written = tonumber(("%.12g"):format(x))
  return abs(written - x) <= 0x1p-50 * abs(x) and written or x
end

--- which entries of the normalized points do not vary: their values, or false
function M.phantom(frame, count)
  local out, values = {}, {}
  for seed = 1, 60 do
    local fine, list = blame.try(function()
      local z = points.sample(frame, seed, max(count, frame.k))
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
      out[i][j] = spread < 1e-12 * (1 + abs(first)) and short(first)
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

-- d/dx of the invariants through the graph of the whole, frame included
local function through_the_graph(frame, list, velocities)
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

---- methods ----

method("transversality", function(self, ...)
  return tangent.transversality(self, F.points_of(self, F.listed(self, ...), self.k))
end, [[
rho:transversality(z1, ..., zk) -> dm.matrix, number
J psi (r x r) at these points, and its condition number: J the derivative of the cross-section, psi
the generators of the action. A frame exists near points of the section where it is regular.]])
method("tangent", function(self, ...)
  partial.refuse(self, "rho:tangent")
  return M.tangent(self, F.points_of(self, F.listed(self, ...), self.k))
end, [[
rho:tangent(z1, ..., zn) -> dm.matrix
The derivative of the normalized points in the points, T iota = (1 - psi (J psi)^-1 J) T Psi_rho
(Bogfjellmo thm 3), n dim M x n dim M.]])
method("correction", function(self, ...)
  partial.refuse(self, "rho:correction")
  local given = F.listed(self, ...)
  if #given == self.k then
    error(("rho:correction compares the frame of points 1 to %d with that of points 2 to %d, so "
      .. "it takes %d points (got %d)"):format(self.k, self.k + 1, self.k + 1, self.k), 0)
  end
  local z = F.points_of(self, given, self.k + 1)
  local there = F.moved(self, F.element(self, z), z)
  return F.element(self, { table.unpack(there, 2, self.k + 1) })
end, [[
rho:correction(z1, ..., zk+1) -> group element
Of one point more than the frame is made of, since it compares the frame of the first k points with
that of the last k: P = rho(z2, ..., zk+1) rho(z1, ..., zk)^-1, as the frame of the normalized
points (Bogfjellmo thm 12): S(I) = P . I.]])
method("derivative_correction", function(self, points, velocities)
  partial.refuse(self, "rho:derivative_correction")
  local z = F.points_of(self, points, self.k)
  local C, changes, there = M.derivative_correction(self, z, F.points_of(self, velocities, #z))
  return C, core.result(changes), core.result(there)
end, [[
rho:derivative_correction(points, velocities) -> C, changes, moved
How invariants change when the points move with these velocities: C = -(J psi)^-1 J I_x (dim G
numbers), d/dx I_j = I_j,x + psi C (a vector for each point), and I_x, the velocities moved by the
frame (Bogfjellmo thm 4).]])
method("syzygies", function(self, points, velocities)
  partial.refuse(self, "rho:syzygies")
  local z = F.points_of(self, points, self.k + 1)
  return M.syzygies(self, z, velocities and F.points_of(self, velocities, #z))
end, [[
rho:syzygies(points [, velocities]) -> {shift, derivative}
Defects of the relations between invariants at k + 1 points or more: of S(I_J) = P . I_J1, and with
velocities of the formula for d/dx I against the derivative of the graph. Round-off, where the frame
is one.]])
method("phantom", function(self, count)
  count = count or self.k
  if not lists.whole(count) or count < 1 or count > 100 then
    error("rho:phantom: the number of points must be a whole number from 1 to 100", 0)
  end
  return core.result(M.phantom(self, count))
end, [[
rho:phantom([n]) -> list of lists
For the n (default k) normalized points: the value of each entry that is the same everywhere, false
for one that varies.]])

return M
