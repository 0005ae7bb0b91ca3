--- Is it a symmetry? Looked at where the derivatives are exact: at points in the domain, the first
-- that says no is named.
local blame = require "dm.base.blame"
local core = require "dm.core"
local linear = require "dm.base.linear"
local everywhere = require "dm.reduce.routh.everywhere"
local lists = require "dm.base.lists"

local M = {}

local abs, max, middle = math.abs, math.max, lists.middle
local TRIES, ENOUGH, TOLERANCE = 80, 12, 1e-10

-- numbers between -1 and 1, the same in every run
local function generator()
  local state = 12345
  return function()
    state = (state * 1103515245 + 12345) % 2 ^ 31
    return state / 2 ^ 30 - 1
  end
end

-- tries near a start, or below 1, and what these are multiplied with then
local NEAR, FARTHER = 8, { 2.5, 0.4, 6, 1.6 }

-- a point near `at` or farther out, or anywhere: most tries are positive and below 1, then
-- larger ones of either sign
local function point(random, try, n, at)
  local out, times = {}, FARTHER[try - NEAR] or 1
  for i = 1, n do
    local r = random()
    if at then
      out[i] = times * at[i] + (try == 1 and 0 or 0.1 * r)
    elseif times ~= 1 then
      out[i] = times * (0.9 + 0.5 * r)
    elseif try <= TRIES // 2 then
      out[i] = 0.4 + 0.35 * r
    else
      out[i] = 2 * r
    end
  end
  return out
end

--- Points (q, v, t) at which f(q, v, t) is finite, at most `enough` (ENOUGH) of them; about the
-- start where one is given.
function M.points(n, f, start, enough)
  local random, out = generator(), {}
  enough = enough or ENOUGH
  for try = 1, TRIES do
    local near = start and try <= TRIES / 4
    local q = point(random, try, n, near and start.q or nil)
    local v = point(random, try, n, near and start.v or nil)
    local t = 0.3 * abs(random())
    if blame.try(f, q, v, t) then
      out[#out + 1] = { q = core.vector(q), v = core.vector(v), t = t }
    end
    if #out == enough then break end
  end
  return out
end

local function text(x)
  local out = {}
  for i = 1, #x do out[i] = ("%.6g"):format(x[i]) end
  return "{" .. table.concat(out, ", ") .. "}"
end
M.text = text

local function at(p)
  return ("q = %s, v = %s, t = %.6g"):format(text(p.q), text(p.v), p.t)
end
M.at = at

-- the same in the coordinates that the user has: those which an action moves, where there is one;
-- on a group (theta, x)
local function place(info, p)
  if not info.ambient or info.ambient.on_group then return at(p) end
  local q, v = info.ambient.lift(p.q, p.v)
  return at { q = q, v = v, t = p.t }
end

-- how far the group coordinates are moved from where a point has them, one or the other by turns
local AWAY = { 1, -2.6, 4.3, -5.9, 8.1, -11.7, 29, -37 }

-- q of point k with the group coordinates somewhere else, and how far
local function moved(info, p, k)
  local q, by = {}, AWAY[(k - 1) % #AWAY + 1]
  for i = 1, info.n do q[i] = p.q[i] end
  for a, i in ipairs(info.cyclic) do q[i] = q[i] + by * (0.7 + 0.3 * a) end
  return core.vector(q), by
end
M.AWAY = AWAY

-- A group that stretches (boosts, scalings) makes elements whose velocities g^-1 dg have few digits
-- left, or moves points so far that their invariants have: how many times more than TOLERANCE is
-- round-off at q, 1 at least. Asked for where something is off by more than that alone.
local ROUNDING = 1e-14
local function slack(info, q)
  local on = info.ambient
  if not on then return 1 end
  local fine, size = blame.try(on.condition, q)
  return fine and max(1, ROUNDING / TOLERANCE * size) or 1
end

local NO_SYMMETRY = "L is not invariant under the action: it changes by %.6g along '%s' at %s"

---- sizes, in the units that a user has ----

--- The middle size of entry i of the lists one[key], one of `seen`.
function M.usual(seen, key)
  local out = {}
  for i = 1, seen[1] and #seen[1][key] or 0 do
    local sizes = {}
    for k, one in ipairs(seen) do sizes[k] = abs(one[key][i] or 0) end
    out[i] = middle(sizes)
  end
  return out
end

-- the largest term g_i z_i, an energy: coordinates of all units are compared in it
local function energy(g, z)
  local size = 0
  for i = 1, #z do size = max(size, abs(g[i] * z[i])) end
  return size
end

-- |x|, 1 at least: how far the group coordinate x goes
local function reach(x) return max(1, abs(x)) end

---- L ----

local NO_SLOPE = "L is not invariant, or not smooth: it has no derivative at %s, which the group "
  .. "moves other points to (%s)"

-- dL/dtheta = 0 at a point, beside terms of this size
local function check_slope(info, g, p, size)
  for _, i in ipairs(info.cyclic) do
    local off, room = abs(g[i]) * reach(p.q[i]), TOLERANCE * size
    if off > room and off > room * slack(info, p.q) then
      if info.ambient then error(NO_SYMMETRY:format(g[i], info.names[i], place(info, p)), 0) end
      error(("L is not invariant under translations of '%s': dL/d%s = %.6g at %s")
        :format(info.names[i], info.names[i], g[i], at(p)), 0)
    end
  end
end

--- dL/dtheta = 0 at all points, where the group has moved them too; slope(q, v, t) is the gradient
-- of L. Points get `energy`, the size of the terms of L there.
function M.lagrangian(info, slope)
  local seen, sizes = {}, {}
  for k, p in ipairs(info.points) do
    local z = {}
    for i = 1, info.n do z[i], z[info.n + i] = p.q[i], p.v[i] end
    for l, there in ipairs { p, { q = moved(info, p, k), v = p.v, t = p.t } } do
      local fine, g = blame.try(slope, there.q, there.v, there.t)
      if fine then
        seen[#seen + 1], sizes[#sizes + 1] = { g = g, p = there }, energy(g, z)
        p.energy = l == 1 and sizes[#sizes] or p.energy
      elseif l == 1 or slack(info, there.q) == 1 then
        error(NO_SLOPE:format(place(info, there), tostring(g)), 0)
      end
    end
  end
  local usual = middle(sizes)
  for k, one in ipairs(seen) do check_slope(info, one.g, one.p, max(sizes[k], usual)) end
  return usual
end

local FAR = 40 -- of group coordinates

-- samples (q, v, t) as lists, with the group at either end
local function samples_of(info)
  local out = {}
  for k, p in ipairs(info.points) do
    local z = {}
    for i = 1, info.n do z[i], z[info.n + i] = p.q[i], p.v[i] end
    z[#z + 1] = p.t
    for _, i in ipairs(info.cyclic) do z[i] = k % 2 == 0 and FAR / 3 or -FAR / 3 end
    out[k] = z
  end
  return out
end

--- The same between the points: where bounds of dL/dtheta leave something, it is looked for there.
-- usual: the energy of M.lagrangian.
function M.between(info, slope, usual)
  local n, low, high = info.n, everywhere.box(samples_of(info))
  for _, i in ipairs(info.cyclic) do
    local function f(z)
      return slope(lists.part(z, 0, n), lists.part(z, n, n), z[2 * n + 1])[i]
    end
    local function look(z)
      local p = { q = lists.part(z, 0, n), v = lists.part(z, n, n), t = z[2 * n + 1] }
      local known, g = blame.try(slope, p.q, p.v, p.t)
      local terms = table.move(z, 1, 2 * n, 1, {})
      for _, k in ipairs(info.cyclic) do terms[k] = 0 end
      if known then check_slope(info, g, p, max(energy(g, terms), usual)) end
    end
    everywhere.search(f, low, high, TOLERANCE * usual, look)
  end
end

---- constraints and forces ----

-- what a constraint or force returned, always as a list
local function numbers(value)
  if type(value) == "number" then return { value } end
  local out = {}
  for i = 1, #value do out[i] = value[i] end
  return out
end
M.numbers = numbers

-- values of f at all points where it has any, there and where the group has moved them
local function values(f, info)
  local out = {}
  for k, p in ipairs(info.points) do
    local there = moved(info, p, k)
    local fine, a, b = blame.try(function()
      return numbers(f(p.q, p.v, p.t)), numbers(f(there, p.v, p.t))
    end)
    if fine then out[#out + 1] = { a = a, b = b, p = p, there = there } end
  end
  return out
end

-- Entry i of each is the same at both, in the weight weight(p, i); size(one, i): what it is
-- compared with.
local function compare(what, info, list, weight, size)
  local usual = {}
  for i = 1, list[1] and #list[1].a or 0 do
    local sizes = {}
    for k, one in ipairs(list) do sizes[k] = size(one, i) end
    usual[i] = middle(sizes)
  end
  for _, one in ipairs(list) do
    for i = 1, #one.a do
      local a, b = one.a[i], one.b[i]
      local off, room = abs(a - b) * weight(one.p, i), TOLERANCE * max(size(one, i), usual[i])
      if off > room and off > room * slack(info, one.there) then
        error(("%s is not invariant: entry %d changes from %.6g to %.6g when the group moves q "
          .. "at %s")
          :format(what, i, a, b, place(info, one.p)), 0)
      end
    end
  end
end

-- of the terms of L, beside which a force is round-off: friction of what turns as one body is
-- nothing but that
local ROUND = 1e-4
M.ROUND = ROUND * TOLERANCE

--- A force (q, v, t) that is invariant and does no work along the group.
function M.force(info, f)
  local list, sizes = values(f, info), {}
  local function work(one) return max(energy(one.a, one.p.q), ROUND * one.p.energy) end
  local function by(p, i) return abs(p.q[i]) end
  compare("the force", info, list, by, work)
  for k, one in ipairs(list) do sizes[k] = work(one) end
  local usual = middle(sizes)
  for k, one in ipairs(list) do
    for _, i in ipairs(info.cyclic) do
      if abs(one.a[i]) * reach(one.p.q[i]) > TOLERANCE * max(sizes[k], usual) then
        error(("the force has a component along the group: it pushes '%s' with %.6g at %s, so "
          .. "the momentum of '%s' is not kept and cannot be eliminated")
          :format(info.names[i], one.a[i], place(info, one.p), info.names[i]), 0)
      end
    end
  end
end

--- A constraint g(q, t) that the group keeps.
function M.constraint(info, g)
  compare("the constraint", info, values(function(q, _, t) return g(q, t) end, info),
    function() return 1 end, function(one, i) return abs(one.a[i]) end)
end

--- What a reaction returned, as a list of rows.
function M.rows(value)
  return type(value[1]) == "number" and { value } or numbers(value)
end

-- entry i of the velocity replaced
local function replaced(v, i, value)
  local out = numbers(v)
  out[i] = value
  return core.vector(out)
end

--- Rolling constraints phi(q, v, t) that are invariant and whose reactions, phi_v or the rows that
-- are given, have no component along the group.
function M.rolling(info, phi, reaction)
  local list = values(phi, info)
  local function size(one, i) return max(abs(one.a[i]), ROUND * math.sqrt(one.p.energy)) end
  compare("the rolling constraint", info, list, function() return 1 end, size)
  if reaction then
    local entries = function(...) return lists.joined(table.unpack(M.rows(reaction(...)))) end
    compare("the reaction", info, values(entries, info), function() return 1 end,
      function(one) return core.vector(one.a):norm() end)
  end
  for _, one in ipairs(list) do
    local p = one.p
    local rows = reaction and M.rows(reaction(p.q, p.v, p.t))
    for _, at in ipairs(info.cyclic) do
      local other = not rows and numbers(phi(p.q, replaced(p.v, at, 2 * p.v[at] + 1), p.t))
      for i = 1, #one.a do
        local push = rows and rows[i][at] or other and other[i] - one.a[i]
        local room = TOLERANCE * (rows and core.vector(rows[i]):norm() or max(1, abs(one.a[i])))
        if abs(push) > room then
          error(("the reaction of rolling constraint %d has a component along the group: it pushes "
            .. "'%s' at %s, so the momentum of '%s' is not kept and cannot be eliminated")
            :format(i, info.names[at], place(info, p), info.names[at]), 0)
        end
      end
    end
  end
end

--- The locked inertia can be solved with: the order of its rows in elimination.
function M.inertia(info, I)
  local order = linear.order(I)
  if not order and info.full:structure().linear_in_v then
    error("L is linear in the velocities: its momentum is a function of q alone, which "
      .. "determines no velocity of the group; degenerate(s) steps this "
      .. "system unreduced", 0)
  end
  if not order then
    error("the locked inertia is singular at " .. place(info, info.sample)
      .. ": the momentum does not determine the velocity of the group", 0)
  end
  return order
end

return M
