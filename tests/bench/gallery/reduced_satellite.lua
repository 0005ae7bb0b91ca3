-- the J2 satellite of Leok 2.9 without its angle, next to the whole of it in cylindrical coordinates
local dm = require "dm"
local J2 = 0.05
local whole = dm.system { Q = dm.R(3), L = function(q, v)
  local r, z = q[2], q[3]
  local rho = math.sqrt(r * r + z * z)
  return (v[2] ^ 2 + r * r * v[1] ^ 2 + v[3] ^ 2) / 2 + 1 / rho - J2 / rho ^ 3 * (1.5 * z * z / rho ^ 2 - 0.5)
end }
local steps = { 0.4, 0.2, 0.1, 0.05, 0.025 }
return {
  title = "J2 satellite without its angle, and in cylindrical coordinates",
  text = [[Reduced by its angle the satellite has two coordinates and a constant mass, so that explicit splittings and lane-parallel Gauss rules step it; with
the angle ("unreduced": error of all three coordinates) the mass varies, and the same Gauss rule costs several times as much. For four digits rk8 on
the whole wins, whose set-up is shorter; from six on gauss(6) on what is reduced does.]],
  { whole:routh { cyclic = { 1 }, mu = 0.96 }, q = { 1, 0 }, v = { 0, 0.28 }, t = 100,
    rules = { "verlet", "blanes-moan(6)", "gauss(2)", "gauss(4)", "gauss(6)", "rk4", "rk8" }, h = steps },
  { whole, q = { 0, 1, 0 }, v = { 0.96, 0, 0.28 }, t = 100, rules = { "gauss(2)", "gauss(4)", "rk8" }, h = steps, suffix = "unreduced" },
}
