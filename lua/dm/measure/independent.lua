--- Constraints that depend on the others, everywhere and not in one position only, left out.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local starts = require "dm.base.start"

local M = {}

local abs, sqrt, max = math.abs, math.sqrt, math.max
local entries = lists.entries

local WHERE = "system:independent"
local fail = option.failing(WHERE)

local KNOWN = { "q", "t" }
local DEPENDENT = 1e-13      -- of the square of a row: as at the start of a run
local ON = 1e-8              -- of the terms of a constraint: it holds there
local NEAR = { 0.05, -0.05, 0.013, -0.031, 0.11 }  -- of the size of q: how far away it is tried
local STEPS = 40             -- of Newton's method, back onto the constraints that are kept

-- system -> what is left out of it, a function of (q, t), and its numbers
local dropped = setmetatable({}, { __mode = "k" })

local function dot(a, b)
  local sum = 0
  for i = 1, #a do sum = sum + a[i] * b[i] end
  return sum
end

-- the numbers of the rows that are independent of those before them, and of the others
local function split_rows(G)
  local basis, kept, others = {}, {}, {}
  for i = 1, G.rows do
    local row, size = {}, 0
    for k = 1, G.columns do row[k] = G[i][k] size = max(size, abs(row[k])) end
    for k = 1, G.columns do row[k] = size > 0 and row[k] / size or 0 end
    local whole = dot(row, row)
    for _ = 1, 2 do
      for _, unit in ipairs(basis) do
        local along = dot(unit, row)
        for k = 1, #row do row[k] = row[k] - along * unit[k] end
      end
    end
    local left = dot(row, row)
    if left > DEPENDENT * whole then
      for k = 1, #row do row[k] = row[k] / sqrt(left) end
      basis[#basis + 1], kept[#kept + 1] = row, i
    else
      others[#others + 1] = i
    end
  end
  return kept, others
end

local function selected(list, rows)
  local out = {}
  for at, i in ipairs(rows) do out[at] = list[i] end
  return out
end

-- how far off the given rows are, the worst of them, beside the size of their terms
local function off(g, q, t, rows)
  local value, J, worst, which = g(q, t), g:jacobian(q, t), 0, nil
  for _, i in ipairs(rows) do
    local size = 1e-300
    for k = 1, #q do size = size + abs(J[i][k]) * (abs(q[k]) + q:norm() / #q) end
    local here = abs(value[i]) / size
    if not (here <= worst) then worst, which = here, i end
  end
  return worst, which
end

-- the point near q on the rows that are kept; nil where Newton's method does not settle
local function onto(g, q, t, kept)
  for _ = 1, STEPS do
    local value, J = g(q, t), g:jacobian(q, t)
    local rows = {}
    for at, i in ipairs(kept) do
      rows[at] = {}
      for k = 1, #q do rows[at][k] = J[i][k] end
    end
    local A = core.matrix(rows)
    local At = A:transpose()
    local move = At * (A * At):solve(core.vector(selected(value, kept)))
    q = q - move
    if not (move:norm() > 1e-15 * (q:norm() + 1e-300)) then break end
  end
  return off(g, q, t, kept) <= 1e-12 and q or nil
end

-- do the others hold wherever those do that are kept, near q and at other times? Else the number of
-- one that does not, by how much, and how far away; false: it cannot be told
local function follow(g, q, t, kept, others)
  local told, far = 0, q:norm() > 0 and q:norm() or 1
  for which, part in ipairs(NEAR) do
    local y = q + 0
    for k = 1, #q do y[k] = y[k] + part * far * math.cos(which * k + 0.3 * k * k) / sqrt(#q) end
    local fine, near = blame.try(onto, g, y, t + part, kept)
    if fine and near then
      told = told + 1
      local worst, row = off(g, near, t + part, others)
      if not (worst <= ON) then return row, worst, (near - q):norm() end
    end
  end
  return told < 2 and false or nil
end

local function check(system, options)
  option.check(options, KNOWN, WHERE, "{ q = }")
  option.need(options, "q", WHERE, "a position on the constraints")
  local given = system.given
  if not given.constraint then fail("this system has no constraint") end
  if system.place or system.field then
    fail("constraints on coordinates are looked at: on groups and meshes leave the one out that "
      .. "the start names")
  end
  local n, q = system.Q.dimension, starts.list(options.q, system, "q")
  if lists.count(q) ~= n then fail("option 'q' must be %d numbers (got %s)", n, lists.got(q)) end
  return core.vector(q), option.number(options, "t", WHERE, "a time", 0)
end

-- the system with the rows that are kept
local function with_rows(system, kept)
  local options = lists.copy(system.given)
  local all = options.constraint
  options.constraint = function(...) return selected(entries(all(...)), kept) end
  options.crossings = true -- runs are told where they take a way that those left out forbid
  return core.system(options)
end

local function independent(system, options)
  local q, t = check(system, options)
  local given = system.given
  local all = bound(given.constraint, given.params)
  local g = core.trace(function(x, time) return core.vector(entries(all(x, time))) end, #q,
    "number")
  local kept, others = split_rows(g:jacobian(q, t))
  if #others == 0 then return system, {} end
  local worst, row = off(g, q, t, others)
  if not (worst <= ON) then
    fail("constraint %d depends on those before it but does not hold at this q: they contradict "
      .. "each other, or q is off the constraints", row)
  end
  local which, by, far = follow(g, q, t, kept, others)
  if which then
    fail("constraint %d depends on those before it at this q only: %.2g away it is off by %.1e of "
      .. "its terms where those hold. A singular configuration: without it the system could move "
      .. "otherwise. Begin elsewhere, or write it so that gradients are independent (points on a "
      .. "line: c = a + s (b - a))", which, far, by)
  elseif which == false then
    fail("near this q no other point on the constraints was found, so that nothing can be told; "
      .. "give another one")
  end
  local out = with_rows(system, kept)
  dropped[out] = { g = g, rows = others }
  return out, others
end

class.method("dm.system", "independent", independent, [[
system:independent{q=, t=} -> system, list
The system without the constraints that follow from those before them, and their numbers: a doubled
one, the last bar of a frame that is rigid without it, the closing joint of a plane loop. They must
follow near q (and at other times) and not at q only: a row that is dependent in one position, as
the distance of the ends of a straight bar of three points, is needed there, and raises. Runs of the
new system whose rows have q are looked through: where a constraint that was left out no longer
holds they raise. Systems on coordinates; rolling constraints stay.]])

---- runs ----

--- Raises where a path has left a constraint that was left out of its system.
function M.look(system, path)
  local info = dropped[system]
  if not info or path.watched then return path end
  for i = 1, #path do
    local worst, row = off(info.g, path.q[i], path.t[i], info.rows)
    if not (worst <= 1e-6) then
      error(("constraint %d, which was left out as dependent (system:independent), does not hold "
        .. "at t = %.6g: off by %.1e of its terms; the constraints passed a singular configuration")
        :format(row, path.t[i], worst), 0)
    end
  end
  return path
end

return M
