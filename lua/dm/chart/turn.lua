--- How a group turns coordinates: rotations of the plane or of space, the same for every block of
-- coordinates, or shifts of coordinates that L does not depend on.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local fail = require "dm.base.options".failing "dm.chart"
local sin, cos, sqrt, acos, max, min = math.sin, math.cos, math.sqrt, math.acos, math.max, math.min

local function product(A, B)
  local out = {}
  for i = 1, #A do
    out[i] = {}
    for j = 1, #A do
      local sum = 0
      for k = 1, #A do sum = sum + A[i][k] * B[k][j] end
      out[i][j] = sum
    end
  end
  return out
end

-- y with a matrix applied to every block of its coordinates
local function apply(R, y)
  local d, out = #R, {}
  for from = 0, #y - d, d do
    for i = 1, d do
      local sum = 0
      for k = 1, d do sum = sum + R[i][k] * y[from + k] end
      out[from + i] = sum
    end
  end
  return out
end

local PLANE = { { { 0, -1 }, { 1, 0 } } }
local SPACE = { { { 0, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } },
  { { 0, 0, 1 }, { 0, 0, 0 }, { -1, 0, 0 } }, { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 0 } } }

-- the rotation by a vector of angles about the generators
local function rotation(angles)
  if #angles == 1 then
    local c, s = cos(angles[1]), sin(angles[1])
    return { { c, -s }, { s, c } }
  end
  local x, y, z = angles[1], angles[2], angles[3]
  local size = sqrt(x * x + y * y + z * z)
  local K = { { 0, -z, y }, { z, 0, -x }, { -y, x, 0 } }
  local K2, out = product(K, K), {}
  local a = size > 0 and sin(size) / size or 1
  local b = size > 0 and (1 - cos(size)) / size ^ 2 or 0.5
  for i = 1, 3 do
    out[i] = {}
    for j = 1, 3 do out[i][j] = (i == j and 1 or 0) + a * K[i][j] + b * K2[i][j] end
  end
  return out
end

local function rotations(generators)
  local R, sum = rotation(#generators == 1 and { 0 } or { 0, 0, 0 }), 0
  local turns = {}
  for g, X in ipairs(generators) do turns[g] = function(y) return apply(X, y) end end
  return { turns = turns,
    turned = function(step)
      local angles = {}
      for g = 1, #generators do angles[g] = step[2 + g] end
      R, sum = product(rotation(angles), R), sum + angles[1]
      return function(y) return apply(R, y) end
    end,
    angle = function()
      if #generators == 1 then return sum end
      return acos(max(-1, min(1, (R[1][1] + R[2][2] + R[3][3] - 1) / 2)))
    end }
end

-- shifts of the coordinates of these numbers
local function shifts(numbers, n)
  local by, turns = core.zeros(n):totable(), {}
  for g, k in ipairs(numbers) do
    turns[g] = function()
      local out = core.zeros(n):totable()
      out[k] = 1
      return out
    end
  end
  return { turns = turns,
    turned = function(step)
      for g, k in ipairs(numbers) do by[k] = by[k] + step[2 + g] end
      return function(y, is_rate)
        if is_rate then return y end
        local out = {}
        for k, x in ipairs(y) do out[k] = x + by[k] end
        return out
      end
    end,
    angle = function()
      local worst = 0
      for _, k in ipairs(numbers) do
        if math.abs(by[k]) > math.abs(worst) then worst = by[k] end
      end
      return worst
    end }
end

-- does L stay the same when all blocks of q and v are turned?
local function keeps(system, options, R)
  local q, v = options.q, options.v
  if not v or #q % #R ~= 0 then return false end
  local given, t = system.given, options.t0 or 0
  local function L(x, y)
    return given.L(core.vector(x), core.vector(y), t, given.params)
  end
  local fine, a, b = blame.try(function() return L(q, v), L(apply(R, q), apply(R, v)) end)
  return fine and math.abs(a - b) <= 1e-9 * (math.abs(a) + math.abs(b) + 1e-300)
end

--- The turns that a system knows: cyclic coordinates shifted, else rotations of all blocks of two
-- or three coordinates; raises where it has none. A fresh one for every run.
function M.of(system, options)
  if system.place then
    fail("error = \"precession\" turns coordinates: on a group take \"position\", \"phase\" or an "
      .. "angle of yours, error = function(g) ... end")
  end
  local numbers, names = {}, system.coordinates
  for _, name in ipairs(system:structure().cyclic) do
    for i = 1, system.Q.dimension do
      if name == (names and names[i] or "q" .. i) then numbers[#numbers + 1] = i end
    end
  end
  if #numbers > 0 then
    return function() return shifts(numbers, system.Q.dimension) end
  end
  if system.given.L then
    if keeps(system, options, rotation { 0.7 }) then
      return function() return rotations(PLANE) end
    end
    if keeps(system, options, rotation { 0.7, -0.4, 0.5 }) then
      return function() return rotations(SPACE) end
    end
  end
  fail("error = \"precession\": L has no cyclic coordinate, and rotations of its coordinates by "
    .. "twos or threes change it: there is no group that could turn the motion")
end

return M
