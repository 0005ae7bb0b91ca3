-- Flows round the handles of a surface: beta = d psi + sum b_k eta_k. The independent roads: Euler's equations in velocities
-- on a torus of revolution by Fourier series, the pressure by projection (no vorticity, no harmonic forms), Galilean
-- invariance on a flat torus, and what any flow keeps.
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sin, cos, pi = math.sin, math.cos, math.pi

local function integrals_kept(run, name)
  for _, column in ipairs { "energy", "enstrophy", "circulation" } do
    local drift = run:drift(column)
    ok(drift.largest < 2e-13 * (1 + math.abs(run:column(column)[1])), name .. ": " .. column, drift.largest)
  end
end

---- a torus of revolution, R = 2, r = 0.7: psi = c cos phi and a rotation at the rate U ----
local R, r, c, U = 2, 0.7, 0.8, 0.3
local function vorticity(x, y, z) return -c * x / (x * x + y * y) ^ 1.5 + 2 * U * z / r end
local function rotation(x, y) return { -U * y, U * x, 0 } end
-- the flux through a circle round the tube: up along the zigzag of the mesh, and back along the outer circle
local function flux(K, beta, nu, nv)
  local points, sum = K:points(), 0
  local function vertex(phi, theta)
    local rho, z = R + r * cos(theta), r * sin(theta)
    for i = 1, #beta.mesh:dual_volume(0) do
      local p = points[i]
      if (p[1] - rho * cos(phi)) ^ 2 + (p[2] - rho * sin(phi)) ^ 2 + (p[3] - z) ^ 2 < 1e-20 then return i end
    end
  end
  local path = {}
  for j = 0, nv do path[#path + 1] = vertex(pi * j / nu, 2 * pi * j / nv) end
  for j = nv // 2 - 1, 0, -1 do path[#path + 1] = vertex(2 * pi * j / nu, 0) end
  for k = 1, #path - 1 do
    local edge, sign = K:find { path[k], path[k + 1] }
    sum = sum - sign * beta[edge]
  end
  return sum
end
-- by 64 x 48 Fourier modes (48 x 32 agree to 1e-9), t = 2: the energy stays, the flux grows
local energy, flux_0, flux_2 = 14.136675650, 2.638937829, 2.809453356
local last
for n = 1, 2 do
  local K = dm.mesh { torus = { 16 * n, 8 * n }, radii = { R, r } }
  local run = K:euler { vorticity = vorticity, harmonic = rotation }:solver { h = 0.1 / n }:run { t = 2, every = 5 * n }
  local off = { math.abs(run:column "energy"[1] - energy), math.abs(flux(K, run:beta(1), 16 * n, 8 * n) - flux_0),
    math.abs(flux(K, run:beta(#run), 16 * n, 8 * n) - flux_2) }
  for k = 1, 3 do
    ok(off[k] < ({ 0.51, 0.13, 0.17 })[k] / n ^ 1.9, "a torus of revolution " .. n .. ", figure " .. k, off[k])
    if last then ok(last[k] / off[k] > 3.8, "to order 2, figure " .. k, last[k] / off[k]) end
  end
  last = off
  integrals_kept(run, "a torus of revolution")
  ok((run:beta(#run):d()):max() < 1e-13, "beta is closed")
end
-- from rest vorticity drives a flow round the handle
local K = dm.mesh { torus = { 16, 8 }, radii = { R, r } }
local driven = K:euler { vorticity = function(x, y, z) return x * y + z + x end }:solver { h = 0.05 }:run { t = 1 }
ok(driven.around[1]:norm() == 0 and driven.around[#driven]:norm() > 0.3, "driven from rest", driven.around[#driven]:norm())
integrals_kept(driven, "driven")

---- a flat torus: circles of chords in four dimensions ----
local function flat(n)
  local points, simplices = {}, {}
  local function at(i, j) return (i % n) * n + j % n + 1 end
  local radius = 1 / (2 * n * sin(pi / n)) -- edges of 1/n
  for i = 0, n - 1 do
    for j = 0, n - 1 do
      local x, y = 2 * pi * i / n, 2 * pi * j / n
      points[at(i, j)] = { radius * cos(x), radius * sin(x), radius * cos(y), radius * sin(y) }
      simplices[#simplices + 1] = { at(i, j), at(i + 1, j), at(i + 1, j + 1) }
      simplices[#simplices + 1] = { at(i, j), at(i + 1, j + 1), at(i, j + 1) }
    end
  end
  return dm.mesh { points = points, simplices = simplices }, at
end
-- the form of a velocity: a / n and b / n along the edges of the circles
local function steady(mesh, n, at, a, b)
  local values = dm.vector(mesh:count(1))
  for i = 0, n - 1 do
    for j = 0, n - 1 do
      for _, side in ipairs { { 1, 0, a }, { 0, 1, b }, { 1, 1, a + b } } do
        local edge, sign = mesh:find { at(i, j), at(i + side[1], j + side[2]) }
        values[edge] = sign * side[3] / n
      end
    end
  end
  return values
end
-- seen from a mean flow (1, 1/2) a flow is the same: after t = 1/2 it has gone n/2 and n/4 edges farther
local before
for _, n in ipairs { 24, 48 } do
  local mesh, at = flat(n)
  local w = dm.vector(n * n)
  for i = 0, n - 1 do
    for j = 0, n - 1 do
      local x, y = 2 * pi * i / n, 2 * pi * j / n
      w[at(i, j)] = sin(x) + cos(y) + 0.7 * cos(x + y) * sin(y)
    end
  end
  local h = 0.25 / n
  local rest = mesh:euler { vorticity = w }:solver { h = h }:run { t = 0.5, every = n }
  local moving = mesh:euler { vorticity = w, harmonic = steady(mesh, n, at, 1, 0.5) }:solver { h = h }:run { t = 0.5, every = n }
  near(moving:column "energy"[1] - rest:column "energy"[1], (1 + 0.25) / 2, 1e-13, "the energy of a mean flow on the area 1")
  integrals_kept(moving, "a flat torus")
  ok((moving.around[#moving] - moving.around[1]):norm() < 1e-12, "which is kept there")
  local most = 0
  for i = 0, n - 1 do
    for j = 0, n - 1 do
      most = math.max(most, math.abs(moving.w[#moving][at(i + n // 2, j + n // 4)] - rest.w[#rest][at(i, j)]))
    end
  end
  ok(not before or before / most > 3.5, "Galilean invariance, to order 2", before and before / most)
  before = most
end
ok(before < 0.1, "Galilean invariance", before)
local alone, alone_at = flat(8)
local only = alone:euler { vorticity = 0, harmonic = steady(alone, 8, alone_at, 2, -1) }:solver { h = 0.1 }:run { steps = 3 }
ok(only.w[4]:norm() == 0 and only.around[4] == only.around[1], "a mean flow alone is steady")
ok((only:beta(4).values - steady(alone, 8, alone_at, 1, 2)):norm() < 1e-13
  or (only:beta(4).values + steady(alone, 8, alone_at, 1, 2)):norm() < 1e-13, "beta is the velocity turned by 90 degrees")

---- more handles, holes beside them ----
-- two tori of equal triangles, one of which is left out of each and the rims are sewn together
local part = dm.mesh { torus = { 9, 6 }, radii = { 2, 1 } }
local double, cells, own = {}, part:simplices(2), part:count(0)
local seam = {}
for k = 1, 3 do seam[cells[1][k] + own] = cells[1][k] end
for k = 2, #cells do
  local second = {}
  for j = 1, 3 do second[j] = seam[cells[k][j] + own] or cells[k][j] + own end
  double[#double + 1], double[#double + 2] = cells[k], second
end
local renumber, used = {}, 0
for _, cell in ipairs(double) do
  for j = 1, 3 do
    if not renumber[cell[j]] then used = used + 1 renumber[cell[j]] = used end
  end
end
for k, cell in ipairs(double) do double[k] = { renumber[cell[1]], renumber[cell[2]], renumber[cell[3]] } end
local pretzel = dm.mesh { simplices = double, lengths = 1 }
ok(pretzel.euler == -2 and pretzel.orientable, "a surface of genus 2")
local start, along = dm.vector(used), dm.vector(pretzel:count(1))
for i = 1, used do start[i] = sin(i * i) end
for i = 1, #along do along[i] = cos(i * i) end
local knotted = pretzel:euler { vorticity = start, harmonic = along }
ok(#knotted.around == 4 and knotted.around:norm() > 0.1, "four flows round two handles")
integrals_kept(knotted:solver { h = 0.1 }:run { t = 3, every = 3 }, "genus 2")
-- a torus with a hole: the circulation along it is kept (Kelvin)
local open, hole = {}, cells[20][1]
for _, cell in ipairs(cells) do
  local inside = false
  for j = 1, 3 do inside = inside or cell[j] == hole end
  if not inside then
    local moved = {}
    for j = 1, 3 do moved[j] = cell[j] > hole and cell[j] - 1 or cell[j] end
    open[#open + 1] = moved
  end
end
local torn = dm.mesh { simplices = open, lengths = 1 }
local w = dm.vector(torn:count(0))
for i = 1, #w do w[i] = sin(i * i) end
local u = dm.vector(torn:count(1))
for i = 1, #u do u[i] = cos(i * i) end
local leaking = torn:euler { vorticity = w, harmonic = u }
ok(#leaking.around == 2 and #leaking.circulations == 0, "two flows round one handle, one loop")
local leak = leaking:solver { h = 0.1 }:run { t = 3, every = 3 }
integrals_kept(leak, "a torus with a hole")
local edge, most = torn:boundary_marks(1), 0
for e = 1, #edge do if edge[e] ~= 0 then most = math.max(most, math.abs(leak:beta(#leak)[e])) end end
ok(most < 1e-13, "nothing crosses the rim", most)
local beta, stars = leak:beta(#leak).values, torn:star_weights(1)
local stiff = torn:incidence(0):transpose() * beta:map(function(x, e) return x * stars[e] end)
local rim = torn:boundary_marks(0)
for v = 1, #rim do
  if rim[v] == 0 then most = math.max(most, math.abs(stiff[v] + torn:dual_volume(0)[v] * leak.w[#leak][v])) end
end
ok(most < 1e-12, "div beta = w", most)

-- where a surface touches itself nobody counts them, which is told
local touching, count = {}, part:count(0)
for _, cell in ipairs(cells) do
  local other = {}
  for j = 1, 3 do other[j] = cell[j] == 1 and 1 or cell[j] + count - 1 end
  touching[#touching + 1], touching[#touching + 2] = cell, other
end
ok(tostring(dm.mesh({ simplices = touching, lengths = 1 }):euler { vorticity = 0 }):find "flows round handles are left out",
  "two tori that touch")

---- runs that go on, files, refusals ----
local solver = knotted:solver { h = 0.1 }
local all, half = solver:run { steps = 10 }, solver:run { steps = 5 }
ok(dm.resume(half):run { steps = 5 }.w[6] == all.w[11] and dm.resume(half):run { steps = 5 }.around[6] == all.around[11],
  "goes on to the bit")
local state = half:checkpoint(os.tmpname())
ok(knotted:resume(state):run { steps = 5 }.around[6] == all.around[11], "from a file, too")
raises("not the flow of the checkpoint", function() driven.euler:resume(state) end)
os.remove(state)
local name = os.tmpname() .. ".npy"
all:npy(name)
ok(dm.load(name).around[11] == all.around[11], "in a file")
os.remove(name)
ok(solver:run { steps = 10, harmonic = along }.around[11] == all.around[11]
  and solver:run({ steps = 1, vorticity = start }).around[1]:norm() == 0, "a run with a start of its own")
raises("no handles", function() dm.mesh { icosphere = 1 }:euler { vorticity = 0, harmonic = rotation } end)
raises("must be a 1-form", function() K:euler { vorticity = 0, harmonic = 1 } end)
raises("must be a 1-form", function() K:euler { vorticity = 0, harmonic = false } end)
raises("384 cells", function() K:euler { vorticity = 0, harmonic = dm.vector(3) } end)
raises("must be a primal 1-form", function() K:euler { vorticity = 0, harmonic = K:form(0, dm.vector(K:count(0))) } end)
raises("this solver goes on", function() dm.resume(half):run { steps = 5, harmonic = along } end)
tap.done()
