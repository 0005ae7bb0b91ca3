-- relative equilibria of reduced systems: found, described, followed in the momentum
local tap = require "tap"
local dm = require "dm"
local models = require "routh_models"
local ok, near, raises = tap.ok, tap.near, tap.raises
local abs, sqrt, sin, cos, tan = math.abs, math.sqrt, math.sin, math.cos, math.tan

-- spherical pendulum, q = (azimuth, angle from below): mu^2 = sin^4/cos, a minimum; frequency of small motions in closed form
local bob = dm.system { Q = dm.R(2), L = function(q, v) return (v[2] ^ 2 + sin(q[2]) ^ 2 * v[1] ^ 2) / 2 + cos(q[2]) end }
local angle = 0.8
local mu = sqrt(sin(angle) ^ 4 / cos(angle))
local cone = bob:routh { cyclic = { 1 }, mu = mu }
local list = cone:relative_equilibria { region = { { 0.05, 3 } } }
ok(#list == 1 and list[1].stable == "energy", "conical pendulum: one, a minimum", tostring(list))
near(list[1].x[1], angle, 1e-13, "its angle")
near(list[1].velocity[1], 1 / sqrt(cos(angle)), 1e-13, "its velocity")
near(abs(list[1].values[1][2]), sqrt((1 + 3 * cos(angle) ^ 2) / cos(angle)), 1e-12, "its frequency of small motions")
local branch = cone:continue(list[1], { mu = { 0.05, 3 }, step = 0.1 })
local worst = 0
for i = 1, #branch do worst = math.max(worst, abs(branch.mu[i] ^ 2 - sin(branch.x1[i]) ^ 4 / cos(branch.x1[i]))) end
ok(#branch > 10 and branch.mu[#branch] == 3 and worst < 1e-9, "followed in mu along the closed form", worst)

-- double spherical pendulum by angles from below, any direction: four families
local m1, m2, l1, l2, g = models.m1, models.m2, models.l1, models.l2, models.g
local double = dm.system { Q = dm.R(4), coordinates = { "theta", "a1", "a2", "phi" }, L = function(q, v)
  local a, b, phi = q[2], q[3], q[4]
  local t1, t2, r1, r2 = v[1], v[1] + v[4], l1 * sin(a), l2 * sin(b)
  local dr1, dr2, dz1, dz2 = l1 * cos(a) * v[2], l2 * cos(b) * v[3], l1 * sin(a) * v[2], l2 * sin(b) * v[3]
  local T1 = dr1 ^ 2 + r1 ^ 2 * t1 ^ 2 + dz1 ^ 2
  local T2 = dr1 ^ 2 + r1 ^ 2 * t1 ^ 2 + dr2 ^ 2 + r2 ^ 2 * t2 ^ 2 + 2 * (dr1 * dr2 + r1 * r2 * t1 * t2) * cos(phi)
    + 2 * (r1 * dr2 * t1 - r2 * dr1 * t2) * sin(phi) + (dz1 + dz2) ^ 2
  return m1 * T1 / 2 + m2 * T2 / 2 + m1 * g * l1 * cos(a) + m2 * g * (l1 * cos(a) + l2 * cos(b))
end }
local region = { { 0.01, 3.13 }, { -3.13, 3.13 }, { -0.5, 0.5 } }
local slow = double:routh { cyclic = { 1 }, mu = 0.5 }
local four = slow:relative_equilibria { region = region, starts = 400, copies = false }
ok(#four == 4, "double spherical pendulum: four families", tostring(four))
-- near the straight states they are the normal modes: w^2 of (m1 + m2) l1 s1 w^2 ... for rods down (1) or up (-1)
local function modes(s1, s2)
  local a, b, c = m1 / (m1 + m2), -g * (s1 / l1 + s2 / l2), g * g * s1 * s2 / (l1 * l2)
  local root, out = sqrt(b * b - 4 * a * c), {}
  for _, w in ipairs { (-b + root) / (2 * a), (-b - root) / (2 * a) } do if w > 0 then out[#out + 1] = sqrt(w) end end
  return out
end
local rates = {}
for _, s in ipairs { { 1, 1 }, { 1, -1 }, { -1, 1 }, { -1, -1 } } do
  for _, w in ipairs(modes(s[1], s[2])) do rates[#rates + 1] = w end
end
ok(#rates == 4, "straight states have four modes of rotation", #rates)
for _, e in ipairs(four) do
  local least, back = math.huge, slow:continue(e, { mu = { 0.001, 1 }, step = 0.02, back = true })
  for i, w in ipairs(rates) do
    if abs(back.velocity[#back] - w) < least then least = abs(back.velocity[#back] - w) end
    if i == #rates then ok(least < 0.03, "a family begins at a normal mode", back.velocity[#back]) end
  end
end

-- balance of forces on a family; stability along it; a motion that stays
local shape = double:routh { cyclic = { 1 }, mu = 2 }
local all = shape:relative_equilibria { region = region }
for _, e in ipairs(all) do
  local a, b, w2 = e.x[1], e.x[2], e.velocity[1] ^ 2
  near(w2 * (l1 * sin(a) + l2 * sin(b)) - g * tan(b), 0, 1e-10, "the lower rod points along gravity and centrifugal force")
  near((m1 + m2) * g * tan(a) - w2 * ((m1 + m2) * l1 * sin(a) + m2 * l2 * sin(b)), 0, 1e-9, "and the upper one with what it carries")
end
ok(all[1].stable == "energy" and all[2].stable == "spectral" and all[2].index == 2 and not all[3].stable and not all[4].stable,
  "stretched out: a minimum; folded: stable by the magnetic term; standing: not", tostring(all))
local run = shape:solver({ rule = "gauss(3)", h = 0.02 }):run { q = all[2].x, v = { 0, 0, 0 }, steps = 200 }
local moved = 0
for i = 1, #run do moved = math.max(moved, (run.q[i] - all[2].x):norm()) end
ok(moved < 1e-10, "a relative equilibrium stays where it is", moved)
-- characteristic values against the exact tangent map of a short step
local M = shape:solver({ rule = "gauss(5)", h = 0.05 }):tangent { q = all[3].x, v = { 0, 0, 0 }, steps = 1 }
local re, im = M:eigenvalues()
local fastest, growth = 0, 0
for i = 1, #re do fastest = math.max(fastest, 0.5 * math.log(re[i] ^ 2 + im[i] ^ 2) / 0.05) end
for _, value in ipairs(all[3].values) do growth = math.max(growth, value[1]) end
near(fastest, growth, 1e-8, "characteristic values are those of the tangent map")

-- the folded family loses stability by collision of frequencies, and not through V_mu
local folded = shape:continue(all[2], { mu = { 0.05, 12 }, step = 0.1 })
ok(#folded.events == 1 and folded.events[1].what == "stable (spectrum) to unstable", "the folded family loses its stability", tostring(folded))
ok(folded.events[1].momentum > 4 and folded.events[1].momentum < 5 and folded[#folded].index == 2, "with the index of V_mu as it was", tostring(folded))
local stretched = shape:continue(all[1], { mu = { 0.05, 12 }, step = 0.1 })
ok(#stretched.events == 0 and stretched[#stretched].stable == "energy", "the stretched one keeps it", tostring(stretched))
local slope = 0
for i = 2, #stretched do  -- dE/dmu = velocity of the group along a family
  local rise = (stretched.energy[i] - stretched.energy[i - 1]) / (stretched.mu[i] - stretched.mu[i - 1])
  slope = math.max(slope, abs(rise - (stretched.velocity[i] + stretched.velocity[i - 1]) / 2))
end
ok(slope < 2e-3, "the energy of a family changes with mu at the velocity of the group", slope)
local down = shape:continue(all[1], { mu = { 0.05, 12 }, step = 0.1, back = true })
ok(down.mu[#down] == 0.05 and stretched.mu[#stretched] == 12 and math.abs(down.energy[#down] - down.energy[#down - 1]) < 0.1, "and is followed back to the very bound", down.mu[#down])

-- a fold: V = x^3/3 - x, inertia 1/(1 + x^2/2 ...) chosen so that V_mu' = x^2 - 1 + mu^2/2, two equilibria that meet at mu = sqrt 2
local fold = dm.system { Q = dm.R(2), L = function(q, v) return v[2] ^ 2 / 2 + v[1] ^ 2 / (2 * (3 + q[2])) - q[2] ^ 3 / 3 + q[2] end }:routh { cyclic = { 1 }, mu = 1 }
local pair = fold:relative_equilibria { region = { { -2, 2 } } }
ok(#pair == 2, "two equilibria", tostring(pair))
near(abs(pair[1].x[1]), sqrt(0.5), 1e-12, "where they are known to be")
local through = fold:continue(pair[1], { mu = { 0.2, 3 }, step = 0.05 })
ok(through.events[1] and through.events[1].what == "fold" and abs(through.events[1].momentum - sqrt(2)) < 0.02, "the branch goes through the fold", tostring(through))
ok(through[#through].x[1] * pair[1].x[1] < 0, "and back on the other side", tostring(through))

-- where L is not quadratic in the velocity of the group
local fast = dm.system { Q = dm.R(2), L = function(q, v) return -sqrt(1 - v[1] ^ 2 - q[1] ^ 2 * v[2] ^ 2) - q[1] ^ 2 / 2 end }
local ring = fast:routh { cyclic = { 2 }, mu = 0.5 }:relative_equilibria { region = { { 0.1, 3 } } }
local r = ring[1].x[1]
near(0.25 / (r ^ 3 * sqrt(1 + 0.25 / r ^ 2)) - r, 0, 1e-12, "a fast particle on a circle: closed form")

-- a saddle without diagonal entries; a circle of equilibria, which no round-off may call minima or saddles
local saddle = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[2] * q[3] end }:routh { cyclic = { 1 }, mu = 1 }
local cross = saddle:relative_equilibria { region = { { -1, 1 }, { -1, 1 } } }
ok(#cross == 1 and cross[1].index == 1 and cross[1].flat == 0 and not cross[1].stable, "V = x y has a saddle", tostring(cross))
local hat = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - (q[2] ^ 2 + q[3] ^ 2 - 1) ^ 2 end }
local circle, flat = hat:routh { cyclic = { 1 }, mu = 1 }:relative_equilibria { region = { { -2, 2 }, { -2, 2 } } }, true
for _, e in ipairs(circle) do
  local rim = e.x:norm() > 0.5
  flat = flat and e.index == (rim and 0 or 2) and e.flat == (rim and 1 or 0) and e.stable ~= "energy"
end
ok(#circle > 2 and flat and tostring(circle):find("flat in 1 direction", 1, true), "a circle of equilibria is flat along itself", tostring(circle))
-- at the poles of the coordinates, one rod vertical, V_mu is stationary and nothing is in balance
local everywhere = slow:relative_equilibria { region = { { -3.13, 3.13 }, { -3.13, 3.13 }, { -3.2, 3.2 } }, starts = 400 }
local in_balance = #everywhere >= 4
for _, e in ipairs(everywhere) do
  in_balance = in_balance and abs(sin(e.x[1])) > 1e-3 and abs(sin(e.x[2])) > 1e-3 and abs(sin(e.x[3])) < 1e-9 and #e.values == 6
end
ok(in_balance, "no equilibria at poles of the coordinates", tostring(everywhere))

raises("option 'region'", function() shape:relative_equilibria {} end)
raises("'region'[2]", function() shape:relative_equilibria { region = { { 0, 1 }, { 2, 1 }, { 0, 1 } } } end)
raises("unknown option", function() shape:relative_equilibria { region = region, start = 3 } end)
raises("{ from, to }", function() shape:continue(all[1], {}) end)
raises("continue takes one of", function() shape:continue({}, { mu = { 0, 1 } }) end)
raises("reduced system", function() double:relative_equilibria { region = region } end)

-- a branch that runs into a pole of the group ends there, by that name; one that passes mu = 0 elsewhere goes on
local function sphere(k)
  return dm.system { Q = dm.R(2), L = function(q, v)
    return (v[2] ^ 2 + (math.sin(q[2]) ^ 2 + k) * v[1] ^ 2) / 2 + 9.81 * math.cos(q[2]) + (k > 0 and q[2] or 0)
  end }:routh { cyclic = { 1 }, mu = 0.5 }
end
for _, range in ipairs { { 0, 1 }, { -1, 1 } } do
  for _, step in ipairs { 0.02, 0.01, 0.003 } do
    local spun = sphere(0)
    local branch = spun:continue(spun:relative_equilibria({ region = { { 0.05, 1.5 } }, starts = 20 })[1], { mu = range, step = step, back = true })
    local event = branch.events[1]
    ok(#branch.events == 1 and event.what:find "pole" and event.momentum == 0 and math.abs(event.x[1]) < 1e-6 and branch[#branch].x[1] > 0,
      ("the spherical pendulum's branch ends at the pole, mu from %g, step %g"):format(range[1], step), tostring(branch))
  end
end
local regular = sphere(0.3)
local across = regular:continue(regular:relative_equilibria({ region = { { 0.05, 1.5 } }, starts = 20 })[1], { mu = { -0.5, 1 }, back = true })
ok(#across.events == 0 and math.abs(across[#across].momentum + 0.5) < 1e-9, "mu = 0 where the locked inertia is regular is no event", tostring(across))

tap.done()
