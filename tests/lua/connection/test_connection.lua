-- discrete connections of every group of the house over bases of one to three dimensions: six data
-- that are one another, axioms, isomorphism, groupoid, limits, holonomy (Leok 4.2-4.5, E1-E5)
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local stream = dm.random(44)

-- the similarities of the line, x -> exp(s) x + b, as matrices and as vectors
local similar = dm.group { basis = { { { 1, 0 }, { 0, 0 } }, { { 0, 1 }, { 0, 0 } } } }
local function phi(s) return dm.where(s * s - 1e-12, (dm.exp(s) - 1) / dm.where(s * s - 1e-12, s, 1),
  1 + s / 2) end
local vectors = dm.group { dimension = 2, identity = { 0, 0 },
  mul = function(a, b) return { a[1] + b[1], a[2] + dm.exp(a[1]) * b[2] } end,
  inv = function(a) return { -a[1], -dm.exp(-a[1]) * a[2] } end,
  exp = function(xi) return { xi[1], phi(xi[1]) * xi[2] } end,
  log = function(g) return { g[1], g[2] / phi(g[1]) } end }

local groups = { dm.SO(2), dm.T(2), dm.R(3), dm.SE(2), dm.SO(3), dm.SE(3), dm.SU(2), dm.Heisenberg(),
  dm.SL(2), dm.GL(2), dm.Sp(2), dm.SO(4), dm.product(dm.SO(3), dm.R(2)),
  dm.product(dm.SO(2), dm.SE(2)), dm.semidirect(dm.SO(3), dm.R(3)), similar, vectors }
local bases = { dm.R(1), dm.T(2), dm.product(dm.R(1), dm.T(2)) }

local function element(G, i, size) return G:random(stream, i, size or 0.5) end

-- a random connection: exp of two terms, so that it is no exponential of one form
local function local_form(G, n)
  local d, a, b = G.dimension, {}, {}
  for i = 1, d do
    a[i], b[i] = {}, {}
    for j = 1, n do a[i][j], b[i][j] = stream:normal(i, j, 0, 0.4), stream:normal(i, 9 + j, 0, 0.3) end
  end
  a, b = dm.matrix(a), dm.matrix(b)
  return function(x0, x1)
    local dx = x1 - x0
    return G:compose(G:exp(a * dx), G:exp(b * dx * (1 + dm.sin(x0[1]) / 2 + dm.cos(x1[n]) / 3)))
  end
end

local function point(n, i)
  local x = {}
  for k = 1, n do x[k] = stream:normal(100 + i, k, 0, 0.4) end
  return dm.vector(x)
end

for k, G in ipairs(groups) do
  for _, S in ipairs(tostring(G) == "SO(3)" and bases or { bases[k % #bases + 1] }) do
    local n, name = S.dimension, ("%s over %s"):format(tostring(G), tostring(S))
    local A = dm.connection { group = G, base = S, local_form = local_form(G, n) }
    local function q(i) return { point(n, i), element(G, i) } end
    local function move(h, p) return { p[1], G:compose(h, p[2]) } end
    local function conj(h, g) return G:compose(G:compose(h, g), G:inverse(h)) end
    local q0, q1, q2, q3, h = q(1), q(2), q(3), q(4), element(G, 5)
    local check = A:check()
    ok(check.worst < 1e-12, name .. ": axioms", check.worst)

    local others = { one_form = function(a, b) return A(a, b) end,
      horizontal = function(a, b) return A:hor(a, b) end,
      lift = function(a, b, p) return A:lift(a, b, p) end,
      splitting = function(a, b) return { move(h, a), conj(h, A(a, b)) } end,
      horizontal_splitting = function(a, b)
        return { a, h }, A:lift(a, b, { a, h })
      end }
    local worst = 0
    for datum, f in pairs(others) do
      local C = dm.connection { group = G, base = S, [datum] = f, complete = false }
      worst = math.max(worst, G:distance(C(q0, q1), A(q0, q1)),
        G:distance(C:local_form(q0[1], q1[1]), A:local_form(q0[1], q1[1])))
    end
    ok(worst < 1e-12, name .. ": five other data", worst)

    local v, hor = A:ver(q0, q1), A:hor(q0, q1)
    local back = A:compose({ q0, v }, { q0, hor })
    ok(G:distance(back[2][2], q1[2]) < 1e-12, name .. ": ver . hor = id")
    ok(G:distance(A(q0, hor), G:identity()) < 1e-12
      and G:distance(A(q0, A:lift(q0[1], q1[1], q0)), G:identity()) < 1e-12
      and G:distance(A:lift(q0[1], q1[1], move(h, q0))[2],
        G:compose(h, A:lift(q0[1], q1[1], q0)[2])) < 1e-12, name .. ": lifts")

    local parts = A:split { q0, q1, q2, q3 }
    local joined = A:join(parts:at(move(h, q0)))
    worst = 0
    for k, p in ipairs { q0, q1, q2, q3 } do
      worst = math.max(worst, G:distance(joined[k][2], G:compose(h, p[2])),
        (joined[k][1] - p[1]):norm())
    end
    ok(worst < 1e-12, name .. ": k-fold isomorphism at another representative", worst)
    local class, moved = A:splitting(q0, q1), move(h, q0)
    ok(G:distance(class:at(moved)[2], A(moved, move(h, q1))) < 1e-12, name .. ": [q0, A_d]")

    local r0, r1 = move(h, q1), q2
    local a = A:compose(A:compose({ q0, q1 }, { r0, r1 }), { move(element(G, 6), r1), q3 })
    local b = A:compose({ q0, q1 }, A:compose({ r0, r1 }, { move(element(G, 6), r1), q3 }))
    ok(G:distance(a[2][2], b[2][2]) < 1e-12, name .. ": composition is associative")

    -- the limit: log A(x, x + e v)/e to the third order, and holonomy of small loops
    local x, dx = point(n, 7), point(n, 8)
    local function slope(e) return G:log(A:local_form(x, x + e * dx)) * (1 / e) end
    local e = 1e-3
    local difference = (slope(e) + slope(-e)) * (2 / 3) - (slope(2 * e) + slope(-2 * e)) / 6
    ok((A:continuous(x) * dx - difference):norm() < 1e-8, name .. ": continuous limit",
      (A:continuous(x) * dx - difference):norm())
    if n > 1 then
      local F = A:curvature(x, 1, 2)
      local function off(s)
        local u, w = dm.zeros(n), dm.zeros(n)
        u[1], w[2] = s, s
        local loop, m = {}, 1 -- the square, from direction 1 to direction 2
        for k = 0, m - 1 do loop[#loop + 1] = x + u * (k / m) end
        for k = 0, m - 1 do loop[#loop + 1] = x + u + w * (k / m) end
        for k = 0, m - 1 do loop[#loop + 1] = x + w + u * (1 - k / m) end
        for k = 0, m do loop[#loop + 1] = x + w * (1 - k / m) end
        return loop
      end
      local function holonomy(loop) return G:log(A:holonomy(loop)) end
      -- a pair and its reverse do not cancel: that part, of the order of the area too, is the mean
      -- with the loop run through in the other direction, taken away
      local function around(s)
        local loop, reverse = off(s), {}
        for k = #loop, 1, -1 do reverse[#reverse + 1] = loop[k] end
        return (holonomy(loop) - holonomy(reverse)) * (0.5 / s ^ 2)
      end
      local one, two = (around(2e-3) + F):norm(), (around(1e-3) + F):norm()
      ok(two < 1e-2 and two < 0.6 * one or two < 1e-7, name .. ": curvature", two)
    end

    -- variations add up to the whole, and match differences
    local eta = {}
    for k = 1, G.dimension do eta[k] = stream:normal(300, k, 0, 1) end
    eta = dm.vector(eta)
    local dv, dh = A:variation(q0, q1, { dx, eta })
    ok((G:Ad(A:local_form(q0[1], q1[1]), dv[2]) + dh[2] - eta):norm() < 1e-12,
      name .. ": vertical and horizontal variation")
    local function varied(s) return { q1[1] + s * dx, G:compose(q1[2], G:exp(s * eta)) } end
    local function rate(f)
      local at = f(q0, q1)[2]
      local function along(s) return G:log(G:compose(G:inverse(at), f(q0, varied(s))[2])) end
      return (along(1e-4) - along(-1e-4)) * (0.5 / 1e-4)
    end
    local off_v = (rate(function(...) return A:ver(...) end) - dv[2]):norm()
    local off_h = (rate(function(...) return A:hor(...) end) - dh[2]):norm()
    ok(off_v < 1e-6 and off_h < 1e-6, name .. ": variations by differences", off_v, off_h)
  end
end
raises("unknown option", dm.connection, { group = dm.SO(2), base = dm.R(1), localform = print })
tap.done()
