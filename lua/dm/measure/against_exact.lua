--- Ld:against_exact: how far the discrete Lagrangian of a rule is from that of the flow.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local options = require "dm.base.options"

local abs, log, max = math.abs, math.log, math.max

local WHERE = "Ld:against_exact"
local SUBSTEPS = 16    -- of gauss(8), to the end of the motion
local ROUND = 2e-13    -- of the size: differences below tell nothing

-- the system and the rule that Ld is of
local function source_of(Ld)
  local source = Ld.source
  if not source then
    options.fail(WHERE, "a formula Ld(q0, q1) has no flow to be compared with: this is for "
      .. "dm.discrete_lagrangian(system, { rule =, h = })")
  end
  return source
end

-- growing or falling, each finite and > 0
local function read_steps(given)
  local list = options.need(given, "h", WHERE, "a list of steps")
  if type(list) == "number" then list = { list } end
  local fine, hs = blame.try(core.vector, list)
  for i = 1, fine and #hs or 0 do fine = fine and hs[i] > 0 and hs[i] < math.huge end
  options.demand(fine and #hs > 0, given, "h", WHERE, "a list of steps > 0")
  return hs
end

-- where the motion from (q, v) is after h, with its momenta at both ends
local function flow(system, given, h)
  local path = system:solver { rule = "gauss(8)", h = h / SUBSTEPS }
    :run { q = given.q, v = given.v, t0 = given.t0, steps = SUBSTEPS, every = SUBSTEPS }
  return { q0 = path.q[1], q1 = path.q[#path], p0 = path.p[1], p1 = path.p[#path] }
end

-- errors of value and momenta at one h, and what they are measured by
local function errors(source, given, h)
  local at = flow(source.system, given, h)
  local function of(rule) return core.discrete_lagrangian(source.system, { rule = rule, h = h }) end
  local t = given.t0
  local Ld, exact = of(source.rule), of "exact":value(at.q0, at.q1, t)
  local off, size = 0, 0
  local p0, p1 = Ld:legendre_minus(at.q0, at.q1, t), Ld:legendre_plus(at.q0, at.q1, t)
  for i = 1, #p0 do
    off = max(off, abs(p0[i] - at.p0[i]), abs(p1[i] - at.p1[i]))
    size = max(size, abs(at.p0[i]), abs(at.p1[i]))
  end
  return abs(Ld:value(at.q0, at.q1, t) - exact), off, abs(exact) + h * size ^ 2, size
end

-- exponent of h in the errors above round-off, by least squares; nil for fewer than two
local function slope(hs, list, sizes)
  local n, sx, sy, sxx, sxy = 0, 0, 0, 0, 0
  for i = 1, #hs do
    if list[i] > ROUND * sizes[i] then
      local x, y = log(hs[i]), log(list[i])
      n, sx, sy, sxx, sxy = n + 1, sx + x, sy + y, sxx + x * x, sxy + x * y
    end
  end
  local spread = n * sxx - sx * sx
  return n > 1 and spread > 1e-12 and (n * sxy - sx * sy) / spread or nil
end

class.method("dm.discrete_lagrangian", "against_exact", function(Ld, given)
  options.check(given, { "q", "v", "h", "t0" }, WHERE, "{ q =, v =, h = { ... } }")
  local source, hs = source_of(Ld), read_steps(given)
  options.need(given, "q", WHERE, "the position that the motion begins at")
  options.need(given, "v", WHERE, "its velocity there")
  options.number(given, "t0", WHERE)
  local value, momentum, of_value, of_momentum = {}, {}, {}, {}
  for i = 1, #hs do
    value[i], momentum[i], of_value[i], of_momentum[i] = errors(source, given, hs[i])
  end
  return core.result { h = hs, value = core.vector(value), momentum = core.vector(momentum),
    value_slope = slope(hs, value, of_value), momentum_slope = slope(hs, momentum, of_momentum) }
end, [[
Ld:against_exact{q=, v=, h={...}, t0=} -> { h, value, momentum, value_slope, momentum_slope }
The discrete Lagrangian of a system and a rule beside the exact one, for several steps h, between
the ends of the motion from q with velocity v at the time t0 (0): value is |Ld - L_exact|, momentum
the largest difference of a Legendre transform from the momentum of the motion. The slopes are
exponents of h, 2s + 1 and 2s for gauss(s); nil where fewer than two errors are above round-off
(Leok 5.1.1, Marsden & West 2001, 2.3). Raises for a formula Ld(q0, q1) of a script.]])

return {}
