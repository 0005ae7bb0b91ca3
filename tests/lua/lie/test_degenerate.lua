-- An inertia that is singular to round-off at the start is refused, with the direction in which it
-- is: steps from there were made of round-off, and every rule made others.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local MOMENTS = { 0.7, 1.1, 1.4, 0.9, 1.2, 0.8 }
local U = { 0.4, -0.3, 0.25, 0.1, -0.2, 0.35 }
local RULES = { "gauss(1)", "gauss(2)", "lie(1)", "lie(2)", "verlet", "lobatto(3)" }

-- inertia without the direction A u where f(g) = 0
local function with(G, f)
  local d = G.dimension
  return dm.system { Q = G, L = function(g, w)
    local size, along, T = 0, 0, 0
    for i = 1, d do
      size, along = size + MOMENTS[i] * U[i] ^ 2, along + MOMENTS[i] * U[i] * w[i]
      T = T + MOMENTS[i] * w[i] ^ 2
    end
    return (T - along ^ 2 * (1 - f(g)) / size) / 2 - 0.3 * (f(g) + 1)
  end }
end

local function refused(G, f, g0, v, what)
  local system = with(G, f)
  for _, rule in ipairs(RULES) do
    local solver = system:solver { rule = rule, h = 0.01 }
    local fine, why = pcall(solver.run, solver, { q = g0, v = v, steps = 3 })
    ok(not fine and tostring(why):find "degenerate at the start: d2L/dv2 is zero to round%-off along",
      ("%s, %s: refused"):format(what, rule), why)
  end
  for _, rule in ipairs { "lie(1)", "gauss(2)" } do
    local lost = system:solver { rule = rule, h = 0.01 }:ensemble { members = 9, steps = 3,
      q = function() return g0 end, v = function() return v end }:failures()
    ok(#lost == 9 and lost[9].code == "singular" and lost[9].step == 1
      and lost[9].message:find "degenerate at the start: d2L/dv2 is zero to round%-off along", what .. ", " .. rule .. ": members, too",
      #lost .. (lost[9] and lost[9].code .. lost[9].message or ""))
  end
end

local near = { 0.3, -0.5, 0.8, 0.4, 0.1, -0.2 }
for _, case in ipairs { { dm.SO(3), function(g) return g[1][2] end },
  { dm.SU(2), function(g) return g[2] end }, { dm.SE(3), function(g) return g[1][2] end },
  { dm.SL(2), function(g) return g[1][2] end } } do
  local G, entry = table.unpack(case)
  local d = G.dimension
  local g0, v = G:exp { table.unpack(near, 1, d) }, { table.unpack(near, 1, d) }
  local there = entry(g0)
  refused(G, function(g) return (entry(g) - there) ^ 2 end, g0, v, tostring(G))
  refused(G, function(g) return entry(g) - there end, g0, v, tostring(G) .. ", changing sign")
end

-- an own moment, not round-off of others: what cosine leaves of one
local angle = math.cos(0.7)
local tilted = dm.system { Q = dm.SO(3), L = function(g, w)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + (g[3][3] - angle) * w[3] ^ 2) / 2
end }
local _, why = pcall(function()
  tilted:solver { rule = "gauss(2)", h = 0.01 }:run { q = dm.SO(3):exp { 0.7, 0, 0 },
    v = { 0.1, 0.2, 0 }, steps = 1 }
end)
ok(tostring(why):find "along xi = %(0, 0, 1%)", "the direction of a moment that is zero", why)

-- small moments, small and large units of them, are not
for _, small in ipairs { 1e-6, 1e-12, 1e-30 } do
  local thin = dm.system { Q = dm.SO(3), L = function(g, w)
    return (w[1] ^ 2 + 2 * w[2] ^ 2 + small * (1.5 + g[3][3]) * w[3] ^ 2) / 2
  end }
  ok(thin:solver { rule = "lie(1)", h = 0.01 }:run { q = dm.SO(3):identity(), v = { 0, 0, 0.2 },
    steps = 3 }, ("a moment of %g is stepped"):format(small))
end

---- folds of the momentum ----

-- x^4/4 - x^2/2 along u, whose p = x^3 - x has a fold at x = 3^-1/2: each p there belongs to two
-- velocities, at the fold to one that is found to the root of round-off
local function folded(G, along, side)
  local d = G.dimension
  return dm.system { Q = G, trivialization = side, L = function(g, w)
    local x, T = 0, 0
    for i = 1, d do x = x + along[i] * w[i] end
    for i = 1, d do T = T + (1 + 0.1 * i) * (w[i] - along[i] * x) ^ 2 / 2 end
    return T + x ^ 4 / 4 - x ^ 2 / 2 - 0.1 * g[1][2]
  end }
end

local FOLD = { 0.6, 0, 0.8, 0, 0, 0 }
for _, G in ipairs { dm.SO(3), dm.SE(3), dm.SL(2), dm.SO(4), dm.GL(2) } do
  local d = G.dimension
  local g0 = G:exp { table.unpack(near, 1, d) }
  for _, side in ipairs { "left", "right" } do
    for _, along in ipairs { { 1, 0, 0, 0, 0, 0 }, FOLD } do
      local system, v, what = folded(G, along, side), {}, ("%s, %s, fold"):format(G, side)
      local function start(x)
        local rest = 0
        for i = 1, d do rest = rest + along[i] * U[i] end
        for i = 1, d do v[i] = U[i] + (x - rest) * along[i] end
        return { q = g0, v = v, steps = 2 }
      end
      for _, rule in ipairs { "lie(1)", "lie(2)", "rkmk4" } do
        local solver = system:solver { rule = rule, h = 1e-8 }
        local _, said = pcall(solver.run, solver, start(3 ^ -0.5))
        ok(tostring(said):find("degenerate at the start: d2L/dv2 is zero to round-off along xi = ("
          .. (along == FOLD and "0.75, 0, 1" or "1, 0, 0"), 1, true), what .. ", " .. rule, said)
        local lost = solver:ensemble { members = 3, steps = 2, q = function() return g0 end,
          v = function() return v end }:failures()
        ok(#lost == 3 and lost[3].code == "singular" and lost[3].step == 1
          and lost[3].message:find "degenerate at the start", what .. ": members, " .. rule)
      end
      local path = system:solver { rule = "lie(1)", h = 1e-8 }:run(start(3 ^ -0.5 - 1e-3))
      local energy = path:energy()
      ok(math.abs(energy[3] - energy[1]) < 1e-9, what .. ": 1e-3 beside it is stepped")
      local closer = system:solver { rule = "rkmk4", h = 1e-10 }
      local _, closest = pcall(closer.run, closer, start(3 ^ -0.5 - 1e-5))
      ok(not tostring(closest):find "at the start", what .. ": 1e-5 beside it is none", closest)
    end
  end
end
for _, rule in ipairs { "gauss(2)", "verlet", "rk4" } do
  local flat = dm.system { Q = dm.R(2), L = function(_, v)
    return v[1] ^ 4 / 4 - v[1] ^ 2 / 2 + v[2] ^ 2 / 2
  end }
  local _, said = pcall(function()
    flat:solver { rule = rule, h = 0.01 }:run { q = { 0, 0 }, v = { 3 ^ -0.5, 1 }, steps = 1 }
  end)
  ok(tostring(said):find("round-off along v = (1, 0)", 1, true), "a fold on R^2, " .. rule, said)
end

tap.done()
