-- Formulas for moving frames that are wrong only far away are refused, with the point and the
-- defect; right ones that lose digits there are taken.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local action, frame = dm.action, dm.moving_frame
local acos, atan, cos, log, sin, sqrt = dm.acos, dm.atan, dm.cos, dm.log, dm.sin, dm.sqrt
local R1, R2, R3 = dm.R(1), dm.R(2), dm.R(3)

local function along(_, b) return b[1] end
local function chord(a, b) return { a[1], a[2], b[2] } end
local function gram_schmidt(a, b)
  local e1 = a / a:norm()
  local w = b - e1 * e1:dot(b)
  local e2 = w / w:norm()
  return e1, e2, e1:cross(e2)
end
local function rigid(a, t)
  local c, s = cos(t), sin(t)
  return { -(c * a[1] - s * a[2]), -(s * a[1] + c * a[2]), t }
end
-- |b - a|, which loses digits
local function length(a, b) return sqrt(b:dot(b) - 2 * a:dot(b) + a:dot(a)) end
-- x; at 1 all but eight digits of w are lost, so that only what nudges scatter is told from a defect
local function rounded(x)
  local w = sqrt(x * x + 1e8) - 1e4
  return sqrt(w * (w + 2e4)) * dm.where(x, 1, -1)
end
local function cube_root(x) return dm.where(x, 1, -1) * dm.abs(x) ^ (1 / 3) end
local shifts = action { group = R1, on = R2, map = function(g, z) return { z[1] + g[1], z[2] } end }
local boosts = action { group = R1, on = R2, map = function(g, z)
  local c, s = dm.cosh(g[1]), dm.sinh(g[1])
  return { c * z[1] + s * z[2], s * z[1] + c * z[2] }
end, domain = function(z) return z[1] - dm.abs(z[2]) end }
local lenz = action { group = dm.SO(2), on = R2, map = function(t, w)
  local n = w:dot(w)
  local d = 1 + n - cos(t) * (n - 1) - 2 * sin(t) * w[2]
  return { 2 * w[1] / d, (-sin(t) * (n - 1) + 2 * cos(t) * w[2]) / d }
end }

-- name, options
local right = {
  { "turns", { action = action { group = dm.SO(2), on = R2 }, cross_section = function(z)
    return z[2]
  end, branch = function(z) return z[1] end, solution = function(z) return -atan(z[2], z[1]) end } },
  { "rigid motions", { action = action { group = dm.SE(2), on = R2 }, points = 2,
    cross_section = chord, branch = along,
    solution = function(a, b) return rigid(a, -atan(b[2] - a[2], b[1] - a[1])) end } },
  { "rigid motions by the sine", { action = action { group = dm.SE(2), on = R2 }, points = 2,
    cross_section = chord, branch = along, solution = function(a, b)
      local l = length(a, b)
      return rigid(a, -atan((b[2] - a[2]) / l, (b[1] - a[1]) / l))
    end } },
  { "rigid motions by the arc cosine", { action = action { group = dm.SE(2), on = R2 }, points = 2,
    cross_section = chord, branch = along, solution = function(a, b)
      return rigid(a, -acos((b[1] - a[1]) / length(a, b)) * dm.where(b[2] - a[2], 1, -1))
    end } },
  { "rigid motions to ten digits", { action = action { group = dm.SE(2), on = R2 }, points = 2,
    cross_section = chord, branch = along, solution = function(a, b)
      return rigid(a * (1 + 1e-10), -atan(b[2] - a[2], b[1] - a[1]))
    end } },
  { "motions of space", { action = action { group = dm.SE(3), on = R3 }, points = 3,
    cross_section = function(a, b, c) return { a[1], a[2], a[3], b[2], b[3], c[3] } end,
    branch = function(_, b, c) return { b[1], c[2] } end, solution = function(a, b, c)
      local out = { [4] = { 0, 0, 0, 1 } }
      for i, e in ipairs { gram_schmidt(b - a, c - a) } do
        out[i] = { e[1], e[2], e[3], -e:dot(a) }
      end
      return dm.matrix(out)
    end } },
  { "rotations", { action = action { group = dm.SO(3), on = R3 }, points = 2,
    cross_section = function(a, b) return { a[2], a[3], b[3] } end,
    branch = function(a, b) return { a[1], b[2] } end, solution = function(a, b)
      local x, y, z = gram_schmidt(a, b)
      return dm.matrix { x:totable(), y:totable(), z:totable() }
    end } },
  { "SL(2) on a line", { action = action { group = dm.SL(2), on = R1 }, points = 3,
    cross_section = function(a, b, c) return { a[1] + 1, b[1], c[1] - 1 } end,
    solution = function(a, b, c)
      local u, v, w = a[1], b[1], c[1]
      return dm.matrix { { w - u, -(w - u) * v }, { w - 2 * v + u, w * v - 2 * w * u + v * u } }
        / sqrt(2 * (w - u) * (w - v) * (v - u))
    end } },
  { "SL(2) on vectors", { action = action { group = dm.SL(2), on = R2 }, points = 2,
    cross_section = function(a, b) return { a[1] - 1, a[2], b[1] } end, solution = function(a, b)
      local d = a[1] * b[2] - a[2] * b[1]
      return dm.matrix { { b[2] / d, -b[1] / d }, { -a[2], a[1] } }
    end } },
  { "Heisenberg", { action = action { group = dm.Heisenberg(), on = dm.Heisenberg() },
    cross_section = function(z) return z end, solution = function(z) return -z end } },
  { "shifts to a cubic, by Cardano", { action = shifts,
    cross_section = function(z) return z[1] ^ 3 + z[1] - z[2] end, solution = function(z)
      local d = sqrt(z[2] ^ 2 / 4 + 1 / 27)
      return { cube_root(z[2] / 2 + d) + cube_root(z[2] / 2 - d) - z[1] }
    end } },
  { "boosts", { action = boosts, cross_section = function(z) return z[2] end,
    solution = function(z) return { 0.5 * log((z[1] - z[2]) / (z[1] + z[2])) } end } },
  { "Runge-Lenz", { action = lenz, points = 2,
    cross_section = function(w) return { w:dot(w) - 1 } end, branch = function(w) return w[2] end,
    solution = function(a) return -atan(a:dot(a) - 1, 2 * a[2]) end } },
  { "turns by a number that loses eight digits", { action = action { group = dm.SO(2), on = R2 },
    cross_section = function(z) return z[2] end, branch = function(z) return z[1] end,
    solution = function(z) return -atan(z[2], rounded(z[1])) end } },
}
for _, case in ipairs(right) do
  local fine, why = pcall(frame, case[2])
  ok(fine, "taken: " .. case[1], why)
end

-- the options with exp(d e_j) g in place of g, where d = wrong(x) of entry i of point p is not 0
local function spoilt(o, p, i, j, wrong)
  local G, out = o.action.group, {}
  for key, value in pairs(o) do out[key] = value end
  function out.solution(...)
    local g, d = o.solution(...), wrong((select(p, ...))[i])
    local xi = dm.vector(G.dimension)
    if d == 0 then return g end
    xi[j] = d
    return G:compose(G:exp(G.dimension == 1 and G == dm.SO(2) and d or xi), g)
  end
  return out
end
-- what is wrong beyond T, on the side of that sign
local kinds = {
  { "drift", function(x) return 1e-3 * math.max(0, x) end },
  { "jump", function(x) return x > 0 and 1 or 0 end },
  { "bend", function(x) return x > 0 and 1e-5 * x ^ 2 or 0 end },
}
for _, case in ipairs(right) do
  local o = case[2]
  for p = 1, o.points or 1 do
    for i = 1, o.action.dimension do
      local taken = {}
      for n, kind in ipairs(kinds) do
        for _, T in ipairs(case[1] == "boosts" and i == 1 and { 45, 130 } or { 45, -45, 130, -130 })
        do
          local sign = T > 0 and 1 or -1
          local wrong = spoilt(o, p, i, (n + i) % o.action.group.dimension + 1,
            function(x) return kind[2](sign * x - math.abs(T)) end)
          local fine, why = pcall(frame, wrong)
          if fine or not why:find("no moving frame: at z = (", 1, true)
            and not why:find("no moving frame: the orbit of z = (", 1, true) then
            taken[#taken + 1] = ("%s beyond %g: %s"):format(kind[1], T, tostring(why))
          end
        end
      end
      ok(#taken == 0, ("refused: %s, wrong far away in entry %d of point %d"):format(case[1], i, p),
        table.concat(taken, "\n"))
    end
  end
end

-- of no group far away, the inverse, the other cut
local turns, sections = right[1][2], right[8][2]
local function refused(why, o, solution)
  local fine, message = pcall(frame, { action = o.action, points = o.points,
    cross_section = o.cross_section, branch = solution and o.branch, solution = solution })
  ok(not fine and message:find(why, 1, true), "refused: " .. why, message)
end
refused("is no element of SL(2): its determinant is", sections, function(a, b, c)
  return sections.solution(a, b, c) * (1 + 1e-6 * dm.max(0, b[1] - 60))
end)
refused("is not on the cross-section", turns, function(z)
  return z:norm() > 100 and -turns.solution(z) or turns.solution(z)
end)
refused("the branch condition does not hold", turns, function(z)
  return turns.solution(z) + (z[2] < -100 and math.pi or 0)
end)
-- a formula for nearer points, as of Newton's method by 12 steps, is one where the action says so
local function by_steps(domain)
  return { action = action { group = R1, on = R2, map = shifts.map, domain = domain },
    cross_section = function(z) return z[1] + z[1] ^ 3 - z[2] end, solution = function(z)
      local e = 0 * z[2]
      for _ = 1, 12 do e = e - (e + e ^ 3 - z[2]) / (1 + 3 * e ^ 2) end
      return { e - z[1] }
    end }
end
tap.raises("for nearer points needs an action that says where they are, by domain(z) > 0", frame, by_steps())
tap.ok(frame(by_steps(function(z) return 20 - dm.abs(z[2]) end)), "a formula for the points of the domain")
-- a formula that is no function is not rounded
local calls = 0
refused("is not on the cross-section", turns, function(z)
  calls = calls + 1
  return turns.solution(z) + 1e-3 * sin(calls)
end)

---- solved for: a second piece of the section that only orbits of large points reach ----

local solved = {
  { "turns", 1, turns.action, function(z) return { z[2] } end, function(z) return z[1] end },
  { "rigid motions", 2, right[2][2].action,
    function(a, b) return { b[2] - a[2], a[1], a[2] } end, function(a, b) return b[1] - a[1] end },
  { "rotations", 2, right[7][2].action, function(a, b) return { b[3], a[2], a[3] } end,
    function(a, b) return { a[1], b[2] } end },
  { "turns and shifts", 1, action { group = dm.product(dm.SO(2), R1), on = R3,
    map = function(g, z)
      local c, s = cos(g[1]), sin(g[1])
      return { c * z[1] - s * z[2], s * z[1] + c * z[2], z[3] + g[2][1] }
    end }, function(z) return { z[2], z[3] } end, function(z) return z[1] end },
  { "velocities", 1, action { group = dm.SE(2), on = R2 }:tangent(),
    function(z) return { z[4], z[1], z[2] } end, function(z) return z[3] end },
}
for _, case in ipairs(solved) do
  local name, k, of, section, branch = table.unpack(case)
  for _, far in ipairs { 30, -30, 45 } do
    local function two(...)
      local Z = section(...)
      Z[1] = Z[1] * (Z[1] - far)
      return Z
    end
    local function first_piece(...)
      local out = { branch(...) }
      if type(out[1]) == "table" then out = { table.unpack(out[1]) } end
      local z = section(...)[1]
      out[#out + 1] = far > 0 and far / 2 - z or z - far / 2
      return out
    end
    local function made(condition)
      return pcall(frame, { action = of, points = not of.base and k or nil, cross_section = two,
        branch = condition })
    end
    local fine, why = made(branch)
    ok(not fine and why:find("cuts the cross-section more than once", 1, true),
      ("refused: %s, two pieces %g apart"):format(name, far), why)
    fine, why = made(first_piece)
    ok(fine, ("taken: %s, the branch is one of them"):format(name), why)
  end
end

tap.done()
