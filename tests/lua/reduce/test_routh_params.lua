-- parameters and momentum of reduced systems as parameters: members with values of their own are reductions at these values, bit for bit
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local sqrt, cos, sin, max, abs = math.sqrt, math.cos, math.sin, math.max, math.abs

-- separable after reduction: parameters are inputs of one kernel for explicit rules
local function satellite(J2)
  return dm.system { Q = dm.R(3), coordinates = { "theta", "r", "z" }, params = { J2 = J2 or 0.05, k = 1 }, L = function(q, v, _, p)
    local rho2 = q[2] ^ 2 + q[3] ^ 2
    return (v[2] ^ 2 + v[3] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 + p.k / sqrt(rho2) - p.J2 / sqrt(rho2) ^ 3 * (1.5 * q[3] ^ 2 / rho2 - 0.5)
  end }
end
-- mass of the shape varies, the momentum has a part of the shape
local function arm(m)
  return dm.system { Q = dm.R(2), coordinates = { "theta", "r" }, params = { m = m or 1.5, k = 4 }, L = function(q, v, _, p)
    return p.m * (1 + q[2] ^ 2) * v[1] ^ 2 / 2 + 0.4 * q[2] * v[1] * v[2] + p.m * v[2] ^ 2 / 2 * (1 + q[2] ^ 4) - p.k * q[2] ^ 2 / 2
  end }
end
-- not quadratic in theta': an implicit function
local function stiff(m)
  return dm.system { Q = dm.R(2), coordinates = { "theta", "r" }, params = { m = m or 1.5 }, L = function(q, v, _, p)
    return p.m * (q[2] ^ 2 * v[1] ^ 2 + v[2] ^ 2) / 2 + v[1] ^ 4 / 4 - q[2] ^ 2
  end }
end
-- constraint and force, with parameters in all three
local function rod(l)
  return dm.system { Q = dm.R(3), coordinates = { "theta", "r", "z" }, params = { l = l or 1, c = 0.1 },
    L = function(q, v) return (v[2] ^ 2 + v[3] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 - 9.81 * q[3] end,
    constraint = function(q, _, p) return (q[2] ^ 2 + q[3] ^ 2) / p.l ^ 2 - 1 end, force = function(_, v, _, p) return { 0, -p.c * v[2], -p.c * v[3] } end }
end

local cases = {
  { "satellite", satellite, "J2", { 0.05, 0.02, 0.07 }, mu = { 0.96, 0.8, 0.9 }, q = { 1, 0.1 }, v = { 0.1, 0.2 }, rules = { "verlet", "kahan-li(6)", "gauss(1)", "gauss(2)" } },
  { "arm", arm, "m", { 1.5, 1, 2 }, mu = { 1, 0.8, -1.2 }, q = { 0.7 }, v = { 0.3 }, rules = { "gauss(1)", "lobatto(3)" } },
  { "implicit", stiff, "m", { 1.5, 1, 2 }, mu = { 1, 0.8, 1.2 }, q = { 0.7 }, v = { 0.3 }, rules = { "gauss(2)" } },
  { "rod", rod, "l", { 1, 1, 1 }, mu = { 0.5, 0.8, 1.2 }, q = { 0.6, -0.8 }, v = { 0.4, 0.3 }, rules = { "gauss(2)" } },
}
for _, case in ipairs(cases) do
  local name, make, parameter, values = table.unpack(case)
  local shape = make():routh { cyclic = { "theta" }, mu = case.mu[1] }
  for _, rule in ipairs(case.rules) do
    local many = shape:solver({ rule = rule, h = 0.05 }):ensemble { members = 3, steps = 60, q = function() return case.q end,
      v = function() return case.v end, vary = { mu = case.mu, [parameter] = values } }
    local same, turned = true, 0
    for i = 1, 3 do
      local own = make(values[i]):routh { cyclic = { "theta" }, mu = case.mu[i] }
      local path = own:solver({ rule = rule, h = 0.05 }):run { q = case.q, v = case.v, steps = 60 }
      same = same and many.status[i] == "ok" and many.q[i] == path.q[61] and many.p[i] == path.p[61]
      for k = 1, #case.q do same = same and many.q[i][k] == path.q[61][k] and many.p[i][k] == path.p[61][k] end
      turned = max(turned, abs(path.p[61][1] - path.p[1][1]))
    end
    ok(same and turned > 1e-3, name .. ", " .. rule .. ": members with mu and " .. parameter .. " of their own are reductions at these, bit for bit")
  end
end

-- what belongs to a member knows its values
local shape = satellite():routh { cyclic = { "theta" }, mu = 0.96 }
local many = shape:solver({ rule = "gauss(2)", h = 0.1 }):ensemble { members = 2, steps = 40, every = 1, q = function() return { 1, 0 } end,
  v = function() return { 0, 0.28 } end, vary = { mu = { 0.8, 0.96 }, k = { 1, 1.1 } } }
do
  local member = many:path(1)
  local own = satellite():routh { cyclic = { "theta" }, mu = 0.8 }
  local path = own:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 0.28 }, steps = 40 }
  ok(dm.compare(member:reconstruct(), path:reconstruct()).worst == 0, "a member's path goes back to the unreduced system at its momentum")
  ok(member:energy()[41] == path:energy()[41] and member.system.params.mu == 0.8, "energy of a member")
  ok(member.system:amended_potential { 1, 0.2 } == own:amended_potential { 1, 0.2 } and member.system:reduction().mu[1] == 0.8, "and its amended potential")
  ok(many:path(2).system:amended_potential { 1, 0.2 } ~= shape:amended_potential { 1, 0.2 }, "other parameters, another potential")
  ok(shape.params.mu == 0.96 and shape:at_momentum(0.5).params.mu == 0.5 and shape.params.J2 == 0.05, "params of a shape are those of the system, and mu")
end

-- an action in ambient coordinates; a group of two dimensions; a parameter that is called mu
local plane = dm.system { Q = dm.R(2), params = { k = 1, mu = 3 }, L = function(q, v, _, p) return v:dot(v) / 2 - p.mu * p.k * q:dot(q) ^ 2 end }
local polar = plane:routh { action = function(t, q) return { cos(t) * q[1] - sin(t) * q[2], sin(t) * q[1] + cos(t) * q[2] } end,
  section = function(x) return { x[1], 0 } end, mu = 0.7 }
ok(polar.params.mu == 3 and polar.params.mu_theta == 0.7 and polar.params.k == 1, "mu of the group has another name where a parameter has it")
local rings = polar:solver({ rule = "gauss(1)", h = 0.05 }):ensemble { members = 2, steps = 30, q = function() return { 1 } end, v = function() return { 0 } end,
  vary = { mu_theta = { 0.7, 0.9 }, k = { 1, 2 } } }
local ring = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - 6 * q[1] ^ 4 - 0.81 / (2 * q[1] ^ 2) end }
near(rings.q[2][1], ring:solver({ rule = "gauss(1)", h = 0.05 }):run { q = { 1 }, v = { 0 }, steps = 30 }.q[31][1], 1e-13, "an action: the centrifugal term by hand")
local torus = dm.system { Q = dm.R(3), coordinates = { "a", "b", "x" }, L = function(q, v)
  return (v[1] ^ 2 * (1 + q[3] ^ 2) + v[1] * v[2] + 2 * v[2] ^ 2 + v[3] ^ 2) / 2 - q[3] ^ 2
end }:routh { cyclic = { "a", "b" }, mu = { 1, 0.5 } }
local two = torus:solver({ rule = "gauss(2)", h = 0.1 }):ensemble { members = 2, steps = 20, q = function() return { 1 } end, v = function() return { 0 } end,
  vary = { mu1 = { 1, 2 } } }
local other = torus:at_momentum({ 2, 0.5 }):solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 20 }
ok(two.q[2][1] == other.q[21][1] and two.q[1][1] ~= other.q[21][1], "mu1 and mu2 of a group of two dimensions")

-- one kernel for all members of a separable shape, whatever their values; plain calls at other values do not reduce again
do
  local wide = shape:solver({ rule = "verlet", h = 0.05 }):ensemble { members = 100, steps = 10, q = function() return { 1, 0 } end, v = function() return { 0, 0.2 } end,
    vary = { mu = function(i) return 0.5 + i / 200 end } }
  local last = satellite():routh { cyclic = { "theta" }, mu = 1 }:solver({ rule = "verlet", h = 0.05 }):run { q = { 1, 0 }, v = { 0, 0.2 }, steps = 10 }
  ok(wide.systems == 1 and wide.q[100][1] == last.q[11][1], "100 momenta, one system", wide.systems)
  near(shape.L(dm.vector { 1, 0.1 }, dm.vector { 0.1, 0.2 }, 0, { mu = 0.5, J2 = 0.02, k = 2 }),
    dm.system({ Q = dm.R(3), coordinates = { "theta", "r", "z" }, params = { J2 = 0.02, k = 2 }, L = satellite().L }):routh({ cyclic = { "theta" }, mu = 0.5 })
      :lagrangian({ 1, 0.1 }, { 0.1, 0.2 }), 1e-15, "a plain call at other values")
end

-- a map over the momentum; params that change later are seen; what is no parameter
local map = dm.stability { system = shape, rule = "gauss(2)", h = 0.1, mu = { 0.9, 1.2, 4, "linear" }, q = { 1, 0 }, v = { 0, 0.1 }, steps = 100 }
ok(#map == 4 or tostring(map):find("mu", 1, true), "a stability map over mu", tostring(map))
local numbers = { k = 1 }
local later = dm.system { Q = dm.R(2), params = numbers, L = function(q, v, _, p) return (v[2] ^ 2 + q[2] ^ 2 * v[1] ^ 2) / 2 - p.k * q[2] ^ 2 end }
local reduced = later:routh { cyclic = { 1 }, mu = 1 }
local V = reduced:amended_potential { 2 }
numbers.k = 2
near(reduced:amended_potential { 2 } - V, 4, 1e-14, "params of the system that change are seen")
reduced.params.mu = 0.5
near(reduced:amended_potential { 2 }, 2 * 4 + 0.25 / 8, 1e-14, "beside another momentum, too")
raises("'nu' is not a number among the params", function()
  shape:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 1, steps = 1, q = function() return { 1, 0 } end, v = function() return { 0, 0 } end, vary = { nu = { 1 } } }
end)

-- what is set in the params of a shape, and what members vary, is in the paths that come back
do
  local full = arm()
  local arm_shape = full:routh { cyclic = { "theta" }, mu = 1 }
  local rule, start = { rule = "gauss(2)", h = 0.05 }, { q = { 0.7 }, v = { 0.3 }, steps = 40 }
  local function compare(path, m, mu, what)
    local own = arm(m):routh { cyclic = { "theta" }, mu = mu }:solver(rule):run(start)
    local back, want = path:reconstruct(), own:reconstruct()
    ok(dm.compare(back, want).worst == 0 and back:energy()[41] == want:energy()[41], what)
    ok(back.system.params.m == m and path.system:reduction().mu[1] == mu, what .. ": params")
  end
  local members = arm_shape:solver(rule):ensemble { members = 2, q = function() return start.q end, v = function() return start.v end, steps = 40, every = 1, vary = { m = { 1.5, 2 }, mu = { 1, 1.1 } } }
  compare(members:path(2), 2, 1.1, "the path of a member, brought back")
  compare(members:path(1), 1.5, 1, "the path of one with the values of the shape")
  arm_shape.params.mu = 0.8
  local path = arm_shape:solver(rule):run(start)
  compare(path, 1.5, 0.8, "another momentum that was set")
  arm_shape.params.m = 2
  raises("or have its params changed since", path.reconstruct, path)
  local again = arm_shape:solver(rule):run(start)
  compare(again, 2, 0.8, "another mass that was set")
  local q, v = arm_shape:lift({ 0.7 }, { 0.3 })
  local x, u = arm_shape:start(q, v)
  near(x[1] + u[1], 1, 1e-15, "a start at these")
end
tap.done()
