-- flow on surfaces by its vorticity: K:euler (Rossby-Haurwitz waves turn rigidly; three integrals; steady flows)
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin = math.cos, math.sin

-- a wave of degree 4 in a rotation about z: it turns by 1 - 2/(l (l + 1)) = 0.9 a unit of time
local function wave(K, t)
  local c, s = cos(0.9 * t), sin(0.9 * t)
  return K:form(0, function(x, y, z)
    local a, b = c * x + s * y, c * y - s * x
    return 2 * z + 6 * z * (a ^ 3 - 3 * a * b ^ 2)
  end)
end
local function integrals_kept(run, sentence)
  local size = run:column "energy":sum() / #run
  for _, name in ipairs { "energy", "enstrophy", "circulation" } do
    ok(run:drift(name).largest <= 1e-13 * size, sentence .. ": " .. name, run:drift(name).largest)
  end
end
-- w = z: psi = -z/2, the energy int |grad psi|^2/2 is pi/3, the enstrophy int w^2/2 is 2 pi/3
local sphere = dm.mesh { icosphere = 4 }
local turning = sphere:euler { vorticity = sphere:form(0, function(_, _, z) return 1 + z end) }:solver { h = 0.1 }:run { t = 0.1 }
near(turning:column "energy"[1], math.pi / 3, 2e-3, "energy of a rotation")
near(turning:column "enstrophy"[1], 2 * math.pi / 3 + 2 * math.pi, 2e-2, "enstrophy of a rotation and a constant")
near(turning:column "circulation"[1], 4 * math.pi, 2e-2, "circulation of a constant")
local figures, last = { 0.69985549041, 0.20388443755, 0.05350867450 }, nil
for i, s in ipairs { 2, 3, 4 } do
  local K = dm.mesh { icosphere = s }
  local run = K:euler { vorticity = wave(K, 0) }:solver { rule = "midpoint", h = 0.4 / 2 ^ (i + 1) }:run { t = 2 }
  local off = (run:form(#run) - wave(K, 2)):norm() / wave(K, 2):norm()
  near(off, figures[i], 1e-9, "Rossby-Haurwitz, icosphere " .. s)
  if last then ok(last / off > 3.4, "towards order 2", last / off) end
  last = off
  integrals_kept(run, "icosphere " .. s)
end

-- the surface faces outwards, whatever its first triangle says: exchanged corners and mirrored numbers change no flow
local ball = dm.mesh { icosphere = 2 }
local turned, cells = {}, ball:simplices(2)
for i = #cells, 1, -1 do turned[#turned + 1] = { cells[i][2], cells[i][1], cells[i][3] } end
local points, flipped, count = ball:points(), {}, ball:count(0)
for i = 1, count do flipped[count + 1 - i] = points[i] end
for _, c in ipairs(turned) do for j = 1, 3 do c[j] = count + 1 - c[j] end end
local same = dm.mesh { simplices = turned, points = flipped }
local function ends(K) local run = K:euler { vorticity = wave(K, 0) }:solver { h = 0.1 }:run { t = 1 } return run:form(#run) end
local a, b, off = ends(ball), ends(same), 0
for i = 1, count do off = math.max(off, math.abs(a[i] - b[count + 1 - i])) end
ok(off < 1e-11, "faces outwards with any numbering", off)

-- psi: div grad psi = w on the sphere, exact eigenfunctions to order 2; steady zonal flow stays
local run = ball:euler { vorticity = function(_, _, z) return z end }:solver { h = 0.2 }:run { steps = 3 }
local psi = run:stream(1)
local mean = ball:laplace_beltrami() * psi
ok((mean - run:form(1)):max() < 1e-12, "div grad psi = w", (mean - run:form(1)):max())
local zonal = dm.mesh { icosphere = 3 }
local steady = zonal:euler { vorticity = function(_, _, z) return 2 * z end }:solver { h = 0.1 }:run { t = 1 }
ok((steady:form(#steady) - steady:form(1)):norm() < 0.02 * steady:form(1):norm(), "a rotation is steady, to order 2")

-- a plane domain: psi = 0 on the boundary, the flow turns counterclockwise about positive vorticity, as in the plane
local plate = dm.mesh { triangle = 12 }
local vortex = plate:euler { vorticity = function(x, y) return 4 * math.exp(-40 * ((x - 0.4) ^ 2 + (y - 0.25) ^ 2)) end }
local swirl = vortex:solver { h = 0.05 }:run { t = 1, every = 5 }
integrals_kept(swirl, "plane domain")
ok(#swirl == 5 and swirl.steps == 20 and swirl.t[5] == 1, "rows of every fifth step")
local marks = plate:boundary_marks(0)
local edge = 0
for i = 1, #marks do if marks[i] ~= 0 then edge = math.max(edge, math.abs(swirl:stream(3)[i])) end end
ok(edge == 0, "psi is 0 on the boundary", edge)
-- the centre of vorticity moves with the velocity: w is carried by u = (-psi_y, psi_x) (independent road: differences of moments)
local function moment(form, f)
  local sum, x, dual = 0, plate:points(), plate:dual_volume(0)
  for i = 1, #form do sum = sum + dual[i] * form[i] * f(x[i][1], x[i][2]) end
  return sum
end
local early = vortex:solver { h = 1e-3 }:run { steps = 1 }
local rate = (moment(early:form(2), function(x) return x end) - moment(early:form(1), function(x) return x end)) / 1e-3
local X, u, w = early:stream(1):d():sharp { to = "cells" }, 0, early:form(1)
for i, c in ipairs(plate:simplices(2)) do -- integral of w times the x-component of the velocity, -psi_y
  u = u - X[i][2] * plate:volume(2)[i] * (w[c[1]] + w[c[2]] + w[c[3]]) / 3
end
near(rate, u, 2e-3 * math.abs(u) + 1e-6, "the centre of vorticity moves with the flow")

-- other surfaces: a torus (closed, of genus 1), two spheres at once, an annulus with two boundaries
local torus = dm.mesh { torus = { 16, 8 }, radii = { 2, 0.7 } }
integrals_kept(torus:euler { vorticity = function(x, y, z) return x * y + z end }:solver { h = 0.1 }:run { t = 1 }, "torus")
integrals_kept(dm.mesh { annulus = { 3, 24 }, ratio = 1.5 }:euler { vorticity = function(x, y) return x + y * y end }:solver { h = 0.05 }:run { t = 1 }, "annulus")
integrals_kept(dm.mesh { hex_torus = 8 }:euler { vorticity = (function() local w = {} for i = 1, 64 do w[i] = sin(i * i) end return w end)() }
  :solver { h = 0.02 }:run { t = 0.2 }, "a flat torus by lengths")

-- round a hole: a potential vortex has psi = k log(r/R)/(2 pi) and the energy k^2 log(R/r0)/(4 pi), to order 2; the
-- circulation along the hole has the fluid on its left
local k, R, last_off = 2, 3, nil
for _, n in ipairs { 4, 8 } do
  local ring = dm.mesh { annulus = { n, 8 * n }, ratio = R }
  local still = ring:euler { vorticity = 0, circulations = { -k } }:solver { h = 0.1 }:run { steps = 2 }
  local psi = ring:form(0, function(x, y) return k * math.log(math.sqrt(x * x + y * y) / R) / (2 * math.pi) end)
  local away = (still:stream(3) - psi):max()
  ok(away < 0.06 / n ^ 2 and (not last_off or last_off / away > 3.9), "a potential vortex, to order 2", away)
  near(still:column "energy"[3], k ^ 2 * math.log(R) / (4 * math.pi), 0.06 / n ^ 2, "its energy")
  ok(still:form(3):max() == 0, "without vorticity")
  last_off = away
end
-- Kelvin: the integral of the velocity along the hole stays, as the vorticity goes round it; psi is a constant there
local ring = dm.mesh { annulus = { 6, 48 }, ratio = 3 }
local function bump(x, y) return math.exp(-4 * ((x - 2) ^ 2 + y ^ 2)) end
local stirred = ring:euler { vorticity = bump }
local round = stirred:solver { h = 0.1 }:run { t = 4, every = 10 }
local weight, place, at_hole = ring:dual_volume(0), ring:points(), ring:boundary_marks(0)
for v = 1, #at_hole do
  if place[v][1] ^ 2 + place[v][2] ^ 2 > 2 then at_hole[v] = 0 end
end
local function along(run, i)
  local load, sum = (ring:laplacian(0) * run:stream(i) + run:form(i)).values, 0
  for v = 1, #at_hole do sum = sum + at_hole[v] * weight[v] * load[v] end
  return sum
end
local least, most = math.huge, -math.huge
for v = 1, #at_hole do
  if at_hole[v] == 1 then least, most = math.min(least, round:stream(5)[v]), math.max(most, round:stream(5)[v]) end
end
near(along(round, 1), stirred.circulations[1], 1e-12, "the circulation round a hole, where psi is 0 at first")
near(along(round, 5), along(round, 1), 1e-12, "is kept")
ok(most - least < 1e-14 and most > 1e-4, "psi on the hole is a constant, no longer 0", most)
ok(round:stream(1):max() > 0 and (round:form(5) - round:form(1)):max() > 0.1, "though the vorticity has moved")
integrals_kept(round, "round a hole")
-- a circulation of one's own; runs that go on
local spun = ring:euler { vorticity = bump, circulations = { -1 } }:solver { h = 0.1 }
local all, half = spun:run { steps = 10 }, spun:run { steps = 5 }
integrals_kept(all, "round a hole with a circulation of its own")
ok(dm.resume(half):run { steps = 5 }.w[6] == all.w[11], "goes on with the circulation it had")
local state = half:checkpoint(os.tmpname())
ok(stirred:resume(state):run { steps = 5 }.w[6] == all.w[11], "from a file, too")
os.remove(state)
ok(spun:run { steps = 10, vorticity = bump, circulations = { -1 } }.w[11] == all.w[11]
  and spun:run { steps = 10, vorticity = bump }.circulations == stirred.circulations, "a run with a start of its own")
raises("a number for every hole, 1 in all", function() ring:euler { vorticity = 0, circulations = { 1, 2 } } end)
raises("circulations[1] must be finite", function() ring:euler { vorticity = 0, circulations = { 1 / 0 } } end)
raises("0 in all", function() plate:euler { vorticity = 0, circulations = { 1 } } end)
raises("this solver goes on", function() dm.resume(half):run { steps = 5, circulations = { 1 } } end)
-- two holes
local plate_2 = dm.mesh { grid = 9 }
local kept_cells = {}
for _, c in ipairs(plate_2:simplices(2)) do
  local x, y = 0, 0
  for _, v in ipairs(c) do x, y = x + plate_2:points()[v][1] / 3, y + plate_2:points()[v][2] / 3 end
  local low = x > 2 / 9 and x < 3 / 9 and y > 2 / 9 and y < 4 / 9
  local high = x > 6 / 9 and x < 7 / 9 and y > 5 / 9 and y < 7 / 9
  if not low and not high then kept_cells[#kept_cells + 1] = c end
end
local two = dm.mesh { simplices = kept_cells, points = plate_2:points() }
ok(two:betti()[2] == 2, "a square with two holes")
local pair = two:euler { vorticity = function(x, y) return x - y * y end, circulations = { 0.3, -0.2 } }:solver { h = 0.1 }:run { t = 3 }
integrals_kept(pair, "two holes")
ok(#pair.euler.around == 0, "no handles")

-- times, starts, files
local solver = ball:euler { vorticity = wave(ball, 0) }:solver { h = 0.1 }
local whole, first = solver:run { t = 1 }, solver:run { t = 0.5 }
local second = solver:run { vorticity = first:form(#first), t0 = 0.5, t = 0.5 }
ok((whole:form(11) - second:form(#second)):max() < 1e-12, "a run goes on from another one's end")
local third = dm.resume(first):run { t = 0.5 }
ok(#third == 6 and third:form(6).values == whole:form(11).values and third.t[6] == 1, "t is a duration, of a run that goes on too")
local name = os.tmpname() .. ".npy"
local streamed = solver:run { t = 1, file = name }
local data = dm.load(name)
os.remove(name)
ok(#data.w == 11 and data.w[11] == whole.w[11] and data.energy == whole:column "energy", "rows in a file, to the bit")
ok(#streamed == 2 and streamed.w[2] == whole.w[11] and streamed.t[2] == 1, "the first and the last row are kept")
name = whole:npy(name)
ok(dm.load(name).w[5] == whole.w[5], "npy")
os.remove(name)

-- what fails says so
raises("a surface is needed", function() dm.mesh { bcc = 3 }:euler { vorticity = 1 } end)
raises("not orientable", function() dm.mesh { klein = 5 }:euler { vorticity = 1 } end)
raises("'vorticity' is missing", function() ball:euler {} end)
raises("unknown option 'omega'", function() ball:euler { omega = 1 } end)
raises("rule", function() ball:euler { vorticity = 1 }:solver { rule = "rk4", h = 0.1 } end)
raises("'h' is missing", function() ball:euler { vorticity = 1 }:solver {} end)
raises("either 't' or 'steps'", function() solver:run {} end)
raises("finite", function() ball:euler { vorticity = function() return 0 / 0 end } end)
raises("dual area of vertex", function() dm.mesh { simplices = { { 1, 2, 3 } }, points = { { 0, 0 }, { 4, 0 }, { 1, 1 } } }:euler { vorticity = 1 } end)
raises("not orientable", function() dm.mesh { simplices = { { 1, 2, 3 }, { 1, 2, 4 }, { 1, 2, 5 } }, lengths = 1 }:euler { vorticity = 1 } end)
local fine, why = pcall(function() ball:euler { vorticity = wave(ball, 0) }:solver { h = 20 }:run { steps = 2 } end)
ok(not fine and why.code == "no_convergence" and why.path and #why.path == 1, "a step that is too long fails with the run so far", tostring(why))
ok(ball.euler == 2, "K.euler is Euler's number")
raises("attempt to call a number value", function() ball.euler(1) end)
tap.done()
