--- shape:relative_equilibria: found by Newton's method from many starts.
local balance = require "dm.reduce.equilibria.stationary"
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local option = require "dm.base.options"
local routh = require "dm.reduce.routh"

local M = {}

local abs, max = math.abs, math.max

---- what they look like ----

local Equilibria = { __name = "dm.relative_equilibria" }

function Equilibria.__tostring(list)
  local out = { ("%d relative equilibri%s"):format(#list, #list == 1 and "um" or "a") }
  for _, e in ipairs(list) do out[#out + 1] = "  " .. tostring(e) end
  return table.concat(out, "\n")
end

--- What a shape was made from, for one without time, constraints and forces; options checked.
function M.need(shape, what, options, known)
  local info = routh.need(shape, what)
  option.check(options, known, what)
  routh.need_autonomous(info, what)
  if info.full.given.constraint or routh.is_driven(info) then
    error(what .. ": with constraints or forces balance is another equation; give coordinates "
      .. "without them", 0)
  end
  return info
end

---- finding them ----

local function check_region(region, d)
  if d == 1 and type(region) == "table" and type(region[1]) == "number" then region = { region } end
  if type(region) ~= "table" or #region ~= d then
    error(("relative_equilibria: option 'region' must be a list of %d pairs { least, most }, one "
      .. "for each coordinate of the shape"):format(d), 0)
  end
  for i, pair in ipairs(region) do
    local fine = type(pair) == "table" and type(pair[1]) == "number" and type(pair[2]) == "number"
    if not fine or not (pair[1] <= pair[2] and pair[1] > -math.huge and pair[2] < math.huge) then
      error(("relative_equilibria: 'region'[%d] must be a pair { least, most } of finite numbers")
        :format(i), 0)
    end
  end
  return region
end

-- the first n primes
local function primes(n)
  local out, k = {}, 1
  while #out < n do
    k = k + 1
    local is = true
    for _, p in ipairs(out) do is = is and k % p ~= 0 end
    if is then out[#out + 1] = k end
  end
  return out
end

-- the k-th number of van der Corput's sequence in a base: Halton's points fill a region evenly
local function radical(k, base)
  local f, out = 1 / base, 0
  while k > 0 do
    out, k, f = out + f * (k % base), k // base, f / base
  end
  return out
end

-- that many points in a region
local function fill(region, count)
  local out, bases = {}, primes(#region)
  for k = 1, count do
    out[k] = {}
    for i, pair in ipairs(region) do
      out[k][i] = pair[1] + (pair[2] - pair[1]) * radical(k, bases[i])
    end
  end
  return out
end

-- of each coordinate: the width of the region, or the size of what is held at one value there
local function lengths_of(region)
  local out = {}
  for i, pair in ipairs(region) do
    local width = pair[2] - pair[1]
    out[i] = width > 0 and width or pair[1] ~= 0 and abs(pair[1]) or 1
  end
  return out
end

local function inside(x, region, length)
  for i, pair in ipairs(region) do
    local rim = 1e-9 * length[i]
    if not (x[i] >= pair[1] - rim and x[i] <= pair[2] + rim) then return false end
  end
  return true
end

local function is_new(list, x, length)
  for _, e in ipairs(list) do
    local apart = 0
    for i = 1, #x do apart = max(apart, abs(e.x[i] - x[i]) / length[i]) end
    if apart < 1e-6 then return false end
  end
  return true
end

-- a mirror image of one that is there: the same energy, velocity and values
local function is_copy(list, e)
  for _, other in ipairs(list) do
    local turned = abs(e.mu:dot(e.velocity)) + abs(e.energy)  -- the energy itself may be 0
    local near = abs(other.energy - e.energy) <= 1e-8 * turned
      and (other.velocity - e.velocity):norm() <= 1e-8 * e.velocity:norm()
    if near and other.index == e.index then return true end
  end
  return false
end

-- of what it is in the middle of the points: less is a place where the group does not act freely,
-- or the coordinates have a pole
local POLE = 1e-9

local function size_of_det(A)
  local det = abs(core.matrix(A):det())
  return det < math.huge and det or 0
end

-- |det| of the locked inertia and of the mass that is left, at x; 0, 0 outside of the domain
local function regularity(info, R, mu, x)
  local fine, inertia, mass = blame.try(function()
    local _, I = model.momentum_parts(info, x, lists.zeros(info.d), 0)
    return size_of_det(I), size_of_det(balance.mass(R, x, mu, info.d))
  end)
  if not fine then return 0, 0 end
  return inertia, mass
end

-- what there is to both among the points, times POLE
local function least_regular(info, R, mu, points)
  local inertias, masses = {}, {}
  for k, x in ipairs(points) do inertias[k], masses[k] = regularity(info, R, mu, x) end
  table.sort(inertias)
  table.sort(masses)
  local middle = #points // 2 + 1
  return { inertia = POLE * inertias[middle], mass = POLE * masses[middle] }
end

local function is_regular(info, R, mu, x, least)
  local inertia, mass = regularity(info, R, mu, x)
  return inertia > least.inertia and mass > least.mass
end

M.relative_equilibria = blame.caller(function(shape, options)
  local info = M.need(shape, "relative_equilibria", options,
    { "region", "starts", "copies" })
  local region, d = options.region, info.d
  region = check_region(region, d)
  local starts = option.whole(options, "starts", "relative_equilibria", 1, nil, 200)
  local V, R, mu = balance.potential(info), balance.routhian(info), core.vector(info.mu)
  local list, points, scale = setmetatable({}, Equilibria), fill(region, starts), nil
  scale = balance.scale(V, points, lengths_of(region), mu, d)
  local least = least_regular(info, R, mu, points)
  for _, x in ipairs(points) do
    local found = balance.stationary(V, x, mu, d, scale)
    if found and inside(found, region, scale.length) and is_new(list, found, scale.length)
      and is_regular(info, R, mu, found, least) then
      local fine, e = blame.try(balance.describe, info, R, V, found, mu)
      if fine and e and not (options.copies == false and is_copy(list, e)) then
        list[#list + 1] = e
      end
    end
  end
  table.sort(list, function(a, b) return a.energy < b.energy end)
  return list
end)

class.method("dm.system", "relative_equilibria", M.relative_equilibria, [[
shape:relative_equilibria{region=, starts=, copies=} -> list of {x, mu, energy, velocity, ...}
Motions along the group alone: stationary points of the amended potential in the region, a pair {
least, most } for each coordinate of the shape, found by Newton's method from `starts` points
(default 200) that fill it. velocity: of the group; index, flat: negative directions of V_mu, and
those in which it has no slope; values: {re, im}, the characteristic values of small motions, with
the magnetic term; stable: "energy" (a minimum of V_mu), "spectral" (all values imaginary) or false.
Poles of the coordinates, also where the group does not act freely (a top upright, all rods
vertical), are left out. copies = false: mirror images, with the same energy, velocity and index,
are listed once. print shows the list.]])

return M
