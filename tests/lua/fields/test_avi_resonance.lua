-- resonances of asynchronous steps: every cell within its limit, and motions that grow as the map over a common period says (Fong, Darve, Lew 2008)
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near

-- masses 1 at 1, 2, ... between springs k[i], the last ends fixed, spring i kicks every h[i]
local function springs(k, h)
  local cells, points = {}, { { 0 } }
  for i = 1, #k do cells[i], points[i + 1] = { i, i + 1 }, { i } end
  local K = dm.mesh { simplices = cells, points = points }
  return K:field { form = 0, fixed = "boundary", data = { k = K:form(1, k) }, L = function(u, v)
    return v:dot(v) / 2 - K:sum(1, function(a, cell) return cell.k * (a[2] - a[1]) ^ 2 / 2 end, u)
  end }:solver { rule = "avi", h = h }
end

-- One mass, a fast spring w^2 that kicks n times between kicks of the slow one. Its n steps turn it
-- by phi = 2 n asin(w / (2 n)), and the map over them and one kick has the trace
-- 2 cos(phi) - slow sin(phi) / (n sin(phi / n)).
local n, slow = 10, 0.2
local function trace(w)
  local phi = 2 * n * math.asin(w / (2 * n))
  return 2 * math.cos(phi) - slow * math.sin(phi) / (n * math.sin(phi / n))
end
local function fast_and_slow(w, t)
  local s = springs({ w * w, slow }, { 1 / n, 1 })
  return s:run { q = { 0, 0.1, 0 }, v = { 0, 0.05, 0 }, t = t }, s:report()
end
for _, w in ipairs { 2.6, 3.1, 3.5 } do
  local run, off = fast_and_slow(w, 60), 0
  for i = 1, #run - 2 do
    local x = run.q[i + 1][2]
    off = math.max(off, math.abs(run.q[i + 2][2] - trace(w) * x + run.q[i][2]))
  end
  ok(#run == 61 and off < 1e-12, ("rows at w = %g are those of the map of the closed trace"):format(w), off)
end
local run, report = fast_and_slow(3.1, 500)
local rate = (-trace(3.1) + (trace(3.1) ^ 2 - 4) ^ 0.5) / 2
near(run.q[501][2] / run.q[401][2] / rate ^ 100, 1, 1e-10, "in resonance it grows as the map says, 26-fold in 100 kicks")
ok(math.abs(rate ^ 100 - 25.6) < 0.5, "by how much", rate ^ 100)
ok(report.beyond == 0 and report.resonances == 1, "no step is beyond its limit, one pair is in resonance", report.resonances)
for _, w in ipairs { 2.6, 3.5 } do
  local _, far = fast_and_slow(w, 1)
  ok(far.resonances == 0, ("and none at w = %g"):format(w), far.resonances)
end

-- it grows between phi = pi - 2 atan(slow / (2 n sin(phi / n))) and phi = pi
local least, most = 2.9, 2 * n * math.sin(math.pi / (2 * n))
local lo, hi = least, most
for _ = 1, 60 do
  local w = (lo + hi) / 2
  local phi = 2 * n * math.asin(w / (2 * n))
  if phi < math.pi - 2 * math.atan(slow / (2 * n * math.sin(phi / n))) then lo = w else hi = w end
end
local function largest(w)
  local path, x = fast_and_slow(w, 3000), 0
  for i = 1, #path do x = math.max(x, math.abs(path.q[i][2])) end
  return x
end
for _, border in ipairs { { lo, -1 }, { most, 1 } } do
  local w, out = border[1], border[2] * 1e-3
  ok(largest(w + out) < 5 and largest(w - out) > 1e5, ("the band ends at w = %.5f"):format(w), w)
end

-- strong kicks grow far from half a period, and with ratios of steps that are no whole numbers
for _, case in ipairs { { { 5.5022, 13.2388 }, { 6, 3 } }, { { 5.3418, 1.0302 }, { 2, 12 } }, { { 15.3917, 10.2288 }, { 2, 3 } } } do
  local s = springs(case[1], { case[2][1] / 10, case[2][2] / 10 })
  local path, most = s:run { q = { 0, 0.1, 0 }, v = { 0, 0.05, 0 }, t = 48 }, 0
  for i = 1, #path do most = math.max(most, math.abs(path.q[i][2])) end
  local told = s:report()
  ok(most > 2 and told.beyond == 0 and told.resonances == 1, "growth of one mass between two steps is told", most)
  s = springs({ case[1][1] / 4, case[1][2] / 4 }, { case[2][1] / 10, case[2][2] / 10 })
  path, most = s:run { q = { 0, 0.1, 0 }, v = { 0, 0.05, 0 }, t = 48 }, 0
  for i = 1, #path do most = math.max(most, math.abs(path.q[i][2])) end
  ok(most < 0.5 and s:report().resonances == 0, "and none of a quarter of the stiffness", most)
end

-- two masses, three springs of three steps, against the product of drifts and kicks of one period:
-- its eigenvalues come in pairs l, 1/l, whose sums are the roots of s^2 - tr s + minors - 2
local k, every = { 3.1 ^ 2, 0.2, 1.7 }, { 1, 10, 2 } -- steps in tenths
local function product()
  local columns = {}
  for c = 1, 4 do
    local z = { 0, 0, 0, 0 } -- q1, q2, p1, p2
    z[c] = 1
    for tenth = 1, 10 do
      z[1], z[2] = z[1] + z[3] / 10, z[2] + z[4] / 10
      local strain = { z[1], z[2] - z[1], -z[2] }
      for i = 1, 3 do
        if tenth % every[i] == 0 then
          local f = every[i] / 10 * k[i] * strain[i]
          if i > 1 then z[1 + i] = z[1 + i] + f end
          if i < 3 then z[2 + i] = z[2 + i] - f end
        end
      end
    end
    columns[c] = z
  end
  return columns
end
local P, tr, square = product(), 0, 0
for i = 1, 4 do
  tr = tr + P[i][i]
  for j = 1, 4 do square = square + P[i][j] * P[j][i] end
end
local minors = (tr ^ 2 - square) / 2
local root = (tr ^ 2 - 4 * (minors - 2)) ^ 0.5
local s = (tr - root) / 2
rate = (-s + (s ^ 2 - 4) ^ 0.5) / 2
local three = springs(k, { every[1] / 10, every[2] / 10, every[3] / 10 })
run = three:run { q = { 0, 0.1, -0.2, 0 }, v = { 0, 0.05, 0.1, 0 }, t = 800 }
ok(rate > 1.02, "the product of the maps has an eigenvalue outside the circle", rate)
near(run.q[801][2] / run.q[701][2] / rate ^ 100, 1, 1e-8, "two masses grow as the product of the maps says")
report = three:report()
ok(report.beyond == 0 and report.resonances == 1, "the fast and the slow spring are named", report.resonances)
tap.done()
