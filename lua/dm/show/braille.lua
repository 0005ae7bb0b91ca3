--- Plots in a terminal: every character is a cell of 2 x 4 dots, braille where there is Unicode.
local axis = require "dm.show.axis"
local characters = require "dm.show.characters"
local series_ = require "dm.show.series"

local M = {}

local floor, max, min = math.floor, math.max, math.min

-- bit of the dot in column 0, 1 and row 0..3 of a cell (Unicode block 2800)
local DOTS = { { 0x01, 0x02, 0x04, 0x40 }, { 0x08, 0x10, 0x20, 0x80 } }
local COLOURS = { 34, 31, 32, 33, 36, 35 }  -- ANSI, by series

---- canvas: w x h cells, dot (0, 0) at the lower left; signs: dm.show.characters ----

local function new_canvas(w, h, signs)
  return { w = w, h = h, signs = signs, bits = {}, owner = {}, letter = {} }
end

local function cell(canvas, i, j)
  return (canvas.h - 1 - j // 4) * canvas.w + i // 2
end

local function dot(canvas, i, j, owner)
  if i < 0 or j < 0 or i >= 2 * canvas.w or j >= 4 * canvas.h then return end
  local at = cell(canvas, i, j)
  canvas.bits[at] = (canvas.bits[at] or 0) | DOTS[i % 2 + 1][4 - j % 4]
  canvas.owner[at] = owner
end

-- part of a stroke inside 0..xmax, 0..ymax (Liang-Barsky): two numbers between 0 and 1, or nothing
local function clip(x0, y0, x1, y1, xmax, ymax)
  local from, to = 0, 1
  local function edge(rate, room)
    if rate == 0 then return room >= 0 end
    local t = room / rate
    if rate < 0 then from = max(from, t) else to = min(to, t) end
    return from <= to
  end
  local dx, dy = x1 - x0, y1 - y0
  if edge(-dx, x0) and edge(dx, xmax - x0) and edge(-dy, y0) and edge(dy, ymax - y0) then
    return from, to
  end
end

local function stroke(canvas, x0, y0, x1, y1, owner)
  local from, to = clip(x0, y0, x1, y1, 2 * canvas.w - 1, 4 * canvas.h - 1)
  if not from then return end
  local dx, dy = x1 - x0, y1 - y0
  local n = max(1, math.ceil((to - from) * max(math.abs(dx), math.abs(dy))))
  for k = 0, n do
    local s = from + (to - from) * k / n
    dot(canvas, floor(x0 + s * dx + 0.5), floor(y0 + s * dy + 0.5), owner)
  end
end

-- few points are shown larger than a dot
local function put_bullet(canvas, x, y, owner)
  if x < 0 or y < 0 or x >= 2 * canvas.w or y >= 4 * canvas.h then return end
  local at = cell(canvas, floor(x + 0.5), floor(y + 0.5))
  canvas.letter[at], canvas.owner[at] = canvas.signs.bullet, owner
end

-- without colour, letters tell the series apart
local function put_letters(canvas, xs, ys, owner)
  local letter = string.char(96 + owner)
  for k = 1, 6 do
    local at = max(1, floor((k - 0.2 * (owner % 5)) / 6 * #xs))
    local x, y = xs[at], ys[at]
    if x and x == x and x >= 0 and y >= 0 and x < 2 * canvas.w and y < 4 * canvas.h then
      canvas.letter[cell(canvas, floor(x), floor(y))] = letter
    end
  end
end

-- dots from the lower left; what is far outside is kept countable, a gap stays NaN
local function place(a, x, dots)
  local at = axis.fraction(a, x) * dots
  if at ~= at then return at end
  return max(-1e9, min(1e9, at))
end

local function draw_series(canvas, panel, series, number)
  local w, h = 2 * canvas.w - 1, 4 * canvas.h - 1
  local xs, ys, n = {}, {}, #series.x
  for i = 1, n do
    xs[i] = place(panel.x, series.x[i], w)
    ys[i] = place(panel.y, series.y[i], h)
  end
  for i = 1, n do
    local here = xs[i] == xs[i]
    local joined = series.style ~= "points" and i > 1 and xs[i - 1] == xs[i - 1]
    if here and joined then
      stroke(canvas, xs[i - 1], ys[i - 1], xs[i], ys[i], number)
    elseif here then
      dot(canvas, floor(xs[i] + 0.5), floor(ys[i] + 0.5), number)
    end
    if here and n <= 40 and series.style ~= "lines" then
      put_bullet(canvas, xs[i], ys[i], number)
    end
  end
  if canvas.letters and number <= 26 then put_letters(canvas, xs, ys, number) end
end

---- text around it ----

local function text_width(s) return utf8.len(s) or #s end

local function centred(s, width)
  return (" "):rep(max(0, (width - text_width(s)) // 2)) .. s
end

local function paint(s, number, colour)
  if not (colour and number) then return s end
  return ("\27[%dm%s\27[0m"):format(COLOURS[(number - 1) % #COLOURS + 1], s)
end

local function canvas_row(canvas, row, colour)
  local out = {}
  for column = 0, canvas.w - 1 do
    local at = row * canvas.w + column
    local bits = canvas.bits[at]
    local text = canvas.letter[at] or bits and canvas.signs.cell(bits) or " "
    out[#out + 1] = text ~= " " and paint(text, canvas.owner[at], colour) or text
  end
  return (table.concat(out):gsub(" +$", ""))
end

-- texts of the y ticks by row of cells, and their common width
local function left_texts(panel, h)
  local rows, width = {}, 1
  for _, tick in ipairs(panel.y.ticks) do
    local row = h - 1 - floor(tick.fraction * (4 * h - 1) + 0.5) // 4
    rows[row] = tick.text
    width = max(width, text_width(tick.text))
  end
  return rows, width
end

-- the line of the x axis and the texts below it
local function bottom_lines(panel, w, signs)
  local line, texts, free = {}, "", 0
  for i = 1, w do line[i] = signs.line end
  for _, tick in ipairs(panel.x.ticks) do
    local at = floor(tick.fraction * (2 * w - 1) + 0.5) // 2
    local start = max(0, at - text_width(tick.text) // 2)
    if at >= 0 and at < w then line[at + 1] = signs.tick_below end
    if start >= free then
      texts = texts .. (" "):rep(start - text_width(texts)) .. tick.text
      free = text_width(texts) + 1
    end
  end
  return table.concat(line), texts
end

local function legend(panel, colour, signs)
  if not panel.legend then return nil end
  local parts = {}
  for i, s in ipairs(panel.series) do
    local mark = colour and signs.stroke or i <= 26 and string.char(96 + i) or "-"
    parts[i] = paint(mark .. " " .. signs.text(s.name), i, colour)
  end
  return table.concat(parts, "   ")
end

-- cells and ranges: with equal axes the canvas shrinks to the shape of the data
local function fit(panel, w, h)
  if not panel.equal then return w, h end
  local x, y = panel.xrange, panel.yrange
  local scale = max((x[2] - x[1]) / (2 * w - 1), (y[2] - y[1]) / (4 * h - 1))
  return max(4, math.ceil((x[2] - x[1]) / scale / 2)), max(2, math.ceil((y[2] - y[1]) / scale / 4))
end

local function make_axes(panel, w, h, signs)
  local x, y = panel.xrange, panel.yrange
  local lox, hix, loy, hiy = x[1], x[2], y[1], y[2]
  if panel.equal then lox, hix, loy, hiy = axis.equal(x, y, 2 * w - 1, 4 * h - 1) end
  panel.x = axis.new(lox, hix, max(3, w // 12), panel.logx)
  panel.y = axis.new(loy, hiy, max(3, h // (panel.logy and 2 or 4)), panel.logy)
  for _, a in ipairs { panel.x, panel.y } do
    for _, tick in ipairs(a.ticks) do tick.text = signs.text(tick.text) end
  end
end

local function fill(canvas, panel)
  local scale = { width = 2 * canvas.w, height = 4 * canvas.h,
    fx = function(x) return axis.fraction(panel.x, x) end,
    fy = function(y) return axis.fraction(panel.y, y) end }
  for i, series in ipairs(panel.series) do
    draw_series(canvas, panel, series_.thin(series, scale), i)
  end
end

--- The lines of text that show one panel.
-- @param panel from dm.plot: series, ranges, labels
-- @param room { width =, height = of the whole in characters, colour = boolean, signs }
function M.lines(panel, room)
  local w, h = fit(panel, max(8, room.width - 12), max(3, room.height - 5))
  local signs = room.signs or characters.here()
  make_axes(panel, w, h, signs)
  local canvas = new_canvas(w, h, signs)
  canvas.letters = not room.colour and #panel.series > 1 and panel.legend ~= false
  fill(canvas, panel)
  local texts, margin = left_texts(panel, h)
  local indent = (" "):rep(margin + 1)
  local out = {}
  local function add(line) if line then out[#out + 1] = line end end
  add(panel.title and centred(signs.text(panel.title), w + margin + 1))
  add(legend(panel, room.colour, signs))
  local caption = signs.text(axis.caption(panel.y, panel.ylabel, panel.yunit))
  add(caption ~= "" and caption)
  for row = 0, h - 1 do
    local text = texts[row] or ""
    local pad = (" "):rep(margin - text_width(text))
    local edge = texts[row] and signs.tick_left or signs.bar
    add(pad .. text .. edge .. canvas_row(canvas, row, room.colour))
  end
  local line, below = bottom_lines(panel, w, signs)
  add((" "):rep(margin) .. signs.corner .. line)
  add(indent .. below)
  add(indent .. centred(signs.text(axis.caption(panel.x, panel.xlabel, panel.xunit)), w))
  for _, note in ipairs(panel.notes) do add(indent .. note) end
  return out
end

return M
