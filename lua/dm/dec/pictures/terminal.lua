--- Meshes in a terminal: lines of edges, arrows, and faces in shades of their values.
local drawing = require "dm.dec.pictures.drawing"
local look = require "dm.show.look"
local plot = require "dm.show.plot"
local shades = require "dm.show.shades"

local M = {}

local TALL = 2 -- a character is as tall as so many are wide

---- lines ----

-- A tour of all edges without lifting the pen: each is walked there and, later, back. Lists of
-- vertices, one for each component.
local function tours_of(edges)
  local next_to, out, walked = {}, {}, {}
  for i, cell in ipairs(edges) do
    for j = 1, 2 do
      local v = cell[j]
      next_to[v] = next_to[v] or {}
      table.insert(next_to[v], { cell[3 - j], i })
    end
  end
  for _, cell in ipairs(edges) do
    local stack, tour = { cell[1] }, { cell[1] }
    while #stack > 0 do
      local v = stack[#stack]
      local step = table.remove(next_to[v])
      if not step then
        table.remove(stack)
        tour[#tour + 1] = stack[#stack]
      elseif not walked[step[2]] then
        walked[step[2]] = true
        stack[#stack + 1], tour[#tour + 1] = step[1], step[1]
      end
    end
    if #tour > 1 then out[#out + 1] = tour end
  end
  return out
end

local function lines(d, see, title, options)
  local series = {}
  local function add(points)
    local x, y = {}, {}
    for i, p in ipairs(points) do x[i], y[i] = see(p) end
    series[#series + 1] = { x = x, y = y, name = tostring(#series + 1) }
  end
  for _, tour in ipairs(#d.arrows == 0 and tours_of(d.edges) or {}) do
    for i, v in ipairs(tour) do tour[i] = d.points[v] end
    add(tour)
  end
  for _, arrow in ipairs(d.arrows) do -- in place of the edges: both would be a thicket
    local p, q = arrow[1], {}
    for c = 1, 3 do q[c] = p[c] + arrow[2][c] end
    add { p, q }
  end
  plot.plot(series, { equal = true, title = title, legend = false,
    size = options.size, ascii = options.ascii,
    xlabel = d.dim == 2 and "x" or " ", ylabel = d.dim == 2 and "y" or " " })
end

---- faces in shades ----

-- corners of a face in the picture, and its depth
local function seen(d, cell, see)
  local out, depth = {}, 0
  for j, v in ipairs(cell) do
    local x, y, z = see(d.points[v])
    out[j], depth = { x, y }, depth + z / #cell
  end
  return out, depth
end

-- twice the signed area of a, b, (x, y)
local function side(a, b, x, y)
  return (b[1] - a[1]) * (y - a[2]) - (b[2] - a[2]) * (x - a[1])
end

local function is_inside(corners, x, y)
  local a, b, c = corners[1], corners[2], corners[3]
  local u, v, w = side(a, b, x, y), side(b, c, x, y), side(c, a, x, y)
  return u >= 0 and v >= 0 and w >= 0 or u <= 0 and v <= 0 and w <= 0
end

-- { x0, x1, y0, y1 } of all corners
local function frame_of(faces)
  local box = { math.huge, -math.huge, math.huge, -math.huge }
  for _, face in ipairs(faces) do
    for _, p in ipairs(face.corners) do
      box[1], box[2] = math.min(box[1], p[1]), math.max(box[2], p[1])
      box[3], box[4] = math.min(box[3], p[2]), math.max(box[4], p[2])
    end
  end
  return box
end

-- puts a face into the characters whose middle it covers, or at least into that of its own middle;
-- the nearest one counts
local function lay(canvas, face)
  local x0, y1, dx, dy = canvas.box[1], canvas.box[4], canvas.dx, canvas.dy
  local low, high = { canvas.columns, canvas.rows }, { 1, 1 }
  local function column(x) return math.floor((x - x0) / dx) + 1 end
  local function row(y) return math.floor((y1 - y) / dy) + 1 end
  local function put(i, j)
    local at = math.min(i, canvas.columns) + math.min(j, canvas.rows) * 1000
    if not canvas[at] or canvas[at].depth < face.depth then canvas[at] = face end
  end
  local middle = { 0, 0 }
  for _, p in ipairs(face.corners) do
    local i, j = column(p[1]), row(p[2])
    low[1], high[1] = math.min(low[1], i), math.max(high[1], i)
    low[2], high[2] = math.min(low[2], j), math.max(high[2], j)
    middle[1], middle[2] = middle[1] + p[1] / 3, middle[2] + p[2] / 3
  end
  put(column(middle[1]), row(middle[2]))
  for i = low[1], high[1] do
    for j = low[2], high[2] do
      if is_inside(face.corners, x0 + (i - 0.5) * dx, y1 - (j - 0.5) * dy) then put(i, j) end
    end
  end
end

local function in_shades(d, see, title, options)
  local faces, lo, hi = {}, math.huge, -math.huge
  for i, cell in ipairs(d.faces) do
    local corners, depth = seen(d, cell, see)
    if not drawing.is_turned_away(d, table.unpack(corners)) then
      faces[#faces + 1] = { corners = corners, depth = depth, value = d.values[i] }
    end
    lo, hi = math.min(lo, d.values[i]), math.max(hi, d.values[i])
  end
  local box, columns, rows = frame_of(faces), shades.size(look.sized(options))
  local wide, tall = math.max(box[2] - box[1], 1e-300), math.max(box[4] - box[3], 1e-300)
  rows = rows or 24
  local unit = math.max(wide / columns, tall / (TALL * rows))
  local canvas = { box = box, dx = unit, dy = TALL * unit, columns = math.ceil(wide / unit - 1e-9),
    rows = math.ceil(tall / (TALL * unit) - 1e-9) }
  for _, face in ipairs(faces) do lay(canvas, face) end
  local shade, legend = shades.scale(lo, hi, 2)
  local out = { title }
  for j = 1, canvas.rows do
    local text = {}
    for i = 1, canvas.columns do
      local face = canvas[i + 1000 * j]
      text[i] = face and shade(face.value) or " "
    end
    out[#out + 1] = shades.line(d.dim == 2 and box[4] - (j - 0.5) * canvas.dy or nil,
      (table.concat(text):gsub(" +$", "")))
  end
  if d.dim == 2 then out[#out + 1] = shades.ends(box[1], box[2], canvas.columns) end
  out[#out + 1] = (d.dim == 2 and "y up, x across; " or "") .. legend
  io.write(table.concat(out, "\n"), "\n")
end

--- Draws what is to be drawn (drawing.lua), seen by a camera.
function M.draw(d, see, title, options)
  if d.on == "faces" and #d.faces > 0 then return in_shades(d, see, title, options) end
  return lines(d, see, title, options)
end

return M
