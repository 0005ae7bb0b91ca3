-- symplectic partitioned Runge-Kutta pairs: special cases agree, orders, violations named
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local cos, sin, sqrt = math.cos, math.sin, math.sqrt

local twisted = dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 * (1 + q[1] ^ 2 / 3 + q[2] ^ 2 / 5) + v[1] * v[2] * sin(q[2]) / 3 + cos(q[1]) * cos(q[2])
end }
local plain = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + cos(q[1]) * cos(q[2] - q[1] / 3) end }
local driven = dm.system { Q = dm.R(2), L = function(q, v, t) return v:dot(v) / 2 + cos(q[1] - t) * cos(q[2] - q[1] / 3) end }
local systems = { general = twisted, separable = plain, driven = driven }
local start = { q = { 0.4, 0.3 }, v = { 0.5, 0.7 } }
local function final(system, rule, n)
  local path = system:solver { rule = rule, h = 2 / n }:run { q = start.q, v = start.v, steps = n, every = n }
  return path.q[#path], path.p[#path]
end
local function agree(a, b, sentence, skip)
  for name, system in pairs(systems) do
    if name ~= skip then
      local q, p = final(system, a, 40)
      local Q, P = final(system, b, 40)
      near((q - Q):norm() + (p - P):norm(), 0, 2e-14, sentence .. ", L " .. name)
    end
  end
end

-- tableaus written out against the rows with names
local A = dm.sprk { a = { { 0 } }, b = { 1 }, A = { { 1 } }, B = { 1 } }
local B = dm.sprk { a = { { 1 } }, b = { 1 } }
local verlet = dm.sprk { a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 0.5, 0.5 }, A = { { 0.5, 0 }, { 0.5, 0 } }, B = { 0.5, 0.5 } }
local midpoint = dm.sprk { a = { { 0.5 } }, b = { 1 } }
local x = sqrt(3) / 6
local gauss = dm.sprk { a = { { 0.25, 0.25 - x }, { 0.25 + x, 0.25 } }, b = { 0.5, 0.5 }, name = "my gauss" }
-- HLW table II.1.2 and II.1.4: Lobatto IIIA and IIIB of three stages
local lobatto = dm.sprk {
  a = { { 0, 0, 0 }, { 5 / 24, 1 / 3, -1 / 24 }, { 1 / 6, 2 / 3, 1 / 6 } }, b = { 1 / 6, 2 / 3, 1 / 6 },
  A = { { 1 / 6, -1 / 6, 0 }, { 1 / 6, 1 / 3, 0 }, { 1 / 6, 5 / 6, 0 } }, B = { 1 / 6, 2 / 3, 1 / 6 } }
local mirrored = dm.sprk { a = { { 1 / 6, -1 / 6, 0 }, { 1 / 6, 1 / 3, 0 }, { 1 / 6, 5 / 6, 0 } }, b = { 1 / 6, 2 / 3, 1 / 6 }, c = { 0, 0.5, 1 } }
agree(A, "symplectic-euler(a)", "tableau of symplectic Euler (a)")
agree(B, "symplectic-euler(b)", "tableau of symplectic Euler (b)")
agree(verlet, "verlet", "tableau of Stoermer-Verlet")
agree(verlet, "lobatto(2)", "which is the Lobatto pair of 2 stages")
agree(midpoint, "midpoint", "tableau of the midpoint rule")
agree(gauss, "gauss(2)", "tableau of Gauss")
agree(lobatto, "lobatto(3)", "tableau of Lobatto IIIA-IIIB")
agree(mirrored, "sprk(lobatto-3b-3a, 3)", "tableau of Lobatto IIIB-IIIA")
agree("symplectic-euler", "symplectic-euler(a)", "symplectic Euler without a letter is (a)")
agree("galerkin(1, radau(1))", "symplectic-euler(b)", "L at the end of the step")
agree("galerkin(1, radau-left(1))", "symplectic-euler(a)", "L at its start")
agree("sprk(gauss, 3)", "gauss(3)", "sprk(gauss, s)")
agree("sprk(lobatto-3a-3b, 3)", "lobatto(3)", "sprk(lobatto-3a-3b, s)")
agree("sprk(radau-2a, 3)", "galerkin(3, radau(3))", "sprk(radau-2a, s)")
agree("galerkin(1, lobatto(2))", "trapezoidal", "the trapezoidal rule")
-- for L = T(v) - V(q) the trapezoidal rule is Stoermer-Verlet
near((final(plain, "trapezoidal", 40) - final(plain, "verlet", 40)):norm(), 0, 1e-14, "trapezoidal is Verlet where L separates")

-- third order with kicks and drifts, b and B differ (Ruth 1983)
local third = { a = { { 7 / 24, 0, 0 }, { 7 / 24, 3 / 4, 0 }, { 7 / 24, 3 / 4, -1 / 24 } }, b = { 7 / 24, 3 / 4, -1 / 24 },
  A = { { 0, 0, 0 }, { 2 / 3, 0, 0 }, { 2 / 3, -2 / 3, 0 } }, B = { 2 / 3, -2 / 3, 1 } }
local ruth = dm.sprk(third)
ok(ruth.order == 3, "Ruth's table has order 3", ruth.order)

-- orders: what the rule says is what it shows
local function order(system, rule, n)
  local reference = final(system, "gauss(8)", 40)
  return math.log((final(system, rule, n) - reference):norm() / (final(system, rule, 2 * n) - reference):norm(), 2)
end
for _, row in ipairs { { A, 1, 1600 }, { B, 1, 1600 }, { verlet, 2, 100 }, { midpoint, 2, 100 }, { gauss, 4, 40 }, { lobatto, 4, 40 },
  { mirrored, 4, 40 }, { "symplectic-euler(a)", 1, 1600 }, { "symplectic-euler(b)", 1, 1600 }, { "sprk(gauss, 2)", 4, 40 },
  { "sprk(radau-1a, 1)", 1, 1600 }, { "sprk(radau-1a, 2)", 3, 80 }, { "sprk(radau-1a, 3)", 5, 40 }, { "sprk(radau-2a, 2)", 3, 80 },
  { "sprk(radau-2a, 3)", 5, 40 }, { "sprk(lobatto-3b-3a, 2)", 2, 100 }, { "sprk(lobatto-3b-3a, 3)", 4, 40 },
  { "sprk(lobatto-3b-3a, 4)", 6, 16 }, { "sprk(lobatto-3a-3b, 4)", 6, 16 } } do
  local rule, p, n = table.unpack(row)
  ok(twisted:solver({ rule = rule, h = 1 }).order == p, tostring(rule) .. " says order " .. p)
  near(order(twisted, rule, n), p, 0.06, "measured")
end
-- rows of a whose sums are not c
near(order(plain, "sprk(lobatto-3b-3a, 2)", 100), 2, 0.05, "measured where L separates: lobatto-3b-3a, 2 stages")
near(order(plain, "sprk(lobatto-3b-3a, 3)", 40), 4, 0.05, "and 3")
agree("sprk(radau-1a, 1)", "symplectic-euler(b)", "sprk(radau-1a, 1) is symplectic Euler but for the time", "driven")
near(order(plain, ruth, 100), 3, 0.05, "measured: Ruth")
local path = plain:solver { rule = ruth, h = 0.1 }:run { q = start.q, v = start.v, steps = 20000, every = 20 }
near(path:drift("energy").per_time, 0, 1e-7, "no drift of the energy with b and B different")
ok(gauss.name == "my gauss" and tostring(gauss) == "rule my gauss", "a rule has the name it is given")

ok(verlet.symmetric and not A.symmetric and gauss.symmetric and mirrored.symmetric, "symmetry is read off the tableau")

-- violations
raises("b_i A_ij + B_j a_ji - b_i B_j = -0.25 at i = 1, j = 1", function() dm.sprk { a = { { 0.5 } }, b = { 1 }, A = { { 0.25 } }, B = { 1 } } end)
raises("= 0.25 at i = 1, j = 2", function()
  dm.sprk { a = { { 0, 0 }, { 0.5, 0.5 } }, b = { 0.5, 0.5 }, A = { { 0.5, 0.5 }, { 0.5, 0 } }, B = { 0.5, 0.5 } }
end)
raises("B_1 - b_1 = -0.25", function()
  dm.sprk { a = { { 0.25, 0.25 }, { 0.25, 0.25 } }, b = { 0.5, 0.5 }, A = { { 0.125, 0.375 }, { 0.125, 0.375 } }, B = { 0.25, 0.75 } }
end)
raises("b_2 is zero", function() dm.sprk { a = { { 0.5, 0 }, { 1, 0 } }, b = { 1, 0 } } end)
raises("add up to 1", function() dm.sprk { a = { { 0.5 } }, b = { 0.5 } } end)
raises("A and B together", function() dm.sprk { a = { { 0.5 } }, b = { 1 }, A = { { 0.5 } } } end)
raises("2 rows", function() dm.sprk { a = { { 0.5 } }, b = { 0.5, 0.5 } } end)
raises("row 2 of field 'a'", function() dm.sprk { a = { { 0.5, 0 }, { 1 } }, b = { 0.5, 0.5 } } end)
raises("field 'b'", function() dm.sprk { a = { { 0.5 } } } end)
raises("L = T(v) - V(q, t)", function() twisted:solver({ rule = ruth, h = 0.1 }):run { q = start.q, v = start.v, steps = 1 } end)
for rule, words in pairs { ["sprk"] = "takes a pair", ["sprk(euler, 2)"] = "radau-2a", ["sprk(gauss, 0)"] = "from 1", ["sprk(lobatto-3a-3b, 1)"] = "Lobatto: 2",
  ["symplectic-euler(c)"] = "with a or b", ["symplectic-euler(1)"] = "with a or b" } do
  raises(words, function() plain:solver { rule = rule, h = 0.1 } end)
end
tap.done()
