--- Relative equilibria at a level of the spatial momentum: critical points of the amended potential
-- on shapes x coadjoint orbit. The orbit is met from nu0 by nu = Ad*(exp(-eta)) nu0, eta in a
-- complement of the isotropy algebra of nu0, which moves with every step of Newton's method.
local core = require "dm.core"
local blame = require "dm.base.blame"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}


local WHERE = "level:relative_equilibria"
local STEPS, CLOSE, SAME = 60, 1e-11, 1e-6

-- an orthonormal basis of the directions along which the coadjoint action moves nu
local function directions(kit, nu, orbit)
  local values, vectors = linear.singular_values(linear.matrix_of(function(xi)
    return kit.coad(xi, nu)
  end, kit.dimension))
  local order, out = {}, {}
  for k = 1, #values do order[k] = k end
  table.sort(order, function(a, b) return values[a] > values[b] end)
  for k = 1, orbit do out[k] = vectors[order[k]] end
  return out
end

-- a basis of S x orbit among (x, eta, nu)
local function basis_of(self, nu)
  local d, n, r, out = self.space.d, self.f.n, self.space.r, {}
  for i = 1, d do out[i] = linear.unit(n + 2 * r, i) end
  for _, b in ipairs(directions(self.space.kit, nu, self.orbit)) do
    local v = core.zeros(n + 2 * r):totable()
    for a = 1, r do v[n + a] = b[a] end
    out[#out + 1] = core.vector(v)
  end
  return out
end

-- gradient and Hessian in a basis
local function restricted(basis, gradient, hessian)
  local m, g = #basis, {}
  for i = 1, m do g[i] = gradient:dot(basis[i]) end
  return core.vector(g), linear.fill(m, m, function(i, j)
    return basis[i]:dot(hessian * basis[j])
  end)
end

-- one search: { x, nu, hessian } or nothing
local function search(self, W, x, nu)
  local kit, n, r = self.space.kit, self.f.n, self.space.r
  local size = nu:norm()
  for _ = 1, STEPS do
    local zero, basis = core.zeros(r), basis_of(self, nu)
    local g, H = restricted(basis, W:gradient(x, zero, nu), W:hessian(x, zero, nu))
    local step
    if #basis == 0 then return { x = x, nu = nu, hessian = H } end
    step = H:solve(g) * -1
    local length, eta = step:norm(), core.zeros(r)
    local scale = length > 0.5 and 0.5 / length or 1
    for i, b in ipairs(basis) do
      for k = 1, self.space.d do x = x + linear.unit(n, k) * (b[k] * step[i] * scale) end
      eta = eta + lists.part(b, n, r) * (step[i] * scale)
    end
    nu = kit.coAd(kit.exp(-eta), nu)
    if g:norm() < CLOSE * (1 + size) and length < 1e-6 then
      local now = basis_of(self, nu)
      local _, hessian = restricted(now, W:gradient(x, zero, nu), W:hessian(x, zero, nu))
      return { x = x, nu = nu, hessian = hessian }
    end
  end
end

-- W(x, eta, nu): the amended potential along the orbit
local function potential(self, amended)
  local kit = self.space.kit
  local function f(x, eta, nu)
    return (amended(self, x, kit.coAd(kit.exp(-eta), nu)))
  end
  return core.trace(f, self.f.n, self.space.r, self.space.r)
end

-- is the second variation definite? Without shapes of either sign
local function is_definite(self, H)
  local values = linear.symmetric(H:totable())
  local least, most = values[1] or 1, values[#values] or 1
  local small = 1e-9 * math.max(math.abs(least), math.abs(most))
  if least > small then return true end
  return self.space.d == 0 and most < -small or nil
end

local function described(self, amended, found)
  local energy, xi = amended(self, found.x, found.nu)
  local definite = #found.hessian:totable() == 0 or is_definite(self, found.hessian)
  return core.result { x = self.space.d > 0 and found.x or core.vector {}, nu = found.nu, xi = xi,
    energy = energy, stable = definite or nil }
end

local function is_known(list, found)
  for _, row in ipairs(list) do
    local gap, size = (row.nu - found.nu):norm(), found.nu:norm()
    if gap <= SAME * size and (row.x_full - found.x):norm() < SAME then return true end
  end
end

--- level:relative_equilibria: see level.lua.
function M.find(self, amended, o)
  o = option.check(o or {}, { "x", "spread", "starts" }, WHERE, "{ x =, starts = }")
  local starts = option.whole(o, "starts", WHERE, 1, 10000, 40)
  local spread = option.positive(o, "spread", WHERE, "a deviation", 1)
  local n, d, r, kit = self.f.n, self.space.d, self.space.r, self.space.kit
  local about = core.zeros(n)
  if o.x ~= nil and d > 0 then
    about = lists.numbers(WHERE .. ": option 'x'", type(o.x) == "number" and { o.x } or o.x, d,
      "%s must be %d number%s (got %s)")
  end
  local W, stream, kept, out = potential(self, amended), core.random(271), {}, {}
  for i = 1, starts do
    local x = d > 0 and about + kits.normals(stream, 3 * i, n, spread) or core.zeros(n)
    local nu = kit.coAd(kit.exp(kits.normals(stream, 3 * i + 1, r, 1.5)), self.mu)
    local fine, found = blame.try(search, self, W, x, nu)
    if fine and found and not is_known(kept, found) then
      kept[#kept + 1] = { nu = found.nu, x_full = found.x }
      out[#out + 1] = described(self, amended, found)
    end
  end
  table.sort(out, function(a, b) return a.energy < b.energy end)
  return core.result(out)
end

return M
