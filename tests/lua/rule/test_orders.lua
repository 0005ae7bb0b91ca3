-- orders of rules, measured on Kepler's ellipse and on the double spherical pendulum in angles
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local sin, cos, pi = math.sin, math.cos, math.pi

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local e, T = 0.6, 4
-- from the far end of the ellipse through the near one, exactly by Kepler's equation
local far = { q = { -1 - e, 0 }, v = { 0, -0.8 / (1 + e) } }
local E = pi + T
for _ = 1, 60 do E = E - (E - e * sin(E) - pi - T) / (1 - e * cos(E)) end
local exact = dm.vector { cos(E) - e, 0.8 * sin(E) }

local pendulum = dm.system { Q = dm.R(4), L = function(q, v)
  local function velocity(a, b, da, db)
    return da * cos(a) * cos(b) - db * sin(a) * sin(b), da * cos(a) * sin(b) + db * sin(a) * cos(b), da * sin(a)
  end
  local x1, y1, z1 = velocity(q[1], q[2], v[1], v[2])
  local x2, y2, z2 = velocity(q[3], q[4], v[3], v[4])
  local Ek = (x1 * x1 + y1 * y1 + z1 * z1) / 2 + ((x1 + x2) ^ 2 + (y1 + y2) ^ 2 + (z1 + z2) ^ 2) / 2
  return Ek + 9.81 * (2 * cos(q[1]) + cos(q[3]))
end }
local swing = { q = { 1, 0, 0.7, 0.4 }, v = { 0, 1.5, 0, 2 } }
local function final(system, rule, start, t, n)
  local path = system:solver { rule = rule, h = t / n }:run { q = start.q, v = start.v, steps = n, every = n }
  return path.q[#path]
end
local reference = final(pendulum, "gauss(8)", swing, 1, 400)
near((reference - final(pendulum, "rk8pd", swing, 1, 4000)):norm(), 0, 1e-13, "two independent references agree")

-- on the ellipse these two show the order of their next terms until round-off comes; Henon-Heiles shows their own
local henon = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q:dot(q) / 2 + q[1] ^ 2 * q[2] - q[2] ^ 3 / 3) end }
local inside = { q = { 0.1, 0 }, v = { 0, 0.5 } }
local cut = dm.vector { 0, 0 } -- the mean of several, since round-off of one is 2 % of the least error below
for _, n in ipairs { 600, 700, 800, 900, 1000, 1200, 1400, 1600 } do cut = cut + final(henon, "gauss(8)", inside, 20, n) / 8 end

-- rule, order, steps over T on Kepler (0: not), steps over 1 on the pendulum (0: not), steps over 20 on Henon-Heiles; the
-- finer of two runs has twice as many
local rows = {
  { "verlet", 2, 800, 800 }, { "midpoint", 2, 800, 800 }, { "trapezoidal", 2, 800, 800 },
  { "gauss(1)", 2, 800, 800 }, { "gauss(2)", 4, 400, 400 }, { "gauss(3)", 6, 200, 100 }, { "gauss(4)", 8, 100, 50 },
  { "lobatto(2)", 2, 800, 800 }, { "lobatto(3)", 4, 400, 400 }, { "lobatto(4)", 6, 200, 100 },
  { "galerkin(1, gauss(1))", 2, 800, 800 }, { "galerkin(2, gauss(2))", 4, 400, 400 }, { "galerkin(2, gauss(3))", 4, 400, 400 },
  { "galerkin(2, lobatto(3))", 4, 400, 400 }, { "galerkin(3, gauss(3))", 6, 200, 100 }, { "galerkin(3, lobatto(4))", 6, 200, 100 },
  { "galerkin(4, gauss(4))", 8, 100, 50 },
  { "galerkin(2, clenshaw-curtis(3))", 4, 400, 400 }, { "galerkin(3, clenshaw-curtis(4))", 4, 400, 400 },
  { "galerkin(3, clenshaw-curtis(5))", 6, 200, 100 }, { "galerkin(4, clenshaw-curtis(6))", 6, 200, 100 },
  { "yoshida(4)", 4, 1600, 200 }, { "yoshida(6)", 6, 400, 200 }, { "suzuki(4)", 4, 800, 100 }, { "mclachlan(4)", 4, 400, 100 },
  { "kahan-li(6)", 6, 200, 100 }, { "kahan-li(8)", 8, 100, 60 }, { "suzuki-umeno(8)", 8, 150, 70 },
  { "sofroniou-spaletta(10)", 10, 0, 0, 48 }, { "kahan-li(6, midpoint)", 6, 400, 0 }, { "yoshida(4, trapezoidal)", 4, 1600, 0 },
  { "blanes-moan(4)", 4, 0, 0, 200 }, { "blanes-moan(6)", 6, 200, 0 }, { "blanes-moan(6, 14)", 6, 100, 0 },
  { "rk4", 4, 800, 400 }, { "rkf45", 5, 800, 200 }, { "rk8pd", 8, 70, 40 }, { "rk8", 8, 70, 40 },
  { "rattle", 2, 800, 0 }, { "shake", 2, 800, 0 }, -- with constraints: test_rattle.lua
}
local function order(system, rule, start, t, n, goal)
  local coarse, fine = (final(system, rule, start, t, n) - goal):norm(), (final(system, rule, start, t, 2 * n) - goal):norm()
  return math.log(coarse / fine, 2), fine
end
for _, row in ipairs(rows) do
  local rule, p, n1, n2, n3 = table.unpack(row)
  if n1 > 0 then
    local measured, left = order(kepler, rule, far, T, n1, exact)
    ok(math.abs(measured - p) < 0.05 and left > 1e-14, ("%s on Kepler: order %d"):format(rule, p), measured .. " with " .. left .. " left")
  end
  if n2 > 0 then
    local measured, left = order(pendulum, rule, swing, 1, n2, reference)
    ok(math.abs(measured - p) < 0.05 and left > 1e-14, ("%s on the double spherical pendulum: order %d"):format(rule, p), measured .. " with " .. left .. " left")
  end
  if n3 then
    local measured, left = order(henon, rule, inside, 20, n3, cut)
    ok(math.abs(measured - p) < 0.05 and left > 1e-14, ("%s on Henon-Heiles: order %d"):format(rule, p), measured .. " with " .. left .. " left")
  end
  ok(kepler:solver({ rule = rule, h = 1 }).order == p, rule .. " says so")
end
tap.done()
