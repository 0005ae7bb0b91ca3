-- Lagrangians with no value at v = 0, whose velocities have one sign: steps are found from any start;
-- and speed limits that depend on q, which are no change of inertia
local tap = require "tap"
local dm = require "dm"
local ok, near = tap.ok, tap.near
local abs, log, max = math.abs, math.log, math.max

-- v + q^2/2 = E is the energy of both signs of L = v log |v| - v - q^2/2, so q = s a tanh(a t/2 + c)
local function entropy(sign)
  return dm.system { Q = dm.R(1), L = function(q, v)
    local u = sign * v[1]
    return sign * (u * dm.log(u) - u) - sign * q[1] ^ 2 / 2
  end }
end
local function exact(q, v, t) -- q' = v + (q0^2 - q^2)/2
  local a = math.sqrt(2 * v + q ^ 2)
  local c = 0.5 * log((a + q) / (a - q))
  local e = math.exp(2 * (a * t / 2 + c))
  return a * (e - 1) / (e + 1)
end
local starts = { { 0.3, 0.5 }, { -0.5, 1.5 }, { 0.9, 0.2 }, { -0.8, 0.02 } }
local rules = { { "verlet", 2 }, { "midpoint", 2 }, { "trapezoidal", 2 }, { "gauss(2)", 4 }, { "lobatto(3)", 4 },
  { "galerkin(2, gauss(3))", 4 }, { "symplectic-euler", 1 }, { "del", 2 }, { "curve(rk4)", 4 } }
for _, row in ipairs(rules) do
  local rule, order = table.unpack(row)
  for _, sign in ipairs { 1, -1 } do
    local system, worst = entropy(sign), { 0, 0 }
    for _, start in ipairs(starts) do
      for k, n in ipairs { 20, 40 } do
        local q, v, h = sign * start[1], sign * start[2], 2 / n
        local solver = rule == "del" and dm.solver { dm.discrete_lagrangian(system, { rule = "midpoint", h = h }) }
          or system:solver { rule = rule, h = h }
        local fine, path = pcall(solver.run, solver, { q = { q }, p = system:momentum({ q }, { v }), steps = n })
        if not fine then
          ok(false, ("%s from q = %g, v = %g"):format(rule, q, v), path)
          worst[k] = 0 / 0
        else
          worst[k] = max(worst[k], abs(path.q[n + 1][1] - sign * exact(sign * q, sign * v, 2)))
        end
      end
    end
    near(log(worst[1] / worst[2], 2), order, 0.4, ("%s, sign %d: of order %d"):format(rule, sign, order))
  end
end
-- beside a coordinate that may go both ways
local both = dm.system { Q = dm.R(2), L = function(q, v)
  return v[1] * dm.log(v[1]) - v[1] + v[2] ^ 2 / 2 - q[1] ^ 2 / 2 - q[2] ^ 2 / 2
end }
for _, start in ipairs(starts) do
  for _, w in ipairs { -1, 1 } do
    local path = both:solver { rule = "gauss(3)", h = 0.05 }:run { q = { start[1], 0 }, v = { start[2], w }, steps = 40 }
    near(path.q[41][1], exact(start[1], start[2], 2), 1e-9, "one of two coordinates")
    near(path.q[41][2], w * math.sin(2), 1e-9, "and the other")
  end
end

-- L = -m sqrt(1 - v^2/m) - 2 q^4, m = 1 + q^2: d2L/dv2 = (1 - v^2/m)^(-3/2) has no zero. The speed at one end of a step
-- may be above the limit at the other, which told of a change of inertia.
local limit = dm.system { Q = dm.R(1), L = function(q, v)
  local m = 1 + q[1] ^ 2
  return -m * (1 - v[1] ^ 2 / m) ^ 0.5 - 2 * q[1] ^ 4
end }
for _, row in ipairs { { -0.9487631576567, -0.27528338840801, 0.25218323679375 }, { -0.82367813868033, 0.88992543856733, 0.24216385109273 },
  { -0.93423885423429, -0.38649732796027, 0.2291198827825 } } do
  for _, rule in ipairs { "verlet", "midpoint", "gauss(2)", "gauss(3)", "symplectic-euler" } do
    local fine, path = pcall(function()
      return limit:solver { rule = rule, h = row[3] }:run { q = { row[1] }, v = { row[2] }, steps = 200 }
    end)
    ok(fine and #path == 201, rule .. " under a speed limit that depends on q", path)
    if rule:find "gauss" then ok(path:drift "energy".largest < 0.2, "and keeps the energy in a band", path) end
  end
end
tap.done()
