--- Where the panels of a figure stand: columns have one left edge and rows one lower edge, with
-- room for the widest ticks, labels, titles and legends of each.
local M = {}

-- pixels of the layout (letters of 11 points at 96 dots per inch)
local LETTER, LINE, GAP, NAME = 8, 20, 14, 30

local function widest(ticks)
  local most = 0
  for _, tick in ipairs(ticks) do most = math.max(most, utf8.len(tick.text) or #tick.text) end
  return most
end

-- room that a panel needs on its four sides
local function room_of(panel)
  local x, y = panel.x, panel.y
  local has_y = (panel.ylabel or "") ~= "" and not y.hidden
  local has_x = (panel.xlabel or "") ~= "" and not x.hidden
  local texts = (y.hidden or y.bare) and 0 or widest(y.ticks)
  return { left = GAP + LETTER * texts + (has_y and NAME or 0) + (panel.letter and 10 or 0),
    right = GAP + LETTER,
    below = GAP + ((x.hidden or x.bare) and 0 or LINE) + (has_x and NAME or 0)
      + LINE * #panel.notes,
    above = GAP + (panel.legend_rows or 0) * 1.3 * LINE + (panel.title and 1.4 * LINE or 0) }
end

-- the larger entries of two
local function larger(a, b)
  for key, x in pairs(b) do a[key] = math.max(a[key] or 0, x) end
  return a
end

-- an equal panel keeps its shape: in the middle of its place, its upper edge where it is
local function shaped(panel, box, width, height)
  if not panel.equal then return box end
  local ratio = (panel.y.hi - panel.y.lo) / (panel.x.hi - panel.x.lo)
  local w, h = (box[2] - box[1]) * width, (box[4] - box[3]) * height
  if h / w > ratio then
    return { box[1], box[2], box[4] - w * ratio / height, box[4] }
  end
  local free = (w - h / ratio) / width / 2
  return { box[1] + free, box[2] - free, box[3], box[4] }
end

--- Give every panel its box { left, right, bottom, top } in parts of the picture; its axes are
-- made.
function M.place(figure)
  local columns, rows, width, height = figure.columns, figure.rows, figure.look.width,
    figure.look.height
  local by_column, by_row = {}, {}
  for i, panel in ipairs(figure.panels) do
    local c, r, room = (i - 1) % columns + 1, (i - 1) // columns + 1, room_of(panel)
    by_column[c] = larger(by_column[c] or {}, { left = room.left, right = room.right })
    by_row[r] = larger(by_row[r] or {}, { above = room.above, below = room.below })
  end
  local across, up = width, height - (figure.title and 1.8 * LINE or 0)
  for c = 1, columns do across = across - by_column[c].left - by_column[c].right end
  for r = 1, rows do up = up - by_row[r].above - by_row[r].below end
  local w, h = math.max(across / columns, 10), math.max(up / rows, 10)
  local top = height - (figure.title and 1.8 * LINE or 0)
  for r = 1, rows do
    local left = 0
    top = top - by_row[r].above
    for c = 1, columns do
      left = left + by_column[c].left
      local panel = figure.panels[(r - 1) * columns + c]
      if panel then
        panel.box = shaped(panel, { left / width, (left + w) / width, (top - h) / height,
          top / height }, width, height)
      end
      left = left + w + by_column[c].right
    end
    top = top - h - by_row[r].below
  end
end

return M
