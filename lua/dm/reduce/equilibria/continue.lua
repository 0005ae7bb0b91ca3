--- shape:continue: relative equilibria followed in the momentum by arc length (Keller), with what
-- happens to them on the way.
local balance = require "dm.reduce.equilibria.stationary"
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local branches = require "dm.reduce.equilibria.branch"
local core = require "dm.core"
local equilibria = require "dm.reduce.equilibria"
local linear = require "dm.base.linear"
local option = require "dm.base.options"
local pole = require "dm.reduce.equilibria.pole"

local M = {}

local abs, max, sqrt = math.abs, math.max, math.sqrt

local WORD = branches.WORD

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
  local t, sum = linear.solution(A, rest), 0
  if not t then return nil end
  for i = 1, d + 1 do sum = sum + t[i] ^ 2 end
  for i = 1, d + 1 do t[i] = t[i] / sqrt(sum) end
  return t
end

-- back to the curve in the plane at right angles to the tangent; nothing where Newton's method does
-- not end
local function correct(V, z, t, d, n)
  local foot = z
  z = table.move(z, 1, d + 1, 1, {})
  for round = 1, 12 do
    local fine, g, rows = blame.try(equation, V, z, d, n)
    if not fine then return nil end
    local A, rest, off = {}, {}, 0
    for i = 1, d do A[i], rest[i] = rows[i], g[i] end
    for i = 1, d + 1 do off = off + t[i] * (z[i] - foot[i]) end
    A[d + 1], rest[d + 1] = t, off
    local step, size = linear.solution(A, rest), 0
    if not step then return nil end
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

-- what can happen between two points of a branch, and what it is called: z, t, e of a point
local EVENTS = {
  { happens = function(a, b) return a.t[#a.t] * b.t[#b.t] < 0 end,
    name = function() return "fold" end },
  { happens = function(a, b) return a.e.index ~= b.e.index and a.t[#a.t] * b.t[#b.t] > 0 end,
    name = function(a, b)
      return ("index %d to %d (another branch crosses)"):format(a.e.index, b.e.index)
    end },
  { happens = function(a, b) return a.e.stable ~= b.e.stable end,
    name = function(a, b) return ("%s to %s"):format(WORD[a.e.stable], WORD[b.e.stable]) end },
}

-- the point of the branch in the middle of two, or nothing
local function middle(c, a, b)
  local guess, chord, size = {}, {}, 0
  for i = 1, c.d + 1 do
    guess[i], chord[i] = (a.z[i] + b.z[i]) / 2, b.z[i] - a.z[i]
    size = size + chord[i] ^ 2
  end
  for i = 1, c.d + 1 do chord[i] = chord[i] / sqrt(size) end
  local z, rows = correct(c.V, guess, chord, c.d, c.n)
  local t = z and tangent(rows, a.t, c.d)
  local there, e = blame.try(describe, c.info, c.R, c.V, z, c.n)
  return t and there and e and { z = z, t = t, e = e } or nil
end

local HALVINGS = 20

-- folds in mu, changes of stability and of index between two points, where they are by bisection
local function note(c, b, before, now)
  for _, event in ipairs(EVENTS) do
    local happens = event.happens
    if happens(before, now) then
      local near, far = before, now
      for _ = 1, HALVINGS do
        local between = middle(c, near, far)
        if not between then break end
        if happens(near, between) then far = between else near = between end
      end
      b.events[#b.events + 1] = { what = event.name(before, now), momentum = far.e.momentum,
        x = far.e.x, at = #b }
    end
  end
end

-- the unit direction in which mu goes, and how far along it
local function direction(mu)
  local size = mu:norm()
  local n = {}
  for a = 1, #mu do n[a] = size > 0 and mu[a] / size or a == 1 and 1 or 0 end
  if #mu == 1 then return { 1 }, mu[1] end
  return n, size
end

-- the point of the curve between z and past where mu is `bound`, with the rows there; nothing where
-- z is that point
local function at_bound(V, z, past, bound, d, n)
  local s, guess, across = (bound - z[d + 1]) / (past[d + 1] - z[d + 1]), {}, {}
  if not (s > 1e-9) then return nil end
  for i = 1, d + 1 do guess[i], across[i] = z[i] + s * (past[i] - z[i]), i == d + 1 and 1 or 0 end
  guess[d + 1] = bound
  return correct(V, guess, across, d, n)
end

local AHEAD = 4  -- steps: so near to its end a branch is asked whether a pole ends it

-- a pole on the line from z to far is noted; a single momentum is 0 there, since the velocity mu/I
-- is finite
local function note_pole(c, b, z, far)
  local s, x = pole.between(c.info, z, far)
  if not s then return false end
  b.events[#b.events + 1] = { what = "pole (the locked inertia vanishes)",
    x = core.vector(x), at = #b,
    momentum = c.info.m == 1 and 0 or (1 - s) * z[c.d + 1] + s * far[c.d + 1] }
  return true
end

-- did mu change its sign, and the velocity of the group mu/I with it at once? Where I does not
-- vanish that goes through 0
local function turned_round(before, a, b)
  if a.e.momentum * b.e.momentum >= 0 or not before then return false end
  return (b.e.velocity - a.e.velocity):norm() > 10 * (a.e.velocity - before.e.velocity):norm()
end

local function point_ahead(z, t, length)
  local out = {}
  for i = 1, #z do out[i] = z[i] + length * t[i] end
  return out
end

-- from the point `now` a step of at most `length` along the curve: where, rows and rounds there,
-- and the bound that cuts it; nothing: shorter
local function advance(c, now, length, range)
  local z, d = now.z, c.d
  local next_z, rows, rounds = correct(c.V, point_ahead(z, now.t, length), now.t, d, c.n)
  local bound = next_z and (next_z[d + 1] < range[1] and range[1]
    or next_z[d + 1] > range[2] and range[2]) or nil
  if bound then next_z, rows = at_bound(c.V, z, next_z, bound, d, c.n) end
  return next_z, rows, rounds, bound
end

-- what belongs to the next point, or nothing where the curve ends
local function arrive(c, now, z, rows)
  local t = tangent(rows, now.t, c.d)
  if not t then return nil end
  local there, e = blame.try(describe, c.info, c.R, c.V, z, c.n)
  return there and e and { z = z, t = t, e = e } or nil
end

-- points up to the end of the range, of the points asked for (true), or of the curve (the last
-- point)
local function walk(c, b, now, options)
  local length, least, before = options.step, options.step / 1024, nil
  while #b < options.points do
    local z, rows, rounds, bound = advance(c, now, length, options.mu)
    if z and note_pole(c, b, now.z, z) then return true end
    if z then
      local ahead = arrive(c, now, z, rows)
      if not ahead or turned_round(before, now, ahead) then return now end
      b[#b + 1] = ahead.e
      note(c, b, now, ahead)
      before, now = now, ahead
      if bound then return true end
      if rounds <= 3 then length = math.min(2 * length, options.step) end
    elseif bound then
      return now
    else
      length = length / 2
      if length < least then return now end
    end
  end
  return true
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
  local c = { info = info, V = V, R = R, d = d, n = n }
  local last = walk(c, b, { z = z, t = t, e = describe(info, R, V, z, n) }, options)
  if last ~= true then
    note_pole(c, b, last.z, point_ahead(last.z, last.t, AHEAD * options.step))
  end
end

M.continue = blame.caller(function(shape, first, options)
  options = options or {}
  local info = equilibria.need(shape, "continue", options,
    { "mu", "step", "points", "back" })
  if not branches.is_equilibrium(first) then
    error("continue takes one of shape:relative_equilibria{...} and a table { mu = { from, to } }",
      0)
  end
  local range = options.mu
  if type(range) ~= "table" or type(range[1]) ~= "number" or type(range[2]) ~= "number"
    or not (range[1] < range[2]) then
    error("continue: option 'mu' must be a pair { from, to } with from < to", 0)
  end
  local step = option.positive(options, "step", "continue", "a length", (range[2] - range[1]) / 100)
  local points = option.whole(options, "points", "continue", 1, nil, 2000)
  local _, size = direction(first.mu)
  if not (size >= range[1] - 1e-12 * abs(size) and size <= range[2] + 1e-12 * abs(size)) then
    error(("continue: this equilibrium has mu = %.6g, which is not in the range from %.6g to "
      .. "%.6g: shape:at_momentum has others"):format(size, range[1], range[2]), 0)
  end
  first.momentum = size
  local b = branches.branch(info, first)
  follow(info, b, first, { mu = range, step = step, points = points }, options.back and -1 or 1)
  return b
end)

class.method("dm.system", "continue", M.continue, [[
shape:continue(equilibrium, {mu = {from, to}, step=, points=, back=}) -> dm.branch
The relative equilibria that go on from one, followed by arc length (Keller) in (x, mu), through
folds, while mu is in the range, to its very ends; along its own direction where the group has
several dimensions. step: largest step of arc length; back = true: towards smaller mu first.
branch[i] as in relative_equilibria with momentum; branch.mu, .energy, .velocity, .growth, .x1 ...
and coordinates by name: columns; branch:series("mu", "energy") for dm.plot; branch.events: folds,
changes of stability, crossings of other branches, a pole (the locked inertia vanishes: mu = 0) at
which a branch ends.]])

return M
