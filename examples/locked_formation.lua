-- Which turn does a satellite ask for when it follows another one round the Earth? With the trivial connection each quarter of the orbit is an
-- error of 90 degrees; with the one of tidal locking, dtheta - dphi, a body that shows the same face is told nothing. The relative
-- elements of a formation are what its controllers work on (Leok 4.7.2, figure 4.10).
local dm = require "dm"
local sin, cos, pi, abs = math.sin, math.cos, math.pi, math.abs
local picture = (arg and arg[1] or ".") .. "/locked_formation.png"

local function connection(f) return dm.connection { group = dm.SO(2), base = dm.product(dm.R(1), dm.T(1)), local_form = f } end -- (r, phi), theta
local trivial = connection(function() return 0 end)
local locked = connection(function(a, b) return a[2] - b[2] end)
local chief, deputy = { { 1, 0 }, 0 }, { { 1, pi / 4 }, pi / 4 }
assert(abs(trivial(chief, deputy) - pi / 4) < 1e-15 and abs(locked(chief, deputy)) < 1e-15, "figure 4.10")
assert(locked:check().worst < 1e-12 and locked:curvature({ 1, 0 }, 1, 2):norm() == 0, "flat: holonomy is whole turns alone")

-- four satellites with controllers of their attitude: I theta'' = -k A_d(chief, body) - c (theta' - phi'), on one orbit, phi' = 1, at 0, 0.4,
-- 0.8, 1.2 behind the chief, which is locked already
local k, c, names = 4, 2, { "chief", "second", "third", "fourth" }
local function place(i, t) return { 1, t - 0.4 * (i - 1) } end
local function controlled(A)
  return dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 end, force = function(q, v, t)
    local out = {}
    for i = 1, 3 do out[i] = -k * A({ place(1, t), t }, { place(i + 1, t), q[i] }) - c * (v[i] - 1) end
    return out
  end }
end
local panels = {}
for _, row in ipairs { { "locked", locked }, { "trivial", trivial } } do
  local path = controlled(row[2]):solver { rule = "gauss(2)", h = 0.05 }:run { q = { 0.7, -1.1, 0.3 }, v = { 0, 0, 1 }, t = 12 }
  local t, q = path.t[#path], path.q[#path]
  local bodies = { { place(1, t), t } }
  for i = 1, 3 do bodies[i + 1] = { place(i + 1, t), q[i] } end
  local formation = locked:formation(bodies)
  print(("with the %s connection, after %g: A_d = %.4f %.4f %.4f"):format(row[1], t, formation[2].g, formation[3].g, formation[4].g))
  for i = 2, 4 do
    local want = row[1] == "locked" and 0 or 0.4 * (i - 1)
    assert(abs(formation[i].g - want) < 1e-3, "locked: each shows the same face; trivial: all point where the chief points")
    assert(abs(formation[i].dx[2] + 0.4 * (i - 1)) < 1e-12 and formation[1].g == 0, "the chief stands at the identity")
  end
  local panel = { title = row[1] .. " connection: angle to the Earth", xlabel = "t", ylabel = "theta - phi" }
  for i = 1, 3 do
    local y = {}
    for n = 1, #path do y[n] = path.q[n][i] - place(i + 1, path.t[n])[2] end
    panel[i] = { x = path:column("t"), y = y, name = names[i + 1] }
  end
  panels[#panels + 1] = panel
  if row[1] == "locked" then
    path:animate(picture:gsub("png$", "html"), { title = "a formation locks on to the Earth", draw = function(at, time)
      local points, rods = { { 0, 0 } }, {}
      for i = 1, 4 do
        local phi, theta = place(i, time)[2], i == 1 and time or at[i - 1]
        local x, y = cos(phi), sin(phi)
        points[#points + 1], points[#points + 2] = { x, y }, { x - 0.2 * cos(theta), y - 0.2 * sin(theta) }
        rods[i] = { 2 * i, 2 * i + 1 }
      end
      return { points = points, rods = rods }
    end })
  end
end
print("picture  " .. dm.figure { panels[1], panels[2], file = picture, size = { 1100, 440 }, title = "A formation and its connection" })
