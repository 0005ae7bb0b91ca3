--- What linear theory says of a rule: its amplification matrix on the oscillator, its limit and its
-- resonances.
local blame = require "dm.base.blame"
local core = require "dm.core"
local has_own_time = require "dm.base.own_time"
local option = require "dm.base.options"

local M = {}

local abs, sqrt, max, pi, huge = math.abs, math.sqrt, math.max, math.pi, math.huge

---- the amplification matrix of a rule on the oscillator q'' = -q, h omega = z ----

local kept_systems = {}

-- the oscillator, and beside a body at rest for rules that step groups alone: q and p of a member
local function oscillators()
  if #kept_systems > 0 then return kept_systems end
  local G = core.SO(3)
  kept_systems[1] = { system = core.system { Q = core.R(1), L = function(q, v)
    return (v[1] ^ 2 - q[1] ^ 2) / 2
  end }, start = function(x) return { x } end, momentum = function(y) return { y } end,
    read = function(q, p) return q[1], p[1] end }
  kept_systems[2] = { system = core.system { Q = core.product(G, core.R(1)), L = function(q, v)
    return (v:dot(v) - q[2][1] ^ 2) / 2
  end }, start = function(x) return { G:identity(), { x } } end,
    momentum = function(y) return { 0, 0, 0, y } end,
    read = function(q, p) return q[2][1], p[4] end }
  return kept_systems
end

-- of these the first that the rule steps, and a solver; raises what the first one says
local function stepped_by(rule)
  local why
  for _, one in ipairs(oscillators()) do
    local fine, solver = blame.try(function()
      local its = one.system:solver { rule = rule, h = 1 }
      its:run { q = one.start(0), p = one.momentum(0), steps = 0 }
      return its
    end)
    if fine then return one, solver end
    why = why or solver
  end
  error(why, 0)
end

-- one step from both unit vectors for every z: entries a, b, c, d of ((a, b), (c, d)); where a step
-- fails NaN
local function matrices(rule, zs)
  local n, one, solver = #zs, stepped_by(rule)
  local e = solver:ensemble { members = 2 * n, steps = 1,
    q = function(i) return one.start(i % 2) end,
    p = function(i) return one.momentum((i + 1) % 2) end,
    h = function(i) return zs[(i + 1) // 2] end }
  local out, status = {}, e.status
  for i = 1, n do
    local j, k = 2 * i - 1, 2 * i
    local x = { a = 0 / 0, b = 0 / 0, c = 0 / 0, d = 0 / 0 }
    if status[j] == "ok" and status[k] == "ok" then
      x.a, x.c = one.read(e.q[j], e.p[j])
      x.b, x.d = one.read(e.q[k], e.p[k])
    end
    out[i] = x
  end
  return out
end

-- half the trace over the root of the determinant, and the largest modulus of an eigenvalue
local function read_off(m)
  local half, det = (m.a + m.d) / 2, m.a * m.d - m.b * m.c
  if not (det > 0) then
    return 0 / 0, max(abs(half + sqrt(max(half * half - det, 0))),
      abs(half - sqrt(max(half * half - det, 0))))
  end
  local root = sqrt(det)
  if half * half <= det then return half / root, root end
  return half / root, abs(half) + sqrt(half * half - det)
end

local function check_rule(rule, what)
  if has_own_time(rule) then
    error(("%s: '%s' changes the time with the state: its step on an oscillator is not linear")
      :format(what, rule), 0)
  end
  if tostring(rule):find "gauss%s*%(%s*%d+%s*,%s*%d" then
    error(what .. ": a number of sweeps starts each step from the stages of the last one: one "
      .. "step is no matrix for (q, p); try runs, dm.stability", 0)
  end
  if tostring(rule):find "^degenerate" then
    error(what .. ": 'degenerate' is for L linear in v, which an oscillator is not", 0)
  end
end

local doc_amplification = [[
dm.amplification(rule, z) -> dm.matrix, dm.vector, dm.vector
The matrix of one step of a rule for (q, p) on the oscillator L = (v^2 - q^2)/2 with h = z, so z = h
omega, and the real and imaginary parts of its eigenvalues: a pair on the unit circle is stable, one
outside of it grows in every step.]]

M.amplification = blame.caller(function(rule, z)
  check_rule(rule, "dm.amplification")
  if type(z) ~= "number" or not (z > 0 and z < huge) then
    error("dm.amplification: z = h omega must be a number > 0", 0)
  end
  local m = matrices(rule, { z })[1]
  if m.a ~= m.a then
    error(("dm.amplification: the step of %s cannot be solved at h omega = %g")
      :format(tostring(rule), z), 0)
  end
  local out = core.matrix { { m.a, m.b }, { m.c, m.d } }
  return out, out:eigenvalues()
end)

-- numbers h omega of the first look: to 12 evenly, then to 1e4 by ratio
local FINE, END_FINE, END = 2000, 12, 1e4
local FAR = 600

local function first_look()
  local zs = {}
  for i = 1, FINE do zs[i] = END_FINE * i / FINE end
  for i = 1, FAR do zs[FINE + i] = END_FINE * (END / END_FINE) ^ (i / FAR) end
  return zs
end

local function looked_at(rule, zs)
  local all = matrices(rule, zs)
  for i = 1, #all do
    local trace, radius = read_off(all[i])
    all[i] = { z = zs[i], trace = trace, radius = radius }
  end
  return all
end

local function between(a, b, count)
  local out = {}
  for k = 0, count do out[k + 1] = a + (b - a) * k / count end
  return out
end

-- the first z in (a, b] for which test holds, to round-off; a is known not to
local function narrow(rule, a, b, test)
  for _ = 1, 14 do
    local list = looked_at(rule, between(a, b, 16))
    for k = 2, #list do
      if test(list[k]) then
        a, b = list[k - 1].z, list[k].z
        break
      end
    end
    if b - a < 1e-14 * b then break end
  end
  return b
end

local function grows(tolerance)
  return function(x) return not (x.radius <= 1 + tolerance) end
end

-- intervals where an eigenvalue leaves the circle, also narrow ones between two looks, where the
-- trace comes near 2
local function gaps(rule, all, tolerance)
  local out, lost = {}, grows(tolerance)
  local function held(x) return not lost(x) end
  local inside = false
  local function note(a, b)
    if not inside then out[#out + 1] = { narrow(rule, a, b, lost), huge } end
  end
  for i, x in ipairs(all) do
    local before, after = all[i - 1], all[i + 1]
    if lost(x) then
      note(before and before.z or 1e-9, x.z)
      inside = true
    else
      if inside then out[#out][2] = narrow(rule, before.z, x.z, held) end
      inside = false
      local turning = before and after and abs(x.trace) > 0.98 and abs(x.trace) >= abs(before.trace)
        and abs(x.trace) >= abs(after.trace)
      if turning and not lost(before) and not lost(after) then
        local list = looked_at(rule, between(before.z, after.z, 64))
        local first, last
        for k, y in ipairs(list) do
          if lost(y) then first, last = first or k, k end
        end
        if first then
          out[#out + 1] = { narrow(rule, list[first - 1].z, list[first].z, lost),
            narrow(rule, list[last].z, list[last + 1].z, held) }
        end
      end
    end
  end
  return out
end

-- h omega at which a step turns by 2 pi / n: where the trace comes down through 2 cos(2 pi / n) for
-- the first time
local function resonances(rule, all)
  local out = {}
  for n = 3, 6 do
    local target = math.cos(2 * pi / n)
    local function below(x) return x.trace <= target end
    for i, x in ipairs(all) do
      if x.trace ~= x.trace then break end
      if below(x) then
        out[#out + 1] = { n = n, z = narrow(rule, i > 1 and all[i - 1].z or 1e-9, x.z, below) }
        break
      end
    end
  end
  return out
end

local kept = {}

-- what a rule does, looked at once in a session
local function profile(rule, tolerance)
  local key = type(rule) == "string" and rule .. ("/%g"):format(tolerance)
  if key and kept[key] then return kept[key] end
  local all = looked_at(rule, first_look())
  local out = { gaps = gaps(rule, all, tolerance), resonances = resonances(rule, all) }
  if key then kept[key] = out end
  return out
end

local function cause(rule, out)
  local name = tostring(rule):gsub("^rule ", "")
  if #out.gaps == 0 then
    return ("%s: both roots of the amplification matrix stay on or inside the unit circle up to h "
      .. "omega = %g: no limit"):format(name, END)
  end
  local z = out.gaps[1][1]
  if z < 1e-3 then
    return ("%s: a root of the amplification matrix is outside the unit circle for every step: it "
      .. "grows from the start"):format(name)
  end
  local m = looked_at(rule, { z })[1]
  if m.trace ~= m.trace then
    return ("%s: at h omega = %.6g there is no amplification matrix: its step has no solution")
      :format(name, z)
  end
  -- z is just outside: real roots have |trace| > 1
  local where = m.trace <= -1
    and "meet at -1 and part along the real axis: every step turns the oscillation by half a turn"
    or m.trace >= 1 and "meet at 1 and part along the real axis"
      or "leave the unit circle as a pair: the rule feeds energy into the oscillation"
  return ("%s: at h omega = %.6g the roots of the amplification matrix %s"):format(name, z, where)
end

local doc_limit = [[
dm.stability_limit(rule [, {tolerance=}]) -> z, {cause, gaps, resonances}
The linear stability of a rule: the largest z = h omega up to which no root of its amplification
matrix on the oscillator leaves the unit circle by more than tolerance (1e-6), by bisection;
infinity when none does up to 1e4. gaps: {from, to} of all intervals that are lost; resonances:
{n, z}, where a step turns by 2 pi / n (n = 3 to 6): near these a symplectic rule is unstable in
nonlinear forces, for n = 3 however small the amplitude; cause: a sentence.]]

M.stability_limit = blame.caller(function(rule, options)
  check_rule(rule, "dm.stability_limit")
  option.check(options or {}, { "tolerance" }, "dm.stability_limit", "{ tolerance = }")
  local tolerance = option.fraction(options or {}, "tolerance", "dm.stability_limit", 1e-6)
  local out = profile(rule, tolerance)
  local z = out.gaps[1] and out.gaps[1][1] or huge
  if z < 1e-3 then z = 0 end
  return z, core.result { cause = cause(rule, out), gaps = out.gaps, resonances = out.resonances }
end)

core.docs[M.amplification], core.docs[M.stability_limit] = doc_amplification, doc_limit

return M
