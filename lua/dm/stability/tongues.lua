--- Steps between the columns of a row at which linear theory expects the motion to be lost: windows
-- of growth, and tongues about resonances, which columns may step over.
local blame = require "dm.base.blame"

local M = {}

local MOST_ROWS = 64 -- of a map that is looked at: its neighbours show what the others have
local MOST = 36      -- steps of a row
-- the amplitude moves a tongue from the resonance: parts of its step, the nearest first
local BESIDE = { 0, -0.002, 0.002, -0.006, 0.006, -0.015, 0.015 }
local INSIDE = { 0.5, 0.25, 0.75, 0.05, 0.95 } -- of a window

--- What linear theory says of the cells of row i, told once: `what` of dm.stability.along_orbit.
function M.theory(map, i, what)
  local row = map.rows[i]
  row.linear = row.linear or {}
  if not row.linear[what] then
    local cell = { rule = row.number, values = row.values, h = map.h[1] }
    row.linear[what] = table.pack(require "dm.stability.along_orbit"[what](map, cell, map.h))
  end
  return table.unpack(row.linear[what], 1, row.linear[what].n)
end

-- adds x where it is between columns; the first that are added are those that matter most
local function adder(map, top)
  local out, taken = {}, {}
  for _, x in ipairs(map.h) do taken[x] = true end
  return out, function(x)
    if #out >= MOST or taken[x] or not (x > map.h[1] and x < top) then return end
    taken[x], out[#out + 1] = true, x
  end
end

-- steps about resonances: those by a third of a circle first, which are the widest, and the nearest
local function about(resonances)
  local out = {}
  for k, part in ipairs(BESIDE) do
    for _, r in ipairs(resonances) do
      out[#out + 1] = { h = r.h * (1 + part), last = 2 * r.n + k }
    end
  end
  table.sort(out, function(a, b) return a.last < b.last or a.last == b.last and a.h < b.h end)
  return out
end

--- Steps h between the first column of row i and `top` at which it may be lost, the smallest
-- first; none where linear theory tells nothing, or the map has many rows.
function M.places(map, i, top)
  if map.column ~= map.h or #map.h < 2 or #map.rows > MOST_ROWS then return {} end
  local fine, resonances = blame.try(M.theory, map, i, "resonances")
  local known, windows = blame.try(M.theory, map, i, "windows")
  local out, add = adder(map, top)
  for _, part in ipairs(INSIDE) do
    for _, window in ipairs(known and windows or {}) do
      add(window[1] + part * (window[2] - window[1]))
    end
  end
  for _, mark in ipairs(fine and about(resonances or {}) or {}) do add(mark.h) end
  table.sort(out)
  return out
end

return M
