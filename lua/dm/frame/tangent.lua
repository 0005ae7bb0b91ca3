--- Is a section transversal to the orbits? On numbers: J = dZ, psi the generators as columns, and
-- how far points are from the section.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = class.module(function() return require "dm.base.linear" end)
local points = require "dm.frame.points"


local M = { CONDITION = 1e10 } -- of J psi: beyond it the frame turns on round-off

local max = math.max

-- a function of the section and the action; a root has compared these with what was traced
local function traced(frame, f, ...)
  local lengths = { ... }
  lengths[#lengths + 1] = frame.root and "unchecked"
  return core.trace(f, table.unpack(lengths))
end

--- 1 + Z of the points x, one vector: what cancels is compared with the trace beside 1
function M.section(frame)
  frame.traced_section = frame.traced_section or traced(frame, function(x)
    local F = require "dm.frame"
    local value = F.section(frame, F.split(x, frame.k, frame.m))
    for i = 1, #value do value[i] = 1 + value[i] end
    return core.vector(value)
  end, frame.k * frame.m)
  return frame.traced_section
end

local function slope_of_section(frame)
  frame.slope = frame.slope or core.derivative(M.section(frame))
  return frame.slope
end

--- xi of the algebra from its entries along frame.basis
function M.along_basis(frame, y)
  if not frame.basis then return y end
  local xi = core.zeros(#frame.basis[1])
  for j = 1, frame.r do xi = xi + frame.basis[j] * y[j] end
  return xi
end

-- (y, x) -> the points x, one vector, moved by y in the algebra, to first order
local function moved(frame)
  local action, near = frame.action, require("dm.group").kit(frame.group).near
  local image = require("dm.action.points").image
  return traced(frame, function(y, x)
    local xi, list = M.along_basis(frame, y), points.split(x, frame.k, frame.m)
    local g = not action.generator_by and near(xi)
    for i, z in ipairs(list) do
      list[i] = g and image(action, g, z) or z + action:generator(z) * xi
    end
    return points.flat(list)
  end, frame.r, frame.k * frame.m)
end

--- dZ at the points of the frame, r x (k m)
function M.section_slope(frame, list)
  return slope_of_section(frame)(require "dm.frame".flat { table.unpack(list, 1, frame.k) })
end

--- r x (count m), zero behind the points of the frame
function M.J_at(frame, list)
  local F = require "dm.frame"
  local given = slope_of_section(frame)(F.flat { table.unpack(list, 1, frame.k) })
  local columns, rows = #list * frame.m, given.rows and given:totable() or { given:totable() }
  for _, row in ipairs(rows) do
    for j = frame.k * frame.m + 1, columns do row[j] = 0 end
  end
  return core.matrix(rows)
end

--- The generators at the points, by the directions of frame.basis where the frame is one up to
-- isotropy.
local function psi_at(frame, list)
  local rows, basis = {}, frame.basis
  for _, z in ipairs(list) do
    local v = frame.action:generator(z)
    for i, row in ipairs(v:totable()) do
      for j = 1, basis and frame.r or 0 do row[j] = v[i]:dot(basis[j]) end
      rows[#rows + 1] = basis and { table.unpack(row, 1, frame.r) } or row
    end
  end
  return core.matrix(rows)
end
M.psi_at = psi_at

---- the section against the orbits ----

-- equations of the space of the points, as |z| = 1
local function bonds_of(frame)
  local kit = kits.of(frame.action.on)
  return function(x)
    local out = {}
    for _, z in ipairs(points.split(x, frame.k, frame.m)) do
      for _, bond in ipairs(kit.bonds(kits.list_of(z))) do out[#out + 1] = bond end
    end
    return out
  end
end

-- conditions that must be > 0 at x: domain and branch
local function conditions(frame, x)
  local list, out = points.split(x, frame.k, frame.m), {}
  local domain = frame.action.domain
  for i, z in ipairs(domain and list or {}) do out[i] = domain(z) end
  local values = frame.branch and points.entries(frame.branch(table.unpack(list))) or {}
  return table.move(values, 1, #values, #out + 1, out)
end

-- conditions as a dm.function, as one of Lua where they cannot be traced, or nothing
local function inside_of(frame, n)
  if not (frame.branch or frame.action.domain) then return nil end
  local fine, made = blame.try(core.trace, function(x) return conditions(frame, x) end, n)
  if fine then return made end
  return function(x)
    local told, values = blame.try(conditions, frame, x)
    for i = 1, told and #values or 0 do
      if not (values[i] > 0) then return false end
    end
    return told
  end
end

-- The section as a level set (core.section), on the space of the points where that leaves room, and
-- how many dimensions it has: one kernel of Z, J and psi, for whatever looks at them.
local function level_of(frame)
  local n, bonds, Z = frame.k * frame.m, bonds_of(frame), M.section(frame)
  local count = #bonds(points.flat(points.sample(frame, 1)))
  local left = n - frame.r - count
  local function equations(x)
    local out = kits.list_of(Z(x))
    for _, bond in ipairs(bonds(x)) do out[#out + 1] = 1 + bond end
    return out
  end
  local F = count > 0 and left >= 0 and traced(frame, equations, n) or Z
  return core.section(F, moved(frame), inside_of(frame, n)), left
end

--- The dm.level_set of a frame, and its number of dimensions.
function M.level(frame)
  if not frame.level then frame.level, frame.left = level_of(frame) end
  return frame.level, frame.left
end

local function flat(frame, list)
  return points.flat(#list == frame.k and list or { table.unpack(list, 1, frame.k) })
end

--- J psi of the cross-section at these very points, and its condition number (level_set:cut).
function M.transversality(frame, list) return M.level(frame):cut(flat(frame, list)) end

--- How far the points are from the section, as the length of the algebra vector (J psi)^-1 Z that
-- would bring them there: a measure that does not depend on how the section is written. Also the
-- condition number of J psi, and |(J psi)^-1|. Z: the section there, a list.
function M.distance(frame, list, Z)
  local off, condition, size_of_inverse = M.level(frame):distance(flat(frame, list), Z)
  if not (condition < M.CONDITION) then return math.huge, condition, math.huge end
  return off, condition, size_of_inverse
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

return M
