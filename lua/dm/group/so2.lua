--- SO(2): angles in rad, and what n of them share, T(n).
local acts = require "dm.group.acts"
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local pi = math.pi

--- The angle between -pi and pi.
function M.principal(x)
  if type(x) ~= "number" then return core.atan(core.sin(x), core.cos(x)) end
  if x > -pi and x <= pi then return x end
  local y = math.fmod(x, 2 * pi)
  if y > pi then return y - 2 * pi end
  return y <= -pi and y + 2 * pi or y
end

--- Rotations of the planes (1, 2), (3, 4) ...
function M.rotations(angles)
  local n = #angles
  local out = core.zeros(2 * n, 2 * n):totable()
  for k = 1, n do
    local c, s = core.cos(angles[k]), core.sin(angles[k])
    local i, j = 2 * k - 1, 2 * k
    out[i][i], out[i][j], out[j][i], out[j][j] = c, -s, s, c
  end
  return core.matrix(out)
end

local function of_entries(f)
  return function(x) return core.vector(x):map(f) end
end

--- What of a vector of n angles is the same for one.
function M.circles(n)
  local kit = { dimension = n, abelian = true, vectors = true, angles = {} }
  for k = 1, n do kit.angles[k] = true end
  kit.exp = core.vector
  kit.log = of_entries(M.principal)
  function kit.Ad(_, xi) return xi end
  function kit.ad() return core.zeros(n) end
  function kit.coAd(_, mu) return mu end
  function kit.dexp(_, eta) return eta end
  kit.dexpinv = kit.dexp
  kit.cayley = of_entries(function(x) return 2 * core.atan(0.5 * x) end)
  kit.cayleyinv = of_entries(function(x)
    local y = 2 * core.tan(0.5 * x)
    if type(y) == "number" and math.abs(y) > 1e12 then
      error("the Cayley map does not reach a rotation by pi", 0)
    end
    return y
  end)
  function kit.dcay(xi, eta)
    return core.vector(eta):map(function(y, k) return y / (1 + 0.25 * xi[k] * xi[k]) end)
  end
  function kit.dcayinv(xi, eta)
    return core.vector(eta):map(function(y, k) return y * (1 + 0.25 * xi[k] * xi[k]) end)
  end
  function kit.hat(xi)
    local out = core.zeros(2 * n, 2 * n):totable()
    for k = 1, n do out[2 * k - 1][2 * k], out[2 * k][2 * k - 1] = -xi[k], xi[k] end
    return core.matrix(out)
  end
  function kit.vee(m)
    local out = {}
    for k = 1, n do out[k] = 0.5 * (m[2 * k][2 * k - 1] - m[2 * k - 1][2 * k]) end
    return core.vector(out)
  end
  function kit.from_matrix(m)
    local out = {}
    for k = 1, n do out[k] = core.atan(m[2 * k][2 * k - 1], m[2 * k - 1][2 * k - 1]) end
    return core.vector(out)
  end
  function kit.sample(stream, i)
    local out = {}
    for k = 1, n do out[k] = stream:uniform(i, k - 1, -pi, pi) end
    return core.vector(out)
  end
  -- the mean over the group by the trapezoidal rule, exact for harmonics below `points`: elements
  -- and weights
  function kit.mean(points)
    local out, total = {}, points ^ n
    for i = 0, total - 1 do
      local angles, rest = {}, i
      for k = 1, n do angles[k], rest = 2 * pi * (rest % points) / points, rest // points end
      out[#out + 1] = { core.vector(angles), 1 / total }
    end
    return out
  end
  return kit
end

-- a turn of the entries i and i + 1 of the list z
local function turned(theta, z, i)
  local c, s, out = core.cos(theta), core.sin(theta), kits.list_of(z)
  out[i], out[i + 1] = c * z[i] - s * z[i + 1], s * z[i] + c * z[i + 1]
  return out
end

-- of the plane, and about the third axis of space
local function linear(m)
  if m ~= 2 and m ~= 3 then return nil end
  return function(theta, z) return core.vector(turned(theta, z, 1)) end
end

-- of the last two coordinates of the sphere
local stereographic = acts.stereographic(function(m)
  return function(theta, Y) return turned(theta, Y, m) end
end)

--- SO(2): one angle, a bare number.
function M.kit()
  local kit = M.circles(1)
  kit.form, kit.acts = "a number, the angle", { linear = linear, stereographic = stereographic }
  local exp, log, cayley, sample = kit.exp, kit.log, kit.cayley, kit.sample
  function kit.identity() return 0 end
  function kit.element(g) return kits.scalar(g, "the group element") end
  function kit.compose(a, b) return a + b end
  function kit.inverse(g) return -g end
  function kit.exp(xi) return exp(xi)[1] end
  function kit.log(g) return log { g } end
  function kit.cayley(xi) return cayley(xi)[1] end
  local cayleyinv = kit.cayleyinv
  function kit.cayleyinv(g) return cayleyinv { g } end
  function kit.sample(stream, i) return sample(stream, i)[1] end
  local mean = kit.mean
  function kit.mean(points)
    local out = mean(points)
    for i = 1, #out do out[i][1] = out[i][1][1] end
    return out
  end
  function kit.matrix(g) return M.rotations { g } end
  local from_matrix = kit.from_matrix
  function kit.from_matrix(m) return from_matrix(m)[1] end
  kit.project, kit.raw = M.principal, kit.element
  function kit.entries(g) return { g } end
  function kit.rebuild(list) return list[1] end
  function kit.turns() return { 2 * pi } end
  return kits.complete(kit)
end

return M
