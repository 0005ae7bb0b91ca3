-- steps that end exactly where constraints depend on each other leave a velocity open: they are refused by name, since
-- any value of it solves their equations
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

-- q1 = q2 = q4 = 0 but where q3 = 0; the start falls along q3 through there
local function rows(q, v) return { v[1] - q[3] * v[2], v[4] - v[2], v[1] + q[3] * v[2] } end
local function plain(q, v) return v:dot(v) / 2 - q[4] end
local function curved(q, v) return (1 + 0.1 * q[1] ^ 2 + 0.2 * q[4] ^ 2) * v:dot(v) / 2 - q[4] end
local all = { "midpoint", "trapezoidal", "gauss(2)", "lobatto(3)", "galerkin(2, gauss(3))", "curve(rk4)" }
local systems = {
  { "rolling", "rolling", dm.system { Q = dm.R(4), L = plain, rolling = rows } },
  { "rolling, mass of q", "rolling", dm.system { Q = dm.R(4), L = curved, rolling = rows } },
  { "holonomic", "constraint", dm.system { Q = dm.R(4), L = plain, constraint = function(q) return rows(q, q) end } },
}
for _, case in ipairs(systems) do
  local name, key, system = table.unpack(case)
  for _, rule in ipairs(key == "rolling" and all or { "gauss(2)", "rattle", "curve(rk4)" }) do
    local fine, failure = pcall(function()
      return system:solver { rule = rule, h = 0.05 }:run { q = { 0, 0, -1, 0 }, v = { 0, 0, 1, 0 }, steps = 100 }
    end)
    ok(not fine and failure[key] == 3 and #failure.path < 23, ("%s: %s names the row at the place"):format(name, rule), failure)
  end
  -- steps that pass by it at a distance have nothing open, where the rows say no more than velocities
  for _, rule in ipairs(key == "rolling" and { "gauss(2)", "lobatto(3)", "trapezoidal" } or {}) do
    local path = system:solver { rule = rule, h = 0.05 }:run { q = { 0, 0, -1.02, 0 }, v = { 0, 0, 1, 0 }, steps = 100 }
    ok(path:drift "energy".largest < 1e-12, ("%s: %s passes beside it"):format(name, rule), path)
  end
end

-- units: a wheel of radius 1e7 and more has rows that are nearly parallel in coordinates, and not in its motion, which is
-- a circle of twice that radius
for _, R in ipairs { 1e-8, 1e7, 1e8, 1e12 } do
  local wheel = dm.system { Q = dm.R(4), L = function(_, v) return (v[1] ^ 2 + v[2] ^ 2) / 2 + R ^ 2 * (v[3] ^ 2 / 4 + v[4] ^ 2 / 8) end,
    rolling = function(q, v) return { v[1] - R * dm.cos(q[4]) * v[3], v[2] - R * dm.sin(q[4]) * v[3] } end }
  local path = wheel:solver { rule = "gauss(2)", h = 0.05 }:run { q = { 0, 0, 0, 0.3 }, v = { R * math.cos(0.3), R * math.sin(0.3), 1, 0.5 },
    steps = 200 }
  tap.near(path.q[#path][1] / R, 2 * (math.sin(5.3) - math.sin(0.3)), 1e-8, ("a wheel of radius %g rolls"):format(R))
end
tap.done()
