--- Cells of a formula. It passes to another one only where the operand of where, abs, sign, max or
-- min is zero (f:breaks); between these zeros it is analytic, and what it is off by is too: one
-- point tells of a cell, however far away and narrow that is. Cells are found along lines, on
-- which bounds say where no break can be zero, from points in cells that are known.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local points = require "dm.frame.points"

local M = {}

local abs, max, min = math.abs, math.max, math.min

local REACH = 2e3      -- how far lines are followed
local FINE = 1e-3      -- cells narrower than this, beside their distance, are passed over
local MOST = 60        -- points that are tried,
local LINES = 24       -- that are looked along
local TRIES = 4        -- points of each that may tell nothing
local SAME = 1e-6      -- of directions that are one

-- what the frame gives at the points x, one vector: the element, the section and its branch there
local function traced(frame)
  local F, kit = require "dm.frame", kits.of(frame.group)
  return core.trace(function(x)
    local list = points.split(x, frame.k, frame.m)
    local g = kit.element(frame.solution(table.unpack(list)))
    local out, there = kits.list_of(kit.entries(g)), F.moved(frame, g, list)
    table.move(F.section(frame, there), 1, frame.r, #out + 1, out)
    local branch = frame.branch and points.entries(frame.branch(table.unpack(there))) or {}
    return core.vector(table.move(branch, 1, #branch, #out + 1, out))
  end, frame.k * frame.m, "unchecked")
end

-- unit vectors along which breaks change at x, each once
local function directions(breaks, x)
  local fine, slopes = blame.try(breaks.jacobian, breaks, x)
  local out = {}
  for i = 1, fine and slopes.rows or 0 do
    local d = slopes[i] / slopes[i]:norm()
    local is_new = abs(d:norm() - 1) < SAME
    for _, other in ipairs(out) do is_new = is_new and 1 - abs(d:dot(other)) > SAME end
    if is_new then out[#out + 1] = d end
  end
  return out
end

-- which formula it is at x: the signs of the breaks
local function cell_of(breaks, x)
  local fine, values = blame.try(breaks, x)
  local signs = {}
  for i = 1, fine and #values or 0 do
    signs[i] = values[i] > 0 and "+" or values[i] < 0 and "-" or "0"
  end
  return fine and table.concat(signs)
end

-- points of an interval that are no further away than they need be
local PARTS = { 0.5, 0.1 }
local function inside(from, to)
  if from >= 0 then to = min(to, 2 * from + 1) else from, to = to, max(from, 2 * to - 1) end
  local out = {}
  for i, part in ipairs(PARTS) do out[i] = from + part * (to - from) end
  return out
end

-- breaks, and what must be > 0 for the formula and in the domain of the action, as one function of
-- the points; nothing where it is one formula
local function conditions(frame)
  local breaks, edges = traced(frame):breaks()
  local domain = frame.action.domain
  return breaks and core.trace(function(x)
    local out = kits.list_of(breaks(x))
    for _, edge in ipairs(edges and kits.list_of(edges(x)) or {}) do out[#out + 1] = edge end
    for _, z in ipairs(domain and points.split(x, frame.k, frame.m) or {}) do
      out[#out + 1] = domain(z)
    end
    return core.vector(out)
  end, frame.k * frame.m, "unchecked")
end

local search = {}
search.__index = search

-- The frame at the point x, if its cell is not told yet, which is searched from there in any case
function search:try(x)
  local cell = cell_of(self.breaks, x)
  local count = cell and self.tries[cell] or 0
  if not cell or count >= TRIES or self.tried >= MOST then return end
  if count == 0 then self.waiting[#self.waiting + 1] = x end
  self.tried, self.tries[cell] = self.tried + 1, count + 1
  if self.tell(points.split(x, self.k, self.m)) then self.tries[cell] = TRIES end
end

-- all cells that a line from x along d meets
function search:along(x, d)
  local clear = self.breaks:clear(x, d, REACH, FINE)
  for i = 1, #clear, 2 do
    for _, t in ipairs(inside(clear[i], clear[i + 1])) do self:try(x + d * t) end
  end
end

--- Looks for cells of the formula of a frame, from the points of the lists. tell(list) tries the
-- frame at points: is anything told there?
function M.search(frame, lists, tell)
  local kit = kits.of(frame.action.on)
  if kit.manifold or kit.coordinates ~= kit.dimension then return end
  local fine, breaks = blame.try(conditions, frame)
  if not (fine and breaks) then return end
  local self = setmetatable({ breaks = breaks, tell = tell, k = frame.k, m = frame.m,
    tries = {}, tried = 0, waiting = {} }, search)
  for _, list in ipairs(lists) do self:try(points.flat(list)) end
  local place, lines = 1, 0
  while self.waiting[place] do
    for _, d in ipairs(directions(breaks, self.waiting[place])) do
      lines = lines + 1
      if lines > LINES then return end
      self:along(self.waiting[place], d)
    end
    place = place + 1
  end
end

return M
