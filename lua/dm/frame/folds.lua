--- Folds of a section, beside which orbits cut it twice: its angle with the orbits changes its sign
-- there. A band of such orbits may be narrow, and no sample meets it. So the section is followed
-- from the samples' points (core.section), and orbits beside folds are tried.
local blame = require "dm.base.blame"
local core = require "dm.core"
local groups = require "dm.group"
local places = require "dm.action.points"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"

local M = {}

local abs, min = math.abs, math.min

local NODES = 1200     -- of curves of each kind, by dim G
local MOST = 12        -- folds that are tried
local MORE, OTHERS = 16, 100 -- points brought to the section by the shortest way; their seeds
local SIZES = { 0.3, 1, 3, 0.6 }
local HALVINGS = 8     -- towards a fold,
local JUMP, SEEN = 0.7, 4 -- where the sine has to fall by so much in the first of them
local TINY = 1e-3      -- of the algebra, for a second difference
local EDGES = 5        -- halvings towards the ends of a branch between two pieces of a section
local AIMS = 3         -- steps of Gauss and Newton from one piece to the other
local LONG = 10        -- of the algebra: what an orbit meets that far away is no neighbour

-- a node of the section
local function node(level, x, step)
  local at, sine, inside = level:node(x, step)
  return at and { x = at, sine = sine, inside = inside }
end

-- Where the orbit of a node beside a fold meets the section again: section and orbit nearly agree
-- along n, and l Z(exp(t n) z) is a parabola in t. Elements that lead there, and as far beyond.
local function across(frame, at)
  local ones = {}
  for i = 1, frame.r do ones[i] = 1 + 0.1 * i end
  ones = core.vector(ones)
  local z = points.split(at.x, frame.k, frame.m)
  local A = tangent.transversality(frame, z)
  local n, l = A:solve(ones), A:transpose():solve(ones)
  n, l = n / n:norm(), l / l:norm()
  local function h(t) return groups.kit(frame.group).exp(tangent.along_basis(frame, n * t)) end
  local function off(t)
    local list = places.images(frame.action, h(t), z)
    return l:dot(core.vector(require("dm.frame").section(frame, list)))
  end
  local bend = (off(TINY) + off(-TINY)) / TINY ^ 2
  local t = -2 * l:dot(A * n) / bend
  return abs(t) < LONG and { h(t), h(2 * t) } or {}
end

-- nearer to where the branch ends between a node inside and one outside
local function edge(level, inside, outside)
  local m = node(level, (inside.x + outside.x) / 2, (inside.x - outside.x):norm())
  if m and m.inside then return m, outside end
  return inside, m or outside
end

-- the element that moves the points of a node as close as it can to those of another
local function towards(frame, level, at, goal)
  local kit, list = groups.kit(frame.group), points.split(at.x, frame.k, frame.m)
  local g, here = kit.identity(), at.x
  for aim = 1, AIMS do
    local y = level:approach(here, goal.x)
    local size = y:norm()
    local h = kit.exp(tangent.along_basis(frame, size > 1 and y / size or y))
    g = frame.action.side == "right" and kit.compose(g, h) or kit.compose(h, g)
    here = aim < AIMS and points.flat(places.images(frame.action, g, list))
  end
  return g
end

-- the orbit of each of two nodes beside the other one
local function try_pair(frame, level, a, b, tried)
  for _, pair in ipairs { { a, b }, { b, a } } do
    local fine, h = blame.try(towards, frame, level, table.unpack(pair))
    if fine then tried(points.split(pair[1].x, frame.k, frame.m), { h }) end
  end
end

-- half turns about every axis: where orbits have fewer dimensions, as those of points that meet,
-- the section passes through to their other side
local function half_turns(frame)
  local kit, out = groups.kit(frame.group), {}
  for i = 1, frame.r do
    local y = core.zeros(frame.r)
    y[i] = math.pi
    out[i] = kit.exp(tangent.along_basis(frame, y))
  end
  return out
end

-- where the sine jumps between nodes a and b, at a corner of the section, or where orbits have
-- fewer dimensions; far: nodes further away on both sides
local function try_jump(frame, level, a, b, far, tried)
  try_pair(frame, level, a, b, tried)
  for _, at in ipairs(far) do
    tried(points.split(at.x, frame.k, frame.m), half_turns(frame))
  end
end

-- orbits beside a fold between nodes a and b
local function try_orbits(frame, level, a, b, tried)
  local least, far = min(abs(a.sine), abs(b.sine)), { a, b }
  for i = 1, HALVINGS do
    local m = node(level, (a.x + b.x) / 2, (b.x - a.x):norm())
    if not m then return end
    if m.sine * a.sine < 0 then b = m else a = m end
    local jumps = i >= SEEN and min(abs(a.sine), abs(b.sine)) > JUMP * least
    if jumps then return try_jump(frame, level, a, b, far, tried) end
    for _, at in ipairs(i % 2 == 0 and { a, b } or {}) do
      local fine, elements = blame.try(across, frame, at)
      if fine then tried(points.split(at.x, frame.k, frame.m), elements) end
    end
  end
end

-- orbits of both pieces of a section that leaves the branch between nodes a and beyond and comes
-- back between before and b
local function try_pieces(frame, level, before, b, a, beyond, tried)
  for _ = 1, EDGES do
    try_pair(frame, level, a, b, tried)
    a, beyond = edge(level, a, beyond)
    b, before = edge(level, b, before)
  end
end

-- what lies between the points of a fold, or of two pieces
local function try_between(frame, level, list, tried)
  local nodes = {}
  for i, x in ipairs(list) do
    nodes[i] = node(level, x, 1 + x:norm())
    if not nodes[i] then return end
  end
  if #nodes == 2 then return try_orbits(frame, level, nodes[1], nodes[2], tried) end
  try_pieces(frame, level, nodes[1], nodes[2], nodes[3], nodes[4], tried)
end

-- { point, how far from it the section may be }: the lists', on the section, and others
local function starts_of(frame, lists)
  local out = {}
  for i, list in ipairs(lists) do
    local x = points.flat(list)
    out[i] = { x, 10 }
  end
  for seed = 1, MORE do
    local size = SIZES[seed % #SIZES + 1]
    out[#out + 1] = { points.flat(points.sample(frame, OTHERS + seed)) * size, 10 * size }
  end
  return out
end

--- Looks for folds. lists: points on the section. tried(list, elements) compares the frame of these
-- points with those of what the elements move.
function M.search(frame, lists, tried)
  local fine, level, dimension = blame.try(tangent.level, frame)
  if not fine or dimension < 1 then return end
  for _, list in ipairs(level:folds(starts_of(frame, lists), NODES // frame.r, MOST)) do
    try_between(frame, level, list, tried)
  end
end

return M
