--- The functions of dm.step as functions of flat coordinates, which are traced: y becomes a table
-- with q, p, t, and m has the functions of the system.
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local kits = require "dm.group.kit"
local linear = require "dm.base.linear"
local lists = require "dm.base.lists"
local place = require "dm.group.place"

local M = {}

local MOST = 1000  -- numbers of parts

local part = lists.part

---- L and H of the system ----

-- f(q, x, t) as a function of (base, e, x, t): q = base moved by e, so that derivatives in e are
-- those of the space; coordinates of the base, and how many e has
local function moved(system, f)
  local own = system.place
  if not own then
    return function(base, e, x, t) return f(base + e, x, t) end, core.vector, system.Q.dimension
  end
  local side = own.right and "right" or "left"
  local P = place.of(system.Q, { columns = "matrix", trivialization = side })
  local function at(base, e, x, t)
    local list = own.right and P.carry(P.near(e), base) or P.carry(base, P.near(e))
    return f(P.element(list), x, t)
  end
  return at, function(q) return core.vector(P.flat(q)) end, own.dimension
end

-- what is asked of L or H: value, and derivatives by q (along the space) and by v or p
local function gradient_of(system, f)
  local at, coordinates, d = moved(system, f)
  local out, slopes, N = { dimension = d, coordinates = coordinates }, nil, nil
  local function slope(base, x, t)
    N = #base
    slopes = slopes or core.derivative(at, N, d, d, "number")
    return slopes(base, core.zeros(d), x, t)
  end
  function out.value(q, x, t) return f(q, core.vector(x), t or 0) end
  function out.by_q(q, x, t)
    return part(slope(coordinates(q), core.vector(x), t or 0), N, d)
  end
  function out.at(base, x, t) return part(slope(base, x, t), N + d, d) end
  function out.by_x(q, x, t) return out.at(coordinates(q), core.vector(x), t or 0) end
  return out
end

-- matrix of L_vv at (base, v, t)
local function mass_of(L)
  local second
  return function(base, v, t)
    local N, d = #base, L.dimension
    second = second or core.derivative(L.at, N, d, "number")
    local J = second(base, v, t)
    local mass = core.zeros(d, d):totable()
    for i = 1, d do
      for k = 1, d do mass[i][k] = J[i][N + k] end
    end
    return core.matrix(mass)
  end
end

-- raises where the mass changes with v, at a place of numbers
local function check_quadratic(system, L, mass)
  local own, d = system.place, L.dimension
  local x, v = kits.normals(core.random(3), 0, d, 0.3), kits.normals(core.random(3), 1, d, 0.7)
  local base = L.coordinates(own and own.kit.exp(x) or x)
  local fine, a, b = blame.try(function()
    return mass(base, core.zeros(d), 0), mass(base, v, 0)
  end)
  if fine and linear.largest(a - b) > 1e-9 * linear.largest(a) then
    error("dm.step: m.H and its derivatives need an L that is quadratic in v: give the system by "
      .. "its H, or write the step with m.L", 0)
  end
end

-- H of an L that is quadratic in v
local function transformed(system, L)
  local mass, m, checked = mass_of(L), {}, false
  function m.H_p(q, p, t)
    if not checked then check_quadratic(system, L, mass) end
    checked = true
    local base, zero = L.coordinates(q), core.zeros(L.dimension)
    return mass(base, zero, t or 0):solve(core.vector(p) - L.at(base, zero, t or 0))
  end
  function m.H(q, p, t)
    local v = m.H_p(q, p, t)
    return core.vector(p):dot(v) - L.value(q, v, t)
  end
  function m.H_q(q, p, t) return -L.by_q(q, m.H_p(q, p, t), t) end
  return m
end

-- of a system that has only H
local function without_L()
  error("dm.step: this system is given by an H that no L belongs to: m.L is not there, take m.H", 0)
end

--- m: L(q, v, t), H(q, p, t) of a system and their exact derivatives, on groups trivialized.
function M.functions_of(system)
  local given, m = system.given or system, nil
  local L = given.L and gradient_of(system, bound(given.L, given.params))
  if given.H then
    local H = gradient_of(system, bound(given.H, given.params))
    m = { H = H.value, H_q = H.by_q, H_p = H.by_x }
  else
    m = transformed(system, L)
  end
  m.L, m.L_q, m.L_v = without_L, without_L, without_L
  if L then m.L, m.L_q, m.L_v = L.value, L.by_q, L.by_x end
  return m
end

---- parts ----

local TAKEN = { q = true, p = true, t = true, h = true, time = true, energy = true, flat = true,
  mu = true, a = true }

local function wrong_part(i, why)
  error(("dm.step: field 'parts'[%d] %s"):format(i, why), 0)
end

-- { { name, count }, ... }, checked, and how many numbers there are
local function parts_of(parts)
  if parts == nil then return nil, 0 end
  if type(parts) ~= "table" then
    error([[dm.step: field 'parts' must be a list such as { { "E", 1 } }]], 0)
  end
  local out, seen, total = {}, {}, 0
  for i, entry in ipairs(parts) do
    local name, count = type(entry) == "table" and entry[1], type(entry) == "table" and entry[2]
    if type(name) ~= "string" or not name:match "^%a[%w_]*$" then
      wrong_part(i, [[must be { name, how many numbers }, such as { "E", 1 }]])
    end
    if TAKEN[name] or name:match "^[qp]%d+$" or name:match "^R%d%d" then
      wrong_part(i, ("is called '%s', which every state has: choose another name"):format(name))
    end
    if seen[name] then wrong_part(i, ("is called '%s', as another one"):format(name)) end
    if not lists.whole(count) or count < 1 or count > MOST then
      wrong_part(i, ("must say how many numbers '%s' has, 1 to %d"):format(name, MOST))
    end
    seen[name], out[i], total = true, { name, lists.whole(count) }, total + count
  end
  return out, lists.whole(total)
end

--- A copy of the options of dm.step with a list of parts that is checked, and how many numbers they
-- are.
function M.options(options)
  local out, total = {}, nil
  for key, value in pairs(options) do out[key] = value end
  out.parts, total = parts_of(options.parts)
  if total > MOST then error(("dm.step: at most %d numbers of parts"):format(MOST), 0) end
  if options.sums ~= nil and type(options.sums) ~= "boolean" then
    error(("dm.step: field 'sums' must be true or false (got %s)"):format(type(options.sums)), 0)
  end
  if options.begin and total == 0 then
    error([[dm.step: 'begin' sets parts, and there are none: parts = { { "E", 1 } }]], 0)
  end
  return out, total
end

--- The options that a rule was made of: what M.options gave.
function M.options_of(rule) return debug.getuservalue(debug.getuservalue(rule, 1), 1) end

-- parts as fields of y, of their numbers one after the other
local function spread(y, parts, list)
  local first = 0
  for _, entry in ipairs(parts or {}) do
    local name, count = entry[1], entry[2]
    y[name] = count == 1 and list[first + 1] or part(list, first, count)
    first = first + count
  end
  return y
end

-- numbers of the fields of a table that was returned, `before` where it has none
local function gathered(parts, value, before, what)
  local out, first = {}, 0
  for _, entry in ipairs(parts or {}) do
    local name, count = entry[1], entry[2]
    local x = value[name]
    if x == nil then
      for i = 1, count do out[first + i] = before and before[first + i] or 0 end
    else
      local list = kits.vector(x, count, ("%s: the part '%s'"):format(what, name))
      for i = 1, count do out[first + i] = list[i] end
    end
    first = first + count
  end
  return out
end

-- raises for a field of a table that was returned, unless it is known or a part
local function check_fields(value, known, parts, what)
  if type(value) ~= "table" then error(what .. " must return a table", 0) end
  for key in pairs(value) do
    local fine = known[key]
    for _, entry in ipairs(parts or {}) do fine = fine or entry[1] == key end
    if not fine then
      error(("%s returned '%s', which is neither of q, p, t nor one of 'parts'")
        :format(what, tostring(key)), 0)
    end
  end
end

---- the state ----

-- what the functions of a step get as y; flat: the coordinates of q on a group
local function state_of(system, parts, q, p, t, list)
  local own = system.place
  return spread({ q = own and own.element(q) or q, flat = own and q, p = p, t = t }, parts, list)
end

local STATE, NOTHING = { q = true, flat = true, p = true, t = true }, {}

-- sum of squares of the differences of a and b, each of the size of its entry
local function difference(a, b)
  local sum = 0
  for i = 1, #a do sum = sum + (a[i] - b[i]) ^ 2 / (1 + a[i] ^ 2) end
  return sum
end

-- how far off its group `next` leads, squared: by g, the element that it gave, or nothing, and its
-- coordinates q; relations of matrices are no larger than powers of their entries
local function off_group(own, g, q)
  local kit = own.kit
  if g == nil then g = own.element(q) else g = kit.element(g) end
  local flat, off, size = kits.list_of(kit.flat(g)), 0, 1
  for _, x in ipairs(flat) do size = size + x ^ 2 end
  for _, x in ipairs(kit.bonds(flat)) do off = off + x ^ 2 / size ^ 4 end
  return off + difference(q, own.tidy(q))
    + difference(kit.entries(g), kit.entries(kit.unflat(flat)))
end

-- Coordinates of an element that `next` gave, near those before. Where y.q is off the group by
-- rounding, that is too, and its coordinates are by more: tidied, they do not go away.
local function coordinates_of(own, q, before)
  return own.follow(own.tidy(own.flat(own.kit.element(q))), before)
end

-- the numbers of what `next` returned: q, or its coordinates `flat`; p, t, parts, off_group; sums:
-- q and p are what is added to the coordinates and to the momentum
local function flattened(system, parts, before, value, h, sums)
  if type(value) ~= "table" or (value.q or value.flat) == nil or value.p == nil then
    error("'next' must return a table { q =, p = }", 0)
  end
  check_fields(value, STATE, parts, "'next'")
  local own, out, q = system.place, {}, value.flat or value.q
  if own and not sums and not value.flat then
    q = coordinates_of(own, value.q, before.q)
  end
  q = kits.vector(q, own and own.size or system.Q.dimension, "'next': q")
  for i = 1, #q do out[i] = q[i] end
  local p = kits.vector(value.p, own and own.dimension or system.Q.dimension, "'next': p")
  for i = 1, #p do out[#out + 1] = p[i] end
  out[#out + 1] = value.t or before.t + h
  for _, x in ipairs(gathered(parts, value, before.parts, "'next'")) do out[#out + 1] = x end
  local g = not sums and not value.flat and value.q or nil
  out[#out + 1] = own and off_group(own, g, sums and before.q + q or q) or 0
  return out
end

-- arguments as C has them: parts are left out where there are none
local function splitter(parts)
  local has = parts and #parts > 0
  return function(...)
    if has then return ... end
    return nil, ...
  end
end

--- The functions of the options of dm.step for a system: of (q, p, t, parts, x, h), parts left out
-- where there are none, without x, or of (q, p, h) alone.
function M.functions(options, system)
  local m, out, parts = M.functions_of(system), {}, options.parts
  local split = splitter(parts)
  local function of_root(name)
    local f = options[name]
    return f and function(q, p, t, ...)
      local list, x, h = split(...)
      return f(state_of(system, parts, q, p, t, list), x, h, m)
    end
  end
  local function of_state(name)
    local f = options[name]
    return f and function(q, p, t, ...)
      local list, h = split(...)
      return f(state_of(system, parts, q, p, t, list), h, m)
    end
  end
  out.equation, out.inside = of_root "equation", of_root "inside"
  out.start, out.scale = of_state "start", of_state "scale"
  local after = of_root "next"
  function out.next(q, p, t, ...)
    local list, _, h = split(...)
    return flattened(system, parts, { q = q, t = t, parts = list }, after(q, p, t, ...), h,
      options.sums)
  end
  out.begin = options.begin and function(q, p, h)
    local own = system.place
    local value = options.begin(own and own.element(q) or q, p, h, m)
    check_fields(value, NOTHING, parts, "'begin'")
    return gathered(parts, value, nil, "'begin'")
  end
  return out
end

--- Does `next` give t, on this system? Then the steps have a time of their own.
function M.is_timed(options, system)
  local own, timed = system.place, false
  local n, d = own and own.size or system.Q.dimension, own and own.dimension or system.Q.dimension
  local parts, total = options.parts, 0
  for _, entry in ipairs(parts or {}) do total = total + entry[2] end
  local m = M.functions_of(system)
  blame.try(core.trace, function(z, t, h)
    local q, p, list = part(z, 0, n), part(z, n, d), part(z, n + d, total)
    local y = state_of(system, parts, q, p, t, list)
    local value = options.next(y, part(z, n + d + total, options.unknowns), h, m)
    timed = type(value) == "table" and value.t ~= nil
    return { t }
  end, n + d + total + options.unknowns, "number", "number")
  return timed
end

return M
