--- Curves along a cross-section, node by node: steps along tangents, brought back to Z = 0 by the
-- shortest way. At every node the sine of the angle between section and orbits is known.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"

local M = {}


local abs, huge, max, min = math.abs, math.huge, math.max, math.min

local FAR = 100              -- how far out curves go
local SMALL = 0.1            -- points smaller than this count as so large
local FIRST, LONGEST, SHORTEST = 0.1, 0.25, 1e-3 -- steps, beside the size of the points
local TURN, STRAIGHT = 0.9, 0.98 -- cosines between tangents: shorter steps, longer ones
local LONGER, SHORTER = 1.6, 0.4
local GAP = 4                -- nodes outside of the branch

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

-- what must be > 0 at x: domain and branch
local function conditions(frame, x)
  local list, out = points.split(x, frame.k, frame.m), {}
  local domain = frame.action.domain
  for i, z in ipairs(domain and list or {}) do out[i] = domain(z) end
  local values = frame.branch and points.entries(frame.branch(table.unpack(list))) or {}
  return table.move(values, 1, #values, #out + 1, out)
end

--- What curves on the section of a frame need.
function M.on(frame)
  local n, bonds = frame.k * frame.m, bonds_of(frame)
  local count = #bonds(points.flat(points.sample(frame, 1)))
  local function equations(x)
    local out = require("dm.frame").section(frame, points.split(x, frame.k, frame.m))
    for _, bond in ipairs(count > 0 and bonds(x) or {}) do out[#out + 1] = bond end
    -- what cancels is compared with the trace beside 1
    for i = 1, #out do out[i] = 1 + out[i] end
    return out
  end
  local function inside(x) return conditions(frame, x) end
  local fine, traced = blame.try(core.trace, inside, n)
  return { frame = frame, n = n, free = n - frame.r - count, nodes = 0,
    equations = core.trace(equations, n), moved = tangent.moved(frame),
    conditions = (frame.branch or frame.action.domain) and (fine and traced or inside) or nil }
end

local function is_inside(on, x)
  local values = on.conditions and on.conditions(x)
  for i = 1, values and #values or 0 do
    if not (values[i] > 0) then return false end
  end
  return true
end

local function node(on, x, v, step)
  local at = {}
  at.x, at.sine, at.v = core.section_node(on.equations, on.moved, x, v, step)
  if not at.x or not (abs(at.sine) < huge) or v and not at.v then return nil end
  at.inside = is_inside(on, at.x)
  return at
end

--- The node beside x, which a step of that length in the direction v has led to; nothing where the
-- section is left. inside: do branch and domain hold there?
function M.node(on, x, v, step)
  on.nodes = on.nodes + 1
  local fine, at = blame.try(node, on, x, v, step)
  return fine and at or nil
end

local function size_of(at) return max(at.x:norm(), SMALL) end

--- A curve from a node in the direction of v: at is where it is, before the node before.
function M.curve(on, at, v)
  local first = M.node(on, at.x, v, 1)
  return { on = on, at = at, v = first and first.v, step = FIRST * size_of(at), outside = 0,
    ended = not first }
end

--- One node further; nothing where the curve ends.
function M.advance(c)
  local shortest = SHORTEST * size_of(c.at)
  while not c.ended and c.step > shortest do
    local next = M.node(c.on, c.at.x + c.v * c.step, c.v, c.step)
    local turn = next and next.v:dot(c.v) or 0
    if turn > TURN then
      c.before, c.at, c.v = c.at, next, next.v
      c.outside = next.inside and 0 or c.outside + 1
      if turn > STRAIGHT then c.step = min(LONGER * c.step, LONGEST * size_of(next)) end
      c.ended = not (next.x:norm() < FAR and c.outside <= GAP)
      return next
    end
    c.step = SHORTER * c.step
  end
  c.ended = true
end

return M
