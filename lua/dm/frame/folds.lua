--- Folds of a section, beside which orbits cut it twice: its angle with the orbits changes its sign
-- there. A band of such orbits may be narrow, and no sample meets it. So the section is followed
-- from the samples' points, towards lesser angles and beyond, and orbits beside folds are tried.
local blame = require "dm.base.blame"
local core = require "dm.core"
local curves = require "dm.frame.curve"
local groups = require "dm.group"
local kits = require "dm.group.kit"
local places = require "dm.action.points"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"

local M = {}

local abs, max, min = math.abs, math.max, math.min

local NODES = 250        -- of all curves
local MORE, OTHERS = 16, 100 -- points brought to the section by the shortest way; their seeds
local SIZES = { 0.3, 1, 3, 0.6 }
local DOWN, ON = 12, 4 -- nodes towards lesser angles, and of every turn after that
local ACROSS = 15      -- nodes both ways, where the section has several dimensions
local DIPS, DEEPER = 4, 0.7 -- nodes between nodes for the least angle, while it falls by so much
local HALVINGS = 8     -- towards a fold,
local JUMP, SEEN = 0.7, 4 -- where the sine has to fall by so much in the first of them
local TINY = 1e-3      -- of the algebra, for a second difference
local EDGES = 5        -- halvings towards the ends of a branch between two pieces of a section
local AIMS = 3         -- steps of Gauss and Newton from one piece to the other
local LONG = 10        -- of the algebra: what an orbit meets that far away is no neighbour

-- The least |sine| between nodes a, b, c of a curve, of which b has the least so far, by parabolas:
-- two nodes of unlike signs, or nothing.
local function dip(on, a, b, c)
  for _ = 1, DIPS do
    local p, q = (b.x - a.x):norm(), (c.x - b.x):norm()
    local left, right = (abs(b.sine) - abs(a.sine)) / p, (abs(c.sine) - abs(b.sine)) / q
    local bend, slope = 2 * (right - left) / (p + q), (left * q + right * p) / (p + q)
    local least = abs(b.sine) - slope ^ 2 / (2 * bend)
    if not (bend > 0 and least < DEEPER * abs(b.sine)) then return end
    local other, length = slope < 0 and c or a, slope < 0 and q or p
    local share = min(max(abs(slope / bend) / length, 0.05), 0.6)
    local m = curves.node(on, b.x + (other.x - b.x) * share, nil, length)
    if not m or not m.inside then return end
    if m.sine * b.sine < 0 then return b, m end
    local away = other == c and a or c
    if abs(m.sine) < abs(b.sine) then b, away = m, b else other = m end
    a, c = away, other
  end
end

-- Nodes of a curve until two are found between which the section folds, or leaves the branch and
-- comes back, which are returned; downhill: until |sine| grows.
local function follow(curve, count, downhill)
  while count > 0 or curve.outside > 0 do
    count = count - 1
    local one, two = curve.before, curve.at
    local three = curves.advance(curve)
    if not three then return end
    local both = three.inside and two.inside
    if both and three.sine * two.sine < 0 then return two, three end
    if two.inside and not three.inside then curve.left = { two, three } end
    if three.inside and not two.inside then return two, three, curve.left end
    local grows = abs(three.sine) > abs(two.sine)
    if both and one and one.inside and grows and abs(two.sine) < abs(one.sine) then
      local a, b = dip(curve.on, one, two, three)
      if a then return a, b end
    end
    if downhill and grows and three.inside then return end
  end
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
    local list, g = {}, h(t)
    for i, p in ipairs(z) do list[i] = places.image(frame.action, g, p) end
    return l:dot(core.vector(require("dm.frame").section(frame, list)))
  end
  local bend = (off(TINY) + off(-TINY)) / TINY ^ 2
  local t = -2 * l:dot(A * n) / bend
  return abs(t) < LONG and { h(t), h(2 * t) } or {}
end

-- orbits beside a fold between nodes a and b
local function try_orbits(on, a, b, tried)
  local least = min(abs(a.sine), abs(b.sine))
  for i = 1, HALVINGS do
    local m = curves.node(on, (a.x + b.x) / 2, nil, (b.x - a.x):norm())
    if not m then return end
    if m.sine * a.sine < 0 then b = m else a = m end
    if i == SEEN and min(abs(a.sine), abs(b.sine)) > JUMP * least then return end
    for _, at in ipairs(i % 2 == 0 and { a, b } or {}) do
      local fine, elements = blame.try(across, on.frame, at)
      if fine then tried(points.split(at.x, on.frame.k, on.frame.m), elements) end
    end
  end
end

-- nearer to where the branch ends between a node inside and one outside
local function edge(on, inside, outside)
  local m = curves.node(on, (inside.x + outside.x) / 2, nil, (inside.x - outside.x):norm())
  if m and m.inside then return m, outside end
  return inside, m or outside
end

-- the element that moves the points of a node as close as it can to those of another
local function towards(frame, at, goal)
  local kit, list = groups.kit(frame.group), points.split(at.x, frame.k, frame.m)
  local g, here = kit.identity(), list
  for _ = 1, AIMS do
    local psi = tangent.psi_at(frame, here)
    local down = psi:transpose()
    local y = (down * psi):solve(down * (goal.x - points.flat(here)))
    local size = y:norm()
    local h = kit.exp(tangent.along_basis(frame, size > 1 and y / size or y))
    g = frame.action.side == "right" and kit.compose(g, h) or kit.compose(h, g)
    here = {}
    for i, z in ipairs(list) do here[i] = places.image(frame.action, g, z) end
  end
  return g
end

-- orbits of both pieces of a section that leaves the branch after `left` and comes back at `back`
local function try_pieces(on, left, back, tried)
  local a, beyond = table.unpack(left)
  local before, b = table.unpack(back)
  for _ = 1, EDGES do
    for _, pair in ipairs { { a, b }, { b, a } } do
      local fine, h = blame.try(towards, on.frame, table.unpack(pair))
      if fine then tried(points.split(pair[1].x, on.frame.k, on.frame.m), { h }) end
    end
    a, beyond = edge(on, a, beyond)
    b, before = edge(on, b, before)
  end
end

-- what lies between two nodes of a curve
local function try_between(curve, a, b, left, tried)
  if left then return try_pieces(curve.on, left, { a, b }, tried) end
  curve.ended = true
  try_orbits(curve.on, a, b, tried)
end

-- a start's curves in both directions of one at random
local function set_out(on, start)
  local v = kits.normals(on.stream, on.nodes, on.n, 1)
  start.curves = { curves.curve(on, start.at, v), curves.curve(on, start.at, v * -1) }
end

local function go_on(start, count, tried)
  for _, curve in ipairs(start.curves) do
    local a, b, left = follow(curve, count)
    if a then try_between(curve, a, b, left, tried) end
  end
end

-- the first nodes of a start on a section that is a curve: where the angle becomes less
local function go_down(start, tried)
  local curve, other = table.unpack(start.curves)
  local a, b, left = follow(curve, 1)
  if not a then
    if abs(curve.at.sine) >= abs(start.at.sine) then curve = other end
    a, b, left = follow(curve, DOWN, true)
  end
  if a then try_between(curve, a, b, left, tried) end
end

--- Looks for folds. lists: points on the section. tried(list, elements) compares the frame of these
-- points with those of what the elements move.
function M.search(frame, lists, tried)
  local fine, on = blame.try(curves.on, frame)
  if not fine or on.free < 1 then return end
  local starts = {}
  on.stream = core.random(13)
  local function start(list, size)
    local at = curves.node(on, points.flat(list) * size, nil, 10 * size)
    if at and at.inside then starts[#starts + 1] = { at = at } end
  end
  for _, list in ipairs(lists) do start(list, 1) end
  for seed = 1, MORE do start(points.sample(frame, OTHERS + seed), SIZES[seed % #SIZES + 1]) end
  table.sort(starts, function(a, b) return abs(a.at.sine) < abs(b.at.sine) end)
  for round = 1, #starts > 0 and NODES or 0 do
    local spent = on.nodes
    for _, start in ipairs(starts) do
      if on.nodes > NODES then return end
      if round == 1 or on.free > 1 then set_out(on, start) end
      if on.free > 1 then
        go_on(start, ACROSS, tried)
      elseif round == 1 then
        go_down(start, tried)
      else
        go_on(start, ON, tried)
      end
    end
    if on.nodes == spent then return end
  end
end

return M
