--- What an animation shows of a path: the points of every row, the rods between them, bodies.
local blame = require "dm.base.blame"
local bodies_ = require "dm.show.animate.bodies"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local fail = option.failing "animate"

local M = {}

local MOST = 2000  -- points in a frame: more are not told apart

---- columns as coordinates ----

-- { {"x1", "y1"}, ... } from names that end alike: x, y, z with the same rest
local function by_letters(names)
  local has, out = {}, {}
  for _, name in ipairs(names) do has[name] = true end
  for _, name in ipairs(names) do
    local rest = name:match "^x([_%d]*)$"
    if rest and has["y" .. rest] then
      out[#out + 1] = { name, "y" .. rest, has["z" .. rest] and "z" .. rest or nil }
    end
  end
  return out[1] and out or nil
end

-- consecutive names in groups of d
local function grouped(names, d)
  local out = {}
  for i = 1, #names, d do out[#out + 1] = { table.unpack(names, i, i + d - 1) } end
  return out
end

-- how many coordinates q has, and { [i] = true } for angles beside two positions or more
local function coordinates(path)
  local own, angles = path.system.place, kits.of(path.system.Q).angles
  local n, others = own and own.size or path.system.Q.dimension, 0
  for i = 1, n do others = others + (angles[i] and 0 or 1) end
  return n, others > 1 and angles or {}
end

-- the columns that hold positions: those of q; of a run that watched, whatever it watched but the
-- energy
local function positions(path)
  local names, columns = {}, path.columns
  local last, angles = #columns - 1, {}
  if not path.watched then last, angles = coordinates(path) end
  for i = 1, last do
    if columns[1 + i] ~= "energy" and not angles[i] then names[#names + 1] = columns[1 + i] end
  end
  if #names == 0 then
    fail("this run recorded only what it watched, and that is no point; there are %s",
      table.concat(columns, ", "))
  end
  return names
end

-- without being told: x, y and z by name, else pairs, else triples; a single coordinate moves along
-- a line
local function chosen(path, dim)
  local names = positions(path)
  local found = by_letters(names)
  if found and not dim then return found end
  local n = #names
  if n == 1 and not dim then return { names } end
  -- they need not be coordinates: a plane of two of them
  if path.watched and not dim then return { { names[1], names[2] } } end
  if not dim then dim = n == 3 and 3 or n % 2 == 0 and 2 or n % 3 == 0 and 3 or nil end
  if not dim or n % dim ~= 0 then
    fail("%d coordinates (%s) are not points of the plane or of space: say where the points are "
      .. "with "
      .. "draw = function(q, t) return { points = { {x, y}, ... }, rods = { {1, 2}, ... } } end", n,
      table.concat(names, ", "))
  end
  return grouped(names, dim)
end

local function check_points(points)
  if type(points) ~= "table" or type(points[1]) ~= "table" then
    fail("option 'points' must be a list of pairs or triples of column names: { {\"x1\", \"y1\"}, "
      .. "{\"x2\", \"y2\"} }")
  end
  for i, names in ipairs(points) do
    if #names ~= #points[1] or #names < 2 or #names > 3 then
      fail("option 'points': point %d must have %s column names (got %d)", i, #points[1] == 3
        and "3" or "2", #names)
    end
  end
  return points
end

-- a function of the row that adds its coordinates to a list, the number of points, their dimension,
-- names of axes
local function from_columns(path, points)
  local columns, dim = {}, math.max(2, #points[1])
  for _, names in ipairs(points) do
    for k = 1, #names do columns[#columns + 1] = path:column(names[k]) end
    if #names == 1 then columns[#columns + 1] = false end
  end
  local function row(i, out)
    for k = 1, #columns do out[#out + 1] = columns[k] and columns[k][i] or 0 end
  end
  local axes = { points[1][1], points[1][2] or "", points[1][3] }
  if #points > 1 then axes = { "x", "y", dim == 3 and "z" or nil } end
  return row, #points, dim, axes
end

---- a user's own picture ----

-- the points of one drawing as numbers; how many there are, and their dimension
local function read_points(drawing, i, out)
  local points = type(drawing) == "table" and (drawing.points or drawing[1] and drawing) or nil
  if type(points) ~= "table" or #points == 0 then
    local got = option.got(drawing)
    if type(drawing) == "table" then
      got = type(points) == "userdata" and "points = a " .. option.got(points)
        or "a table without points"
    end
    fail("draw must return { points = { {x, y}, ... }, rods = { {1, 2}, ... } } (row %d: got %s)",
      i, got)
  end
  local dim
  for k, point in ipairs(points) do
    local fine, n = blame.try(function() return #point end)
    if not fine or n < 2 or n > 3 or dim and n ~= dim then
      fail("draw: point %d of row %d must be {x, y} or {x, y, z}%s", k, i,
        dim and (", with %d numbers as the first"):format(dim) or "")
    end
    dim = n
    for axis = 1, n do
      local x = point[axis]
      if type(x) ~= "number" then
        fail("draw: point %d of row %d holds a %s, not a number", k, i,
          type(x) == "userdata" and option.got(x) or type(x))
      end
      out[#out + 1] = x * 1.0
    end
  end
  return #points, dim
end

local function from_drawing(path, draw)
  if path.watched then
    fail("draw(q, t) needs q, but this run recorded only what it watched: leave 'watch' out, or "
      .. "use points = { {\"x\", \"y\"} }")
  end
  draw = option.single(draw, "draw")
  local drawing = draw(path.q[1], path.t[1])
  local count, dim = read_points(drawing, 1, {})
  local function row(i, out)
    local n, d = read_points(draw(path.q[i], path.t[i]), i, out)
    if n ~= count or d ~= dim then
      fail("draw gave %d points of %d coordinates in row 1, but %d of %d in row %d", count, dim, n,
        d, i)
    end
  end
  return row, count, dim, { "x", "y", dim == 3 and "z" or nil }, drawing.rods
end

---- rods ----

local function check_rods(rods, count)
  if type(rods) ~= "table" then
    fail("rods must be a list of pairs of points, { {1, 2}, ... } (got %s)", type(rods))
  end
  local out = {}
  for i, rod in ipairs(rods) do
    local pair = type(rod) == "table" and rod or {}
    for k = 1, 2 do
      local point = lists.whole(pair[k])
      if not point or point < 0 or point > count then
        fail("rod %d must be a pair of points from 1 to %d, or 0 for the origin", i, count)
      end
    end
    out[i] = { lists.whole(pair[1]), lists.whole(pair[2]) }
  end
  return out
end

-- distance of points a and b (0: the origin) in a list of coordinates that begins behind `at`
local function distance(xyz, at, a, b, dim)
  local sum = 0
  for axis = 1, dim do
    local x = a == 0 and 0 or xyz[at + (a - 1) * dim + axis]
    sum = sum + (x - xyz[at + (b - 1) * dim + axis]) ^ 2
  end
  return math.sqrt(sum)
end

--- Pairs of points whose distance stays over all frames: what a constraint holds together. 0 is the
-- origin.
function M.held(xyz, count, dim)
  local size, rods = count * dim, {}
  for a = 0, count - 1 do
    for b = a + 1, count do
      local length, stays = distance(xyz, 0, a, b, dim), true
      local i = 1
      while stays and i < #xyz // size do
        stays = math.abs(distance(xyz, i * size, a, b, dim) - length) <= 1e-7 * length
        i = i + 1
      end
      if stays and length > 0 then rods[#rods + 1] = { a, b } end
    end
  end
  return rods
end

---- bodies ----

-- the points of bodies behind those of `own`, a reader of other points or nothing; and the numbers
-- of the points that leave a trail
local function with_bodies(path, bodies, own)
  local count, trails = own and own.count or 0, {}
  for k = 1, count do trails[k] = k end
  for _, body in ipairs(bodies) do
    for k = 1, #body.points do trails[#trails + 1] = count + k end
    count = count + #body.points + #body.joints
    body.poses = {}
  end
  local function row(i, out, keep)
    if own then own.row(i, out) end
    local q, t = path.q[i], path.t[i]
    for _, body in ipairs(bodies) do
      local R, x = bodies_.add_pose(keep and body.poses or {}, body, q, t)
      bodies_.add_points(out, body, R, x)
    end
  end
  return row, count, trails
end

---- all of them ----

-- { row, count, dim, axes, rods or nil } of the points that are columns or drawn
local function plain_reader(path, options)
  local row, count, dim, axes, rods
  if options.draw then
    row, count, dim, axes, rods = from_drawing(path, options.draw)
  else
    row, count, dim, axes = from_columns(path, options.points and check_points(options.points)
      or chosen(path, options.dim))
  end
  return { row = row, count = count, dim = dim, axes = axes, rods = rods }
end

--- How to read a path: { row = function(i, out, keep), count, dim, axes, rods or nil, bodies,
-- trails = numbers of points or nil: all }; keep: rows go into the poses of the bodies.
function M.reader(path, options)
  local bodies, own, trails = bodies_.of(path, options), nil, nil
  if #bodies == 0 or options.draw or options.points then own = plain_reader(path, options) end
  local row, count = own and own.row, own and own.count
  if #bodies > 0 then
    if own and own.dim < 3 then fail "points beside bodies need three coordinates" end
    row, count, trails = with_bodies(path, bodies, own)
  end
  if count > MOST then
    fail("%d points in a frame are more than %d: pick some with 'points' or 'draw'", count, MOST)
  end
  local rods = options.rods or own and own.rods or #bodies > 0 and {} or nil
  return { row = row, count = count, dim = own and own.dim or 3,
    axes = own and own.axes or { "x", "y", "z" }, bodies = bodies, trails = trails,
    rods = rods and check_rods(rods, count) }
end

return M
