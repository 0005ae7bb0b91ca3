--- What a reduced system shows of the bundle it came from: locked inertia, connection, curvature,
-- amended potential, lift.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local parameters = require "dm.reduce.routh.params"
local routh = require "dm.reduce.routh"

local M = {}

local TAKES = "%s takes a point of the shape space: %d number%s (got %s)"

local function time(what, t)
  if t ~= nil and not (type(t) == "number" and math.abs(t) < math.huge) then
    error(("%s: the time must be a finite number (got %s)")
      :format(what, type(t) == "number" and t or type(t)), 0)
  end
  return t or 0
end

-- x as a vector of dim shape, t (default 0)
local function place(info, what, x, t)
  return lists.numbers(what, x, info.d, TAKES), time(what, t)
end

-- the function of the shape called `name`, traced once for L as it is
local function shown(info, name, f, ...)
  model.derived(info)
  local kept = info.shown[name]
  if not kept then
    kept = core.trace(f, ...)
    info.shown[name] = kept
  end
  return kept
end

-- rows of A one after the other, as a function of (x, t)
local function connection_of(info)
  return shown(info, "connection", function(x, t)
    local A, out = model.connection(info, x, t), {}
    for a = 1, info.m do for j = 1, info.d do out[#out + 1] = A[a][j] end end
    return core.vector(out)
  end, info.d, "number")
end

-- f(...), or an error that says at which shape there is no value
local function at_shape(what, x, f, ...)
  local fine, out = blame.try(f, ...)
  if fine then return out end
  local message = tostring(out)
  if not (message:find(" is NaN ", 1, true) or message:find("infinite", 1, true)) then
    error(out, 0)
  end
  error(("%s: there is no value at the shape %s: the locked inertia is singular there (the group "
    .. "does not act freely), or it is outside of the domain of L")
    :format(what, check.text(x)), 0)
end

M.connection = blame.caller(function(shape, x, t)
  local info = routh.need(shape, "connection")
  x, t = place(info, "connection", x, t)
  local flat, rows = at_shape("connection", x, connection_of(info), x, t), {}
  for a = 1, info.m do
    rows[a] = {}
    for j = 1, info.d do rows[a][j] = flat[(a - 1) * info.d + j] end
  end
  return core.matrix(rows)
end)

M.curvature = blame.caller(function(shape, x, t, a)
  local info = routh.need(shape, "curvature")
  x, t = place(info, "curvature", x, t)
  if a ~= nil and (math.type(a) ~= "integer" or a < 1 or a > info.m) then
    error(("curvature: the component must be a whole number from 1 to %d"):format(info.m), 0)
  end
  local A = connection_of(info)
  local J, d, out = at_shape("curvature", x, A.jacobian, A, x, t), info.d, {}
  for i = 1, d do
    out[i] = {}
    for j = 1, d do
      local sum = 0
      for b = 1, info.m do
        local weight = a and (a == b and 1 or 0) or info.mu[b]
        sum = sum + weight * (J[(b - 1) * d + j][i] - J[(b - 1) * d + i][j])
      end
      out[i][j] = sum
    end
  end
  return core.matrix(out)
end)

M.symplectic_form = blame.caller(function(shape, x, t)
  local info = routh.need(shape, "symplectic_form")
  local beta, d, out = M.curvature(shape, x, t), info.d, {}
  for i = 1, d do
    out[i], out[d + i] = {}, {}
    for k = 1, d do
      out[i][k], out[i][d + k] = 0 - beta[i][k], i == k and 1 or 0
      out[d + i][k], out[d + i][d + k] = i == k and -1 or 0, 0
    end
  end
  return core.matrix(out)
end)

M.locked_inertia = blame.caller(function(shape, x, t)
  local info = routh.need(shape, "locked_inertia")
  x, t = place(info, "locked_inertia", x, t)
  return at_shape("locked_inertia", x, function()
    local _, I = model.momentum_parts(info, x, core.zeros(info.d), t)
    return core.matrix(I)
  end)
end)

--- (mu - c) . I^-1 (mu - c) at (x, t), c the momentum at rest: twice the height of the centrifugal
-- wall, by a kernel; nothing outside of the domain. L is quadratic in theta'.
function M.wall(info, x, t)
  local f = shown(info, "wall", function(y, s)
    local rate, rest = model.group_velocity(info, y, core.zeros(info.d), s)
    local sum = 0
    for a = 1, info.m do sum = sum + rest[a] * rate[a] end
    return sum
  end, info.d, "number")
  local fine, wall = blame.try(f, x, t)
  return fine and wall or nil
end

M.amended_potential = blame.caller(function(shape, x, t)
  local info = routh.need(shape, "amended_potential")
  x, t = place(info, "amended_potential", x, t)
  return -at_shape("amended_potential", x, shape.lagrangian, shape, x, core.zeros(info.d), t)
end)

-- B = mu A
local function potential_of(info, x, t)
  local A, B, d = at_shape("connection", x, connection_of(info), x, t), {}, info.d
  for j = 1, d do
    B[j] = 0
    for a = 1, info.m do B[j] = B[j] + info.mu[a] * A[(a - 1) * d + j] end
  end
  return core.vector(B)
end
M.potential_of = potential_of

M.routhian = blame.caller(function(shape, x, v, t, kind)
  local info = routh.need(shape, "routhian")
  x, t = place(info, "routhian", x, t)
  v = place(info, "routhian", v)
  local R = shape:lagrangian(x, v, t)
  if kind == nil or kind == "classical" then return R end
  if kind ~= "magnetic" then
    error("routhian: the kind must be \"classical\" or \"magnetic\"", 0)
  end
  return R - potential_of(info, x, t):dot(v)
end)

M.magnetic_momentum = blame.caller(function(shape, x, p, t)
  local info = routh.need(shape, "magnetic_momentum")
  x, t = place(info, "magnetic_momentum", x, t)
  return place(info, "magnetic_momentum", p) - potential_of(info, x, t)
end)

-- theta' as a function of (x, x', t)
function M.rate_of(info)
  local function rate(x, u, t) return core.vector((model.group_velocity(info, x, u, t))) end
  return shown(info, "rate", rate, info.d, info.d, "number")
end

M.lift = blame.caller(function(shape, x, v, theta, t)
  local info = routh.need(shape, "lift")
  x, t = place(info, "lift", x, t)
  v = place(info, "lift", v)
  theta = M.theta_list(info, theta)
  local rate = M.rate_of(info)(x, v, t)
  for a = 1, info.m do
    if not (math.abs(rate[a]) < math.huge) then
      error(("lift: there is no velocity of '%s' at this shape: the locked inertia is singular "
        .. "there"):format(info.names[info.cyclic[a]]), 0)
    end
  end
  local q, u = model.embed(info, x, theta), model.embed(info, v, rate)
  if info.ambient then return info.ambient.lift(q, u) end
  return q, u
end)

--- theta, or what is called so, as a list of m numbers.
function M.theta_list(info, theta, what)
  if theta == nil then return core.zeros(info.m) end
  return lists.numbers(what or "theta", theta, info.m, "%s must be %d number%s (got %s)")
end

local OF_FULL = "%s must be %d number%s, as in the unreduced system (got %s)"

M.start = blame.caller(function(shape, q, v, t)
  local info = routh.need(shape, "start")
  if not (info.ambient and info.ambient.on_group) then
    q = lists.numbers("start: q", q, info.n, OF_FULL)
  end
  v = lists.numbers("start: v", v, info.n, OF_FULL)
  t = time("start", t)
  if info.ambient then q, v = info.ambient.split(q, v) end
  local p = parameters.full(info):momentum(q, v, t)
  for a, i in ipairs(info.cyclic) do
    if not (math.abs(p[i] - info.mu[a]) <= 1e-10 * math.max(1, math.abs(info.mu[a]))) then
      error(("this start has the momentum %.15g of '%s', but the system was reduced at mu = "
        .. "%.15g: reduce it with q = and v = of the start "
        .. "in place of mu, or take another velocity"):format(p[i], info.names[i], info.mu[a]), 0)
    end
  end
  if info.root and not require "dm.reduce.routh.quadratic".is_branch(info, q, v, t) then
    error("L is not convex in the velocity of the group: several have the momentum of this "
      .. "start, and this reduction has another one; reduce with q = and v = of the "
      .. "start in place of mu", 0)
  end
  local x, theta = model.split(info, q)
  local u = model.split(info, v)
  return core.vector(x), core.vector(u), core.vector(theta)
end)

local reduction_class = { __name = "dm.reduction" }

function reduction_class.__tostring(r)
  local gone = {}
  for a, name in ipairs(r.group) do gone[a] = ("%s (momentum %.6g)"):format(name, r.mu[a]) end
  return ("reduction by %s of %s"):format(table.concat(gone, ", "), tostring(r.full))
end

M.reduction = blame.caller(function(shape)
  local info = routh.info(shape)
  if not info then return nil end
  local names = {}
  for a, i in ipairs(info.cyclic) do names[a] = info.names[i] end
  return setmetatable({ full = parameters.unreduced(info),
    mu = core.vector(info.mu), group = names,
    cyclic = { table.unpack(info.cyclic) }, shape = { table.unpack(info.shape) } }, reduction_class)
end)

class.method("dm.system", "connection", M.connection, [[
shape:connection(x [, t]) -> dm.matrix, dim G x dim shape
The connection A(x): theta' + A x' vanishes on horizontal velocities. The mechanical one, I^-1
dp_theta/dx', unless system:routh was given another.]])

class.method("dm.system", "curvature", M.curvature, [[
shape:curvature(x [, t] [, a]) -> dm.matrix, dim shape x dim shape
The magnetic form at momentum mu, beta_ij = d_i B_j - d_j B_i of B = mu A (the exact derivative of
the connection); with a, a number from 1 to dim G, the curvature of component a alone, without
mu.]])

class.method("dm.system", "symplectic_form", M.symplectic_form, [[
shape:symplectic_form(x [, t]) -> dm.matrix, 2 dim shape x 2 dim shape
The reduced form dx ^ ds - beta on (x, s), s = p - mu A(x): rows (-beta, 1), (-1, 0). RSPRK keeps
it; that of pairs of shapes is D:two_form.]])

class.method("dm.system", "locked_inertia", M.locked_inertia, [[
shape:locked_inertia(x [, t]) -> dm.matrix, dim G x dim G
d2L/dtheta'2 at the shape x: the inertia of the system moved by the group as a rigid body.]])

class.method("dm.system", "amended_potential", M.amended_potential, [[
shape:amended_potential(x [, t]) -> number
V_mu = V + (mu - c).I^-1 (mu - c)/2, minus the Routhian at rest (c: the momentum of the group at
rest, 0 unless L has terms linear in the velocities). Its stationary points are relative
equilibria.]])

class.method("dm.system", "routhian", M.routhian, [[
shape:routhian(x, v [, t] [, kind]) -> number
kind = "classical" (default): R = L - mu . theta' at the momentum mu, the Lagrangian of this system;
kind = "magnetic": R - mu A . x', which goes with the magnetic form of shape:curvature (Leok
2.2).]])

class.method("dm.system", "magnetic_momentum", M.magnetic_momentum, [[
shape:magnetic_momentum(x, p [, t]) -> dm.vector
s = p - mu A(x): from the canonical momentum p = dR/dx' of a path of this system to the one that
belongs to the magnetic form.]])

class.method("dm.system", "lift", M.lift, [[
shape:lift(x, v [, theta] [, t]) -> q, v
The state of the unreduced system over the state (x, v) of the shape at the momentum mu: the
velocity of the group is I^-1 (mu - dp/dx' x'). theta: where in the group, a number or list (default
0).]])

class.method("dm.system", "start", M.start, [[
shape:start(q, v [, t]) -> x, v, theta
The state of the shape under a state of the unreduced system, and where that is in the group. Raises
when its momentum is not mu.]])

class.method("dm.system", "reduction", M.reduction, [[
shape:reduction() -> {full, mu, cyclic, shape, group}
Where a reduced system comes from: the unreduced system, the momentum (a vector), the numbers of the
coordinates that were eliminated and kept, and the names of the former. Nothing for a system that is
not reduced.]])

return M
