--- Back from the shape: the group variable along a path of a reduced system, its phases, holonomy
-- of a loop of shapes.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local integral = require "dm.reduce.run.integral"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local option = require "dm.base.options"
local parameters = require "dm.reduce.routh.params"
local routh = require "dm.reduce.routh"
local shape_of = require "dm.reduce.routh.shape"

local M = {}

local function info_of(path, what, system)
  local info = routh.info(system or path.system)
  if not info then error(what .. " is for a path of a reduced system (system:routh)", 0) end
  if path.watched then
    error(what .. " needs q and p, but this run recorded only what it watched", 0)
  end
  return info
end

-- the group variable at every row, m lists
local function group_along(path, info, theta)
  local rate = function(x, u, t) return model.group_velocity(info, x, u, t) end
  local out = integral.along(path, path.system, rate, info.m)
  for a = 1, info.m do
    for i = 1, #path do out[a][i] = out[a][i] + theta[a] end
  end
  return out
end

-- columns t, q, p in the coordinates (theta, x)
local function columns_of(path, info, theta)
  local n, out = info.n, { path:column "t" }
  local names = path.columns
  for j, at in ipairs(info.shape) do
    out[1 + at], out[1 + n + at] = path:column(names[1 + j]), path:column(names[1 + info.d + j])
  end
  for a, at in ipairs(info.cyclic) do
    out[1 + at] = theta[a]
    local p = {}
    for i = 1, #path do p[i] = info.mu[a] end
    out[1 + n + at] = p
  end
  return out
end

-- the same in the coordinates of the points that the action moves
local function ambient_columns(columns, info)
  local n, out, Q, P = info.n, { columns[1] }, nil, nil
  for i = 1, #columns[1] do
    local q, p = {}, {}
    for k = 1, n do q[k], p[k] = columns[1 + k][i], columns[1 + n + k][i] end
    Q, P = info.ambient.point(q, p, Q)
    local N = #Q -- flat coordinates of a group are more than its momenta
    for k = 1, N + #P do
      out[1 + k] = out[1 + k] or {}
      if k <= N then out[1 + k][i] = Q[k] else out[1 + k][i] = P[k - N] end
    end
  end
  return out
end

M.reconstruct = blame.caller(function(path, options)
  options = options or {}
  if path.system.place then
    return require "dm.reduce.run.on_group".reconstruct(path, options)
  end
  option.check(options, { "theta" }, "path:reconstruct")
  local del = require "dm.reduce.discrete.del"
  local D = del.of(path.system)
  local info = info_of(path, "path:reconstruct", D and D.shape)
  local theta = shape_of.theta_list(info, options.theta)
  local columns = D and del.columns(D, path, theta)
    or columns_of(path, info, group_along(path, info, theta))
  if info.ambient then columns = ambient_columns(columns, info) end
  return core.path { system = parameters.unreduced(info), h = path.h,
    rule = path.rule, steps = path.steps,
    columns = columns }
end)

local phases_class = { __name = "dm.phases" }

function phases_class.__tostring(p)
  local last, out = #p.total, {}
  for a = 1, #p.total[last] do
    out[a] = ("%.9g = %.9g dynamic + %.9g geometric")
      :format(p.total[last][a], p.dynamic[last][a], p.geometric[last][a])
  end
  return ("phases of %d rows; the group has come %s"):format(last, table.concat(out, "; "))
end

M.phases = blame.caller(function(path)
  if path.system.place then return require "dm.reduce.run.phases".of_path(path) end
  local info = info_of(path, "path:phases")
  local rest = {}
  for j = 1, info.d do rest[j] = 0 end
  local both = integral.along(path, path.system, function(x, u, t)
    local all, still = model.group_velocity(info, x, u, t), model.group_velocity(info, x, rest, t)
    local out = {}
    for a = 1, info.m do out[a], out[info.m + a] = all[a], still[a] end
    return out
  end, 2 * info.m)
  local total, dynamic, geometric = {}, {}, {}
  for i = 1, #path do
    total[i], dynamic[i], geometric[i] = {}, {}, {}
    for a = 1, info.m do
      total[i][a], dynamic[i][a] = both[a][i], both[info.m + a][i]
      geometric[i][a] = both[a][i] - both[info.m + a][i]
    end
  end
  return setmetatable({ total = core.matrix(total), dynamic = core.matrix(dynamic),
    geometric = core.matrix(geometric) }, phases_class)
end)

-- the ends of a loop are the same shape; angles, on dm.T(n), up to whole turns
local function check_closed(shape, gap)
  local turned, rest = core.vector(gap), gap:norm()
  for j = 1, #gap do turned[j] = gap[j] - 2 * math.pi * math.floor(gap[j] / (2 * math.pi) + 0.5) end
  if rest <= 1e-9 or kits.are_angles(shape.Q) and turned:norm() <= 1e-9 then return end
  error(("holonomy: the loop does not close: its ends are %.3g apart%s"):format(rest,
    turned:norm() <= 1e-9
      and ", whole turns; with Q = dm.T(n) coordinates are angles and a turn is a loop" or ""), 0)
end

local LOOP = "%s must give a shape, %d number%s (got %s)"

M.holonomy = blame.caller(function(shape, loop, options)
  local info = routh.need(shape, "holonomy")
  options = options or {}
  option.check(options, { "t", "steps" }, "shape:holonomy")
  if type(loop) ~= "function" then
    error("holonomy: the loop must be a function of one number from 0 to 1", 0)
  end
  local steps = option.whole(options, "steps", "shape:holonomy", 2, nil, 256)
  local t = option.number(options, "t", "shape:holonomy", nil, 0)
  loop = core.one(loop, "the loop")
  local function point(s) return lists.numbers("holonomy: the loop", loop(s), info.d, LOOP) end
  local curve = core.trace(point, "number")
  check_closed(shape, curve(1) - curve(0))
  local sum = {}
  for a = 1, info.m do sum[a] = 0 end
  for k = 0, steps - 1 do
    local s = k / steps
    local A, dx = shape:connection(curve(s), t), curve:jacobian(s)
    for a = 1, info.m do
      for j = 1, info.d do sum[a] = sum[a] - A[a][j] * dx[j][1] / steps end
    end
  end
  return core.vector(sum)
end)

class.method("dm.path", "reconstruct", M.reconstruct, [[
path:reconstruct{theta=} -> dm.path
From a path of a reduced system to the one of the unreduced system over it: the group variable is
the integral of I^-1(mu - ...) by the rule's own quadrature, theta + h sum_j b_j theta'_j over the
stages of every step, at every row that was kept. theta: the group variable at the first row, a
number or list (default 0). Of dm.euler_poincare: path:reconstruct{q = g0}, the path on the group
that begins at the element g0.]])

class.method("dm.path", "phases", M.phases, [[
path:phases() -> {total, dynamic, geometric}
How far the group variable has come along a path of a reduced system. On SO(3) or SU(2), alone or
as one factor of Q: dm.vectors of a number a row, about the spatial momentum J and not wrapped.
total is the turn of g_k S g_0^-1 about J, S the shortest rotation from the first body momentum to
that of row k; dynamic sums what turn a step has beyond the shortest rotation between its body
momenta; geometric is minus the area of their geodesic polygon, closed to the start; the sum is
exact for the rows that are kept. Raises where J is not kept or rows are half a turn apart. Of an
abelian group each is a dm.matrix, #path x dim G: dynamic, h sum_j b_j I^-1 (mu - c) over the
stages, what the momentum alone would turn, and geometric, -h sum_j b_j A x', the holonomy of the
mechanical connection along the shapes (Marsden, Montgomery & Ratiu 1990).]])

class.method("dm.system", "holonomy", M.holonomy, [[
shape:holonomy(loop [, {t=, steps=}]) -> dm.vector of dim G entries
-closed integral A . dx of the connection along a loop of shapes: loop(s) for 0 <= s <= 1 with
loop(0) = loop(1) (where Q = dm.T(n): up to whole turns), a function of one number that can be
traced; by the trapezoidal rule with `steps` points (default 256), which for a smooth loop errs less
than any power of 1/steps.]])

return M
