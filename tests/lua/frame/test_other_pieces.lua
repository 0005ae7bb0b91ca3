-- Sections of two pieces far apart along an orbit, beside equations that are flat far away, so that
-- Newton's method finds the other piece from nowhere near: refused by deflation from the first one.
-- With the branch of one piece they are taken.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local action, frame = dm.action, dm.moving_frame
local atan, exp, sin = dm.atan, dm.exp, dm.sin
local R2, R3 = dm.R(2), dm.R(3)

local function flat(x) return x / (1 + x ^ 2) ^ 0.5 end
local function steep(x) return exp(3 * x) - 1 end
local shifts = action { group = R2, on = R2, map = function(g, z)
  return { z[1] + g[1], z[2] + g[2] }
end }
local galilei = action { group = R2, on = R3, map = function(g, z)
  return { z[1] + g[1] + g[2] * z[2], z[2], z[3] + g[2] }
end }
local heisenberg = action { group = dm.Heisenberg(), on = dm.Heisenberg() }
local linear = action { group = dm.GL(2), on = R2 }
local rotations = action { group = dm.SO(3), on = R3 }
local back = action { group = dm.SE(2), on = R2, side = "right" }

-- name, action, points, section with a second piece at W, the number that is 0 or W, branch
local cases = {
  { "shifts", shifts, 1, function(W, z) return { z[1] * (z[1] - W), steep(z[2]) } end,
    function(z) return z[1] end },
  { "boosts in a line", galilei, 1, function(W, z) return { steep(z[1]), z[3] * (z[3] - W) } end,
    function(z) return z[3] end },
  { "Heisenberg", heisenberg, 1, function(W, z) return { flat(z[1]), atan(z[2]), z[3] * (z[3] - W) } end,
    function(z) return z[3] end },
  { "linear maps", linear, 2, function(W, a, b)
    return { flat(a[1] - 1), a[2] + sin(a[2]) / 2, (b[1] - W) * b[1], atan(5 * (b[2] - 1)) }
  end, function(_, b) return b[1] end },
  { "rotations", rotations, 2, function(W, a, b)
    return { a[1] * (a[1] - W), steep(a[2]), flat(b[2]) }
  end, function(a) return a[1] end, function(a, b) return { a[3], b[1] } end },
  { "rigid motions, from the right", back, 2, function(W, a, b)
    return { a[1] * (a[1] - W), atan(a[2]), flat(b[2] - a[2]) }
  end, function(a) return a[1] end, function(a, b) return b[1] - a[1] end },
}
for _, case in ipairs(cases) do
  local name, of, count, section, which, branch = table.unpack(case)
  for _, W in ipairs { 20, -60, 200 } do
    local function made(condition)
      return pcall(frame, { action = of, points = count, branch = condition,
        cross_section = function(...) return section(W, ...) end })
    end
    local fine, why = made(branch)
    ok(not fine and why:find("cuts the cross-section more than once", 1, true),
      ("refused: %s, a second piece at %g"):format(name, W), why)
    fine, why = made(function(...)
      local out = branch and branch(...) or {}
      out = type(out) == "table" and { table.unpack(out) } or { out }
      local x = which(...)
      out[#out + 1] = W > 0 and W / 2 - x or x - W / 2
      return out
    end)
    ok(fine, ("taken: %s, the piece at 0"):format(name), why)
  end
end

tap.done()
