--- Steps of a reduced run that jumped over a shape at which its mass d2R/dx'2 is singular: a pole
-- of the section or of the coordinates, through which no motion goes and behind which the rows mean
-- nothing. Looked for where the energy moves more than it does elsewhere in the same run: between
-- rows that are far apart the steps are run again.
local blame = require "dm.base.blame"
local core = require "dm.core"
local routh = require "dm.reduce.routh"

local M = {}

local abs, min, max = math.abs, math.min, math.max

local PARTS = 16        -- samples of a line before its least value is refined
-- change of energy in a step, of the energy's size: looked at where it is STANDS_OUT times the
-- middle one; looked at in any case; so large that the tangents at both ends are followed too
local TINY, LARGE, HUGE, STANDS_OUT = 1e-7, 1e-3, 0.1, 30
-- determinant of the mass, of the lesser one at both ends of a step: for a change that is tiny, and
-- that is large
local ZERO, SINGULAR = 1e-6, 1e-3
-- rows looked at; rows of which all are; rows run again, and their steps
local LOOKED_AT, FEW, AGAIN, LONGEST = 64, 2000, 8, 20000
M.LONGEST = LONGEST

--- The mass of the shape that a path is of at (x, t), or nothing.
function M.mass(path, x, t)
  local fine, G = blame.try(path.mass, path, x, t)
  return fine and G or nil
end

-- |det| of the mass, or nothing outside of the domain
local function determinant(path, x, t)
  local G = M.mass(path, x, t)
  local fine, det = blame.try(function() return G:det() end)
  return fine and abs(det) or nil
end

--- The least value on the line from a to b, and where: of value(x) between its ends, refined where
-- it dips below half of `ends`, the lesser one at both of them.
function M.least_between(value, a, b, ends)
  local function at_part(s) return value((1 - s) * a + s * b) or math.huge end
  local best, at = math.huge, 0
  for k = 1, PARTS - 1 do
    local now = at_part(k / PARTS)
    if now < best then best, at = now, k / PARTS end
  end
  local width = 1 / PARTS
  for _ = 1, best < ends / 2 and 20 or 0 do
    width = width / 2
    for _, s in ipairs { max(0, at - width), min(1, at + width) } do
      local now = at_part(s)
      if now < best then best, at = now, s end
    end
  end
  return best, (1 - at) * a + at * b
end

--- The shape at which the mass is singular on the line from a to b, if there is one; both ends are
-- regular.
function M.singular(path, a, b, t, share)
  local before, after = determinant(path, a, t), determinant(path, b, t)
  if not before or not after then return nil end
  local least, where = M.least_between(function(x) return determinant(path, x, t) end, a, b,
    min(before, after))
  if least <= (share or SINGULAR) * min(before, after) then return where end
end

--- The same for the step that ends in row i, in which the energy changed by so much: straight on,
-- and as the velocities at its ends lead.
function M.over(path, i, change)
  local a, b, t, dt = path.q[i - 1], path.q[i], path.t[i], path.t[i] - path.t[i - 1]
  local where = M.singular(path, a, b, t, change > LARGE and SINGULAR or ZERO)
  if where or change <= HUGE then return where end
  for side, x in ipairs { a, b } do
    local fine, v = blame.try(path.velocity, path, i - 2 + side)
    where = fine and M.singular(path, x, x + (side == 1 and dt or -dt) * v, t)
    if where then return where end
  end
end

local SAMPLES, AT_REST = 9, 1e-6

--- The size of energies on the first `rows` rows of a path (default all): that of the start and of
-- p.v there, or, from rest with energy 0, what p.v is in the middle of a few of them.
function M.energy_size(path, first, rows)
  local kinetic, last = {}, rows or #path
  for k = 0, SAMPLES - 1 do
    local i = 1 + k * (last - 1) // (SAMPLES - 1)
    local known, v = blame.try(path.velocity, path, i)
    kinetic[#kinetic + 1] = known and abs(v:dot(path.p[i])) or 0
  end
  local start = max(abs(first), kinetic[1])
  table.sort(kinetic)
  local middle = kinetic[#kinetic // 2 + 1]
  return start > AT_REST * middle and start or max(middle, 1e-300)
end

--- The first rows of a path.
function M.head(path, rows)
  local columns = {}
  for c, name in ipairs(path.columns) do
    local all = path:column(name)
    columns[c] = {}
    for i = 1, rows do columns[c][i] = all[i] end
  end
  return core.path { system = path.system, h = path.h, rule = path.rule,
    steps = math.floor((path.t[rows] - path.t[1]) / path.h + 0.5), columns = columns }
end

local LAST = 4 -- rows at the end of a run that failed which may have no energy

--- The energies at the rows of a path, but for the last ones that have none; nothing where it need
-- not keep one, or has recorded other things.
function M.energies(path, info)
  if path.watched or routh.is_driven(info) or not routh.is_autonomous(info) then return nil end
  local fine, E = blame.try(path.energy, path)
  for less = 1, fine and 0 or min(LAST, #path - 1) do
    fine, E = blame.try(function() return M.head(path, #path - less):energy() end)
    if fine then break end
  end
  return fine and E or nil
end

-- how much the energy moves in every step to a row, of its size
local function changes(path, info)
  local E, out = M.energies(path, info), {}
  if not E then return nil end
  local size = M.energy_size(path, E[1])
  for i = 2, #E do out[i - 1] = E[i] == E[i] and abs(E[i] - E[i - 1]) / size or math.huge end
  return out
end

-- rows to which the energy moved more than elsewhere, at most `most` of them, in their order, and
-- the changes; all rows of a short path that has no energy to keep
local function stand_out(path, info, most)
  local change, rows = changes(path, info), {}
  if not change then
    for i = 2, #path <= FEW and #path or 1 do rows[#rows + 1] = i end
    return rows
  end
  local sorted = { table.unpack(change, 1, min(#change, FEW)) }
  table.sort(sorted)
  local middle = sorted[#sorted // 2 + 1] or 0
  for i, e in ipairs(change) do
    if e > LARGE or e > TINY and e > STANDS_OUT * middle then rows[#rows + 1] = i + 1 end
  end
  table.sort(rows, function(a, b)
    local x, y = change[a - 1], change[b - 1]
    return x > y or x == y and a < b
  end)
  rows = { table.unpack(rows, 1, min(#rows, most)) }
  table.sort(rows)
  return rows, change
end

--- Rows of a path that are far apart between which the steps are looked at, in their order.
function M.suspects(path, info)
  local rows, change = stand_out(path, info, AGAIN)
  if change or path.steps <= FEW then return rows end
  return {}
end

-- is the mass the same everywhere? then it is singular nowhere
local function is_constant(path)
  local first = determinant(path, path.q[1], path.t[1])
  for k = 1, 8 do
    local i = 1 + k * (#path - 1) // 8
    local now = determinant(path, path.q[i], path.t[i])
    if not first or not now or abs(now - first) > 1e-12 * first then return false end
  end
  return true
end

--- The steps from row `first` to row `last` (left out: to where the run ended), all kept, or
-- nothing: too many, or none. A run that fails on the way gives what it had.
function M.again(path, run, first, last)
  local t0 = path.t[first]
  local steps = last and math.floor((path.t[last] - t0) / path.h + 0.5)
    or path.steps - math.floor((t0 - path.t[1]) / path.h + 0.5)
  if steps < 1 or steps > LONGEST then return nil end
  local fine, dense = blame.try(run,
    { q = path.q[first], p = path.p[first], t0 = t0, steps = steps })
  if not fine and type(dense) ~= "table" then return nil end
  return fine and dense or dense.path
end

--- The first of the steps of a path that were all kept that went over a singular mass, and where.
function M.first_over(path, info)
  if is_constant(path) then return nil end
  local rows, change = stand_out(path, info, LOOKED_AT)
  for _, i in ipairs(rows) do
    local where = M.over(path, i, change and change[i - 1] or 0)
    if where then return i, where end
  end
end

return M
