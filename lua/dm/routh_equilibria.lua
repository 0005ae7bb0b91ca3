--- shape:relative_equilibria and shape:continue: found by many starts, followed in the momentum by arc length.
local blame = require "dm.blame"
local balance = require "dm.routh_balance"
local core = require "dm.core"
local linear = require "dm.routh_linear"
local routh = require "dm.routh"

local M = {}

local abs, max, sqrt = math.abs, math.max, math.sqrt

---- what they look like ----

local class = { __name = "dm.relative_equilibria" }

local function list_text(v)
  local out = {}
  for i = 1, #v do out[i] = ("%.6g"):format(v[i]) end
  return "(" .. table.concat(out, ", ") .. ")"
end

local WORD = { energy = "stable (minimum)", spectral = "stable (spectrum)", [false] = "unstable" }

function class.__tostring(list)
  local out = { ("%d relative equilibri%s"):format(#list, #list == 1 and "um" or "a") }
  for _, e in ipairs(list) do
    out[#out + 1] = ("  x = %-36s energy %-12.6g velocity %-14s index %d  %s%s"):format(list_text(e.x), e.energy, list_text(e.velocity), e.index, WORD[e.stable],
      e.flat > 0 and (", V_mu is flat in %d direction%s"):format(e.flat, e.flat == 1 and "" or "s") or "")
  end
  return table.concat(out, "\n")
end

local function need(shape, what, options, known)
  local info = routh.need(shape, what)
  if type(options) ~= "table" then error(what .. " takes a table of options", 0) end
  for key in pairs(options) do
    if not known[key] then error(("%s: unknown option '%s'"):format(what, tostring(key)), 0) end
  end
  routh.steady(info, what)
  if info.full.given.constraint or info.full.given.force then
    error(what .. ": with constraints or forces balance is another equation; give coordinates without them", 0)
  end
  return info
end

---- finding them ----

local function check_region(region, d)
  if d == 1 and type(region) == "table" and type(region[1]) == "number" then region = { region } end
  if type(region) ~= "table" or #region ~= d then
    error(("relative_equilibria: option 'region' must be a list of %d pairs { least, most }, one for each coordinate of the shape"):format(d), 0)
  end
  for i, pair in ipairs(region) do
    local fine = type(pair) == "table" and type(pair[1]) == "number" and type(pair[2]) == "number"
    if not fine or not (pair[1] <= pair[2] and pair[1] > -math.huge and pair[2] < math.huge) then
      error(("relative_equilibria: 'region'[%d] must be a pair { least, most } of finite numbers"):format(i), 0)
    end
  end
  return region
end

local PRIMES = { 2, 3, 5, 7, 11, 13, 17, 19, 23, 29 }

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
  local out = {}
  for k = 1, count do
    out[k] = {}
    for i, pair in ipairs(region) do out[k][i] = pair[1] + (pair[2] - pair[1]) * radical(k, PRIMES[(i - 1) % #PRIMES + 1]) end
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
    local near = abs(other.energy - e.energy) <= 1e-8 * turned and (other.velocity - e.velocity):norm() <= 1e-8 * e.velocity:norm()
    if near and other.index == e.index then return true end
  end
  return false
end

M.relative_equilibria = blame.caller(function(shape, options)
  local info = need(shape, "relative_equilibria", options, { region = true, starts = true, copies = true })
  local region, d = options.region, info.d
  region = check_region(region, d)
  local starts = options.starts or 200
  if math.type(starts) ~= "integer" or starts < 1 then error("relative_equilibria: 'starts' must be a whole number > 0", 0) end
  local V, R, mu = balance.potential(info), balance.routhian(info), core.vector(info.mu)
  local list, points, scale = setmetatable({}, class), fill(region, starts), nil
  scale = balance.scale(V, points, lengths_of(region), mu, d)
  for _, x in ipairs(points) do
    local found = balance.stationary(V, x, mu, d, scale)
    if found and inside(found, region, scale.length) and is_new(list, found, scale.length) then
      local fine, e = pcall(balance.describe, info, R, V, found, mu)
      if fine and e and not (options.copies == false and is_copy(list, e)) then list[#list + 1] = e end
    end
  end
  table.sort(list, function(a, b) return a.energy < b.energy end)
  return list
end)

---- following them ----

local branch_class = { __name = "dm.branch" }

function branch_class.__tostring(b)
  local out = { ("branch of %d relative equilibria, mu from %.6g to %.6g"):format(#b, b[1].momentum, b[#b].momentum) }
  for _, e in ipairs(b.events) do
    out[#out + 1] = ("  %s near mu = %.6g, x = %s"):format(e.what, e.momentum, list_text(e.x))
  end
  return table.concat(out, "\n")
end

-- columns of a branch
function branch_class.__index(b, key)
  local rows = rawget(b, "rows_of")
  local read = rows and rows[key]
  if not read then return nil end
  local out = {}
  for i = 1, #b do out[i] = read(b[i]) end
  return core.vector(out)
end

local READ = {
  mu = function(e) return e.momentum end,
  energy = function(e) return e.energy end,
  velocity = function(e) return e.velocity[1] end,
  growth = function(e)
    local worst = 0
    for _, value in ipairs(e.values) do worst = max(worst, value[1]) end
    return worst
  end,
}

-- slope of V in x at (x, m) and its derivatives [d][d + 1], mu = m n along the direction n
local function equation(V, z, d, n)
  local x, mu = {}, {}
  for i = 1, d do x[i] = z[i] end
  for a = 1, #n do mu[a] = z[d + 1] * n[a] end
  local g, H, rows = V:gradient(x, mu), V:hessian(x, mu), {}
  for i = 1, d do
    rows[i] = {}
    for k = 1, d do rows[i][k] = H[i][k] end
    rows[i][d + 1] = 0
    for a = 1, #n do rows[i][d + 1] = rows[i][d + 1] + H[i][d + a] * n[a] end
  end
  return g, rows
end

-- the unit tangent that goes on in the direction of `before`
local function tangent(rows, before, d)
  local A, rest = {}, {}
  for i = 1, d do A[i], rest[i] = rows[i], 0 end
  A[d + 1], rest[d + 1] = before, 1
  local order = linear.order(A)
  if not order then return nil end
  local t, sum = linear.solve(A, { rest }, order)[1], 0
  for i = 1, d + 1 do sum = sum + t[i] ^ 2 end
  for i = 1, d + 1 do t[i] = t[i] / sqrt(sum) end
  return t
end

-- back to the curve in the plane at right angles to the tangent; nothing where Newton's method does not end
local function correct(V, z, t, d, n)
  local foot = z
  z = table.move(z, 1, d + 1, 1, {})
  for round = 1, 12 do
    local fine, g, rows = pcall(equation, V, z, d, n)
    if not fine then return nil end
    local A, rest, off = {}, {}, 0
    for i = 1, d do A[i], rest[i] = rows[i], g[i] end
    for i = 1, d + 1 do off = off + t[i] * (z[i] - foot[i]) end
    A[d + 1], rest[d + 1] = t, off
    local order = linear.order(A)
    if not order then return nil end
    local step, size = linear.solve(A, { rest }, order)[1], 0
    for i = 1, d + 1 do z[i] = z[i] - step[i]; size = max(size, abs(step[i])) end
    if size < 1e-11 then return z, rows, round end
  end
  return nil
end

local function describe(info, R, V, z, n)
  local x, mu = {}, {}
  for i = 1, info.d do x[i] = z[i] end
  for a = 1, info.m do mu[a] = z[info.d + 1] * n[a] end
  local e = balance.describe(info, R, V, core.vector(x), core.vector(mu))
  e.momentum = z[info.d + 1]
  return e
end

-- folds in mu and changes of stability or of index between neighbours
local function note(b, before, now, t, last)
  local function add(what) b.events[#b.events + 1] = { what = what, momentum = now.momentum, x = now.x, at = #b } end
  if t[#t] * last[#last] < 0 then add "fold" end
  if before.index ~= now.index and t[#t] * last[#last] > 0 then add(("index %d to %d (another branch crosses)"):format(before.index, now.index)) end
  if before.stable ~= now.stable then add(("%s to %s"):format(WORD[before.stable], WORD[now.stable])) end
end

-- the unit direction in which mu goes, and how far along it
local function direction(mu)
  local size = mu:norm()
  local n = {}
  for a = 1, #mu do n[a] = size > 0 and mu[a] / size or a == 1 and 1 or 0 end
  if #mu == 1 then return { 1 }, mu[1] end
  return n, size
end

-- the point of the curve between z and past where mu is `bound`, with the rows there; nothing where z is that point
local function at_bound(V, z, past, bound, d, n)
  local s, guess, across = (bound - z[d + 1]) / (past[d + 1] - z[d + 1]), {}, {}
  if not (s > 1e-9) then return nil end
  for i = 1, d + 1 do guess[i], across[i] = z[i] + s * (past[i] - z[i]), i == d + 1 and 1 or 0 end
  guess[d + 1] = bound
  return correct(V, guess, across, d, n)
end

local function follow(info, b, first, options, sign)
  local d, V, R = info.d, balance.potential(info), balance.routhian(info)
  local n, size = direction(first.mu)
  local z, before = {}, {}
  for i = 1, d do z[i], before[i] = first.x[i], 0 end
  z[d + 1], before[d + 1] = size, sign
  local _, rows = equation(V, z, d, n)
  local t = tangent(rows, before, d)
  if not t then return end
  local length, least = options.step, options.step / 1024
  local now = describe(info, R, V, z, n)
  while #b < options.points do
    local guess = {}
    for i = 1, d + 1 do guess[i] = z[i] + length * t[i] end
    local next_z, next_rows, rounds = correct(V, guess, t, d, n)
    local bound = next_z and (next_z[d + 1] < options.mu[1] and options.mu[1] or next_z[d + 1] > options.mu[2] and options.mu[2]) or nil
    if bound then
      next_z, next_rows = at_bound(V, z, next_z, bound, d, n)
      if not next_z then return end
    end
    if next_z then
      local ahead = tangent(next_rows, t, d)
      if not ahead then return end
      local there, e = pcall(describe, info, R, V, next_z, n)
      if not there or not e then return end
      b[#b + 1] = e
      note(b, now, e, ahead, t)
      if bound then return end
      z, t, now = next_z, ahead, e
      if rounds <= 3 then length = math.min(2 * length, options.step) end
    else
      length = length / 2
      if length < least then return end
    end
  end
end

M.continue = blame.caller(function(shape, first, options)
  options = options or {}
  local info = need(shape, "continue", options, { mu = true, step = true, points = true, back = true })
  if type(first) ~= "table" or not first.x or not first.mu then
    error("continue takes one of shape:relative_equilibria{...} and a table { mu = { from, to } }", 0)
  end
  local range = options.mu
  if type(range) ~= "table" or type(range[1]) ~= "number" or type(range[2]) ~= "number" or not (range[1] < range[2]) then
    error("continue: option 'mu' must be a pair { from, to }", 0)
  end
  local step = options.step or (range[2] - range[1]) / 100
  if type(step) ~= "number" or not (step > 0) then error("continue: option 'step' must be a length > 0", 0) end
  local b = { events = {}, rows_of = setmetatable({}, { __index = READ }) }
  for i = 1, info.d do b.rows_of["x" .. i] = function(e) return e.x[i] end end
  setmetatable(b, branch_class)
  local _, size = direction(first.mu)
  first.momentum = size
  b[1] = first
  follow(info, b, first, { mu = range, step = step, points = options.points or 2000 }, options.back and -1 or 1)
  return b
end)

return M
