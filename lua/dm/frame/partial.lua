--- Frames up to isotropy, where the action is not free: the section (a slice) has as many equations
-- as the orbits have dimensions, and rho(z) = exp(xi) with xi in a complement of the isotropy
-- algebra of the section's points, frame.basis. rho(h z) h = k rho(z) with k that leaves the
-- section's point.
local core = require "dm.core"
local blame = require "dm.base.blame"
local linear = require "dm.base.linear"
local options = require "dm.base.options"
local points = require "dm.frame.points"
local text = require "dm.frame.text"

local M = {}


local fail = options.failing "dm.moving_frame"

local RANK = 1e-9     -- of generators, relative
local SAME = 1e-6     -- angle between isotropy algebras that are one
local STEPS = 60      -- towards the section
local TRIES = 12
local FARTHEST = 14   -- size of a root: up to 16 exp of symbols has all its digits

-- generators of all points, a row each, as a matrix
local function generators(frame, list)
  local rows = {}
  for i = 1, frame.k do
    local psi = frame.action:generator(list[i])
    for j = 1, frame.m do rows[#rows + 1] = psi[j]:totable() end
  end
  return core.matrix(rows)
end

-- vectors of the algebra that do not move the points, and those orthogonal to them
local function split_algebra(frame, list)
  local values, vectors = linear.singular_values(generators(frame, list))
  local largest, still, moving = 0, {}, {}
  for _, s in ipairs(values) do largest = math.max(largest, s) end
  for i, s in ipairs(values) do
    table.insert(s <= RANK * largest and still or moving, vectors[i])
  end
  return still, moving
end

--- What a section with too few equations hears: how large the isotropy is.
function M.advice(frame)
  local fine, still = blame.try(split_algebra, frame, points.sample(frame, 1))
  if not fine or #still == 0 then return "" end
  return (" (the points have an isotropy group of dimension %d: take more points, or a frame up to "
    .. "isotropy, partial = true, with %d equations)"):format(#still,
      frame.group.dimension - #still)
end

-- points on the section from sample `seed`, by Newton steps of least length; nothing where they
-- fail
local function on_section(frame, section, seed)
  local list, o = points.sample(frame, seed), nil
  local f = core.derivative(function(x) return core.vector(section(frame, points.split(x, frame.k,
    frame.m))) end, frame.k * frame.m)
  for _ = 1, STEPS do
    local Z = core.vector(section(frame, list))
    o = #Z
    if Z:norm() < 1e-12 then return list end
    local slope = f(points.flat(list))
    if o == 1 and not slope.rows then slope = core.matrix { slope:totable() } end
    local A = slope * generators(frame, list)
    local AAT = A * A:transpose()
    local fine, y = blame.try(AAT.solve, AAT, Z)
    if not fine then return nil end
    local xi = A:transpose() * y * -1
    local size = xi:norm()
    local g = frame.group:exp(size > 0.5 and xi * (0.5 / size) or xi)
    for i = 1, frame.k do list[i] = frame.action.map(g, list[i]) end
  end
end

-- is the branch kept at these points?
local function is_inside(frame, list)
  if not frame.branch then return true end
  local fine, values = blame.try(function()
    return points.entries(frame.branch(table.unpack(list)))
  end)
  for i = 1, fine and #values or 0 do
    if not (values[i] > 0) then return false end
  end
  return fine
end

-- how far v lies outside of the span of an orthonormal list
local function outside(v, list)
  for _, w in ipairs(list) do v = v - w * v:dot(w) end
  return v:norm()
end

-- as many equations as the orbits of general points have dimensions
local function check_count(frame, section)
  local list = points.sample(frame, 1)
  local _, moving = split_algebra(frame, list)
  local fine, value = blame.try(section, frame, list)
  if fine and #value ~= #moving then
    fail("partial: the orbits have dimension %d, so the cross-section must give %d numbers (it "
      .. "gives "
      .. "%d)", #moving, #moving, #value)
  end
end

--- The directions frame.basis along which points are brought to the section; frame.r is then how
-- many there are. Raises where the isotropy changes along the section.
function M.prepare(frame, section)
  local found, basis = nil, nil
  check_count(frame, section)
  for seed = 1, TRIES do
    local fine, list = blame.try(on_section, frame, section, seed)
    if fine and list and is_inside(frame, list) then
      local still, moving = split_algebra(frame, list)
      if found and #found ~= #still then
        fail("partial: points of the section have isotropy groups of dimension %d and %d", #found,
          #still)
      end
      for _, v in ipairs(found or {}) do
        if outside(v, still) > SAME then
          fail("partial: the isotropy group changes along the section: choose a section whose "
            .. "points "
            .. "all have the same one")
        end
      end
      found, basis = found or still, basis or moving
    end
  end
  if not basis then fail("partial: no point of the section was found") end
  if #found > 0 then frame.basis, frame.r = basis, #basis end
end

--- The directions in which the root is looked for by exp: frame.basis, or all of the algebra where
-- the flat coordinates of the group have relations that it cannot name (groups of one's own).
function M.chart(frame)
  if frame.basis then return frame.basis end
  local out = {}
  for i = 1, frame.r do out[i] = linear.unit(frame.r, i) end
  return out
end

-- sum y_i b_i
local function algebra(chart, y)
  local sum = chart[1] * y[1]
  for i = 2, #chart do sum = sum + chart[i] * y[i] end
  return sum
end

--- The element that a root y stands for.
function M.element(frame, y) return frame.group:exp(algebra(frame.chart, y)) end

local TURNS = { 1.6, -1.6, 0.7, -0.7, 2.8, -2.8 }

-- where Newton's method begins: nothing, turns about every direction and about their sums
local function beginnings(n)
  local out = { core.zeros(n):totable() }
  for _, angle in ipairs(TURNS) do
    for j = 1, n do
      local y = core.zeros(n):totable()
      y[j] = angle
      out[#out + 1] = y
      y = core.zeros(n):totable()
      y[j], y[j % n + 1] = angle * 0.7, -angle * 0.7
      out[#out + 1] = y
    end
  end
  return out
end

-- a start that is given: flat coordinates, or a function of the points that gives an element
local function begin_at(frame, start)
  if start == nil then return beginnings(#frame.chart) end
  if frame.basis then fail("option 'start' does not go with partial = true") end
  local G = frame.group
  if type(start) ~= "function" then return points.entries(G:log(G:unflat(start))) end
  start = core.one(start, "start")
  return function(z)
    return points.entries(G:log(start(table.unpack(points.split(z, frame.k, frame.m)))))
  end
end

--- The root y of Z(exp(y . chart) z) = 0.
function M.root(frame, start, moved, section, branch_values, least)
  local k, m = frame.k, frame.m
  local function at(y, z) return moved(frame, M.element(frame, y), points.split(z, k, m)) end
  return core.root { name = text.name(frame), start = begin_at(frame, start),
    failure = text.advice,
    equations = function(y, z) return section(frame, at(y, z)) end,
    branch = function(y, z)
      local values = branch_values(frame, at(y, z))
      values[#values + 1] = FARTHEST ^ 2 - core.vector(y):dot(core.vector(y))
      return least(values)
    end }
end

--- Raises for what needs a frame that is one for sure.
function M.refuse(frame, what)
  if frame.basis then
    error(what .. ": this frame is one up to isotropy (partial = true), so it has no derivative of "
      .. "its own; its invariants have", 0)
  end
end

return M
