-- Formulas for moving frames that are wrong in one cell of those that where, abs, sign, max and min
-- make: refused, however narrow and far away the cell is. Right ones of many cells are taken.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local action, frame = dm.action, dm.moving_frame
local abs, atan, cos, max, min, sign, sin, where = dm.abs, dm.atan, dm.cos, dm.max, dm.min, dm.sign,
  dm.sin, dm.where
local R2, R3 = dm.R(2), dm.R(3)

local function gram_schmidt(a, b)
  local e1 = a / a:norm()
  local w = b - e1 * e1:dot(b)
  local e2 = w / w:norm()
  return dm.matrix { e1:totable(), e2:totable(), e1:cross(e2):totable() }
end
-- the formula, which something is added to
local actions = {
  { "turns", { action = action { group = dm.SO(2), on = R2 },
    cross_section = function(z) return z[2] end, branch = function(z) return z[1] end },
    function(d, z) return d - atan(z[2], z[1]) end },
  { "rigid motions", { action = action { group = dm.SE(2), on = R2 }, points = 2,
    cross_section = function(a, b) return { a[1], a[2], b[2] } end,
    branch = function(_, b) return b[1] end },
    function(d, a, b)
      local t = -atan(b[2] - a[2], b[1] - a[1])
      local c, s = cos(t), sin(t)
      return { d - (c * a[1] - s * a[2]), -(s * a[1] + c * a[2]), t }
    end },
  { "rotations", { action = action { group = dm.SO(3), on = R3 }, points = 2,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end },
    function(d, a, b)
      local c, s = cos(d), sin(d)
      return dm.matrix { { 1, 0, 0 }, { 0, c, -s }, { 0, s, c } } * gram_schmidt(a, b)
    end },
  { "vectors of the plane", { action = action { group = dm.SL(2), on = R2 }, points = 2,
    cross_section = function(a, b) return { a[1] - 1, a[2], b[1] } end },
    function(e, a, b)
      local d = a[1] * b[2] - a[2] * b[1]
      return dm.matrix { { b[2] / d, -b[1] / d }, { -a[2] + e * b[2] / d, a[1] - e * b[1] / d } }
    end },
  { "boosts, in their domain", { action = action { group = dm.R(1), on = R2, map = function(g, z)
    local c, s = dm.cosh(g[1]), dm.sinh(g[1])
    return { c * z[1] + s * z[2], s * z[1] + c * z[2] }
  end, domain = function(z) return z[1] - abs(z[2]) end },
    cross_section = function(z) return z[2] end },
    function(d, z) return { d + 0.5 * dm.log((z[1] - z[2]) / (z[1] + z[2])) } end },
}
-- 1 in a cell beyond T, by several words; x: entry 1 of a point, y: entry 2
local function step(x) return where(x, 1, 0) end
local cells = {
  { "a strip", function(x, _, T) return step(x - T) * step(1.03 * T - x) end },
  { "a strip by signs", function(x, _, T) return (1 + sign(x - T)) * (1 - sign(x - 1.1 * T)) / 4 end },
  { "a hat", function(x, _, T) return 1e-3 * max(0, min(x - T, 1.05 * T - x)) end },
  { "a ring", function(x, y, T)
    local r = dm.sqrt(x * x + y * y)
    return where(r - T, where(1.05 * T - r, 0.5, 0), 0)
  end },
  { "a part of a strip", function(x, y, T)
    return where(x - T, where(1.05 * T - x, where(y - 0.4 * T, where(0.5 * T - y, 1, 0), 0), 0), 0)
  end },
}
local function with(case, solution)
  local o = { solution = solution }
  for key, value in pairs(case[2]) do o[key] = value end
  return o
end
for _, case in ipairs(actions) do
  local taken = {}
  for _, cell in ipairs(cells) do
    for _, T in ipairs { 0.7, 17, 61, 333 } do
      local fine, why = pcall(frame, with(case, function(...)
        local z = (select(select("#", ...), ...))
        return case[3](cell[2](z[1], z[2], T), ...)
      end))
      if fine or not why:find("no moving frame: at z = (", 1, true)
        and not why:find("no moving frame: the orbit of z = (", 1, true) then
        taken[#taken + 1] = ("%s at %g: %s"):format(cell[1], T, tostring(why))
      end
    end
  end
  ok(#taken == 0, "refused in one cell: " .. case[1], table.concat(taken, "\n"))
  local harmless = with(case, function(...)
    local z = (select(select("#", ...), ...))
    local d = 0
    for i = 1, 6 do
      local x = z[1 + i % 2] - 7 * i
      d = d + max(x, 0) - where(x, x, 0)
    end
    return case[3](d, ...)
  end)
  local fine, why = pcall(frame, harmless)
  ok(fine, "taken with many cells: " .. case[1], why)
end

tap.done()
