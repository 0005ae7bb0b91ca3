--- The order of a discrete Lagrangian, measured: how fast its trajectories approach each other when
-- the step is halved.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"
local starts = require "dm.base.start"

-- steps of the runs that are compared; relative differences that tell something, above round-off;
-- exponents that agree so well are taken at once, that badly never
local COUNTS = { 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 96, 128, 192, 256,
  384, 512 }
local LEAST, MOST = 3e-14, 1e-2
local GOOD, BAD = 0.02, 0.2

-- the same discrete Lagrangian with another step, as a solver
local function with_step(Ld, h)
  if Ld.system then return Ld.system:solver { rule = Ld.rule, h = h } end
  local copy = core.discrete_lagrangian { Q = Ld.Q, h = h, Ld = Ld.Ld, params = Ld.params,
    constraint = Ld.constraint, force = Ld.force, rolling = Ld.rolling, reaction = Ld.reaction }
  return copy:solver {}, copy
end

-- a point that has nothing special: 0.37, 0.9 ... and velocities of either sign
local function anywhere(n)
  local q, v = {}, {}
  for i = 1, n do
    q[i] = 0.37 + 0.53 * (i - 1) % 1
    v[i] = 0.6 * (-1) ^ i + 0.17 * i
  end
  return q, v
end

-- p0 of a start in position and velocity: by the Legendre transform, or by two positions a short
-- step apart
local function momentum(Ld, q, v, h, t0)
  if Ld.system then return Ld.system:momentum(q, v, t0) end
  local _, copy = with_step(Ld, h)
  return copy:legendre_minus(q, core.vector(q) + h * core.vector(v))
end

local function last(Ld, start, h, steps)
  local path = with_step(Ld, h):run { q = start.q, p = start.p, t0 = start.t0,
    steps = steps, every = steps }
  return path.q[#path]
end

-- relative differences between runs over the time T with N and 2 N steps: { N, difference }; what
-- cannot be solved is left out
local function differences(Ld, start, T)
  local ends, out = {}, {}
  local function reached(N)
    if ends[N] == nil then
      local fine, q = blame.try(last, Ld, start, T / N, N)
      if type(q) == "string" and q:find "field '" then error(q, 0) end -- the start is wrong
      ends[N] = fine and q
    end
    return ends[N]
  end
  for _, N in ipairs(COUNTS) do
    local a, b = reached(N), reached(2 * N)
    local d = a and b and (a - b):norm() / b:norm()
    if d and d < LEAST then break end
    if d and d < MOST then out[#out + 1] = { N, d } end
  end
  return out
end

local function exponent(a, b) return math.log(a[2] / b[2]) / math.log(b[1] / a[1]) end

-- the exponent where three spans agree best, and how well: their spread, which round-off is added
-- to
local function settled(d)
  local p, least = nil, math.huge
  for i = 1, #d - 4 do
    local a, b, c = exponent(d[i], d[i + 2]), exponent(d[i + 1], d[i + 3]),
      exponent(d[i + 2], d[i + 4])
    local spread = math.max(a, b, c) - math.min(a, b, c) + 3e-16 / d[i + 4][2]
    if b > 0.5 and spread < least then p, least = c, spread end
  end
  return p, least
end

-- longer and longer times, until there are differences to compare
local function search(Ld, start)
  local T, p, least = COUNTS[1] * Ld.h, nil, BAD
  for _ = 1, 48 do
    local q, spread = settled(differences(Ld, start, T))
    if q and spread < least then p, least = q, spread end
    if least < GOOD then break end
    T = 1.3 * T
  end
  return p
end

local function order(Ld, options)
  options = starts.lists(option.check(options or {}, { "q", "v", "p", "t0" }, "Ld:order",
    "{ q =, v = } or none"), Ld)
  local t0 = option.number(options, "t0", "Ld:order")
  local q, v = anywhere(Ld.Q.dimension)
  if not Ld.system and (Ld.constraint or Ld.rolling) and not options.q then
    error("Ld:order: a start on the constraint is needed, Ld:order { q =, v = }", 2)
  end
  local start = { q = options.q or q, t0 = t0 }
  start.p = options.p or momentum(Ld, start.q, options.v or v, Ld.h / 1024, t0)
  local p = search(Ld, start)
  if not p then
    error("no order is to be seen: runs with smaller steps do not approach each other at a steady "
      .. "rate" .. (Ld.system and "" or " (does Ld use its argument h?)")
      .. "; give another start, Ld:order { q =, v = }", 2)
  end
  return p
end

local doc = [[
Ld:order([{q=, v=, p=, t0=}]) -> number
The order, measured on the system itself: by how much runs over the same time approach each other
when their step is halved, from q and the velocity v or momentum p (left out: a point without
meaning) at the time t0 (0). A formula Ld(q0, q1, h) must use its h. Raises when no rate is to be
seen.]]
order = blame.caller(order)
core.method("dm.discrete_lagrangian", "order", order, doc)

return { order = order }
