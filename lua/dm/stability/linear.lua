--- What linear theory says of a rule: its amplification matrix on the oscillator, its limit and its
-- resonances.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local abs, sqrt, max, pi, huge = math.abs, math.sqrt, math.max, math.pi, math.huge

---- the amplification matrix of a rule on the oscillator q'' = -q, h omega = z ----

local oscillator
local function unit_oscillator()
  oscillator = oscillator or core.system { Q = core.R(1), L = function(q, v)
    return (v[1] ^ 2 - q[1] ^ 2) / 2
  end }
  return oscillator
end

-- one step from both unit vectors for every z: entries a, b, c, d of ((a, b), (c, d)); where a step
-- fails NaN
local function matrices(rule, zs)
  local n = #zs
  local e = unit_oscillator():solver({ rule = rule, h = 1 }):ensemble { members = 2 * n, steps = 1,
    q = function(i) return { i % 2 } end, p = function(i) return { (i + 1) % 2 } end,
    h = function(i) return zs[(i + 1) // 2] end }
  local out, status = {}, e.status
  for i = 1, n do
    local j, k = 2 * i - 1, 2 * i
    local fine = status[j] == "ok" and status[k] == "ok"
    out[i] = fine and { a = e.q[j][1], b = e.q[k][1], c = e.p[j][1], d = e.p[k][1] }
      or { a = 0 / 0, b = 0 / 0, c = 0 / 0, d = 0 / 0 }
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
  if tostring(rule):find "^log%-hamiltonian" then
    error(what .. ": 'log-hamiltonian' changes the time with the state: its step on an oscillator "
      .. "is not linear", 0)
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

-- Runge-Kutta rules take any linear system apart into its oscillations; rules that treat q and v
-- differently those without forces that are linear in v (Coriolis, magnetic, friction) alone
local function takes_apart(rule, matrix)
  local name = tostring(rule)
  for _, pattern in ipairs { "^gauss%(", "^midpoint$", "^rk%d", "^rkf45", ",%s*midpoint%s*%)$",
    ",%s*gauss%(1%)%s*%)$" } do
    if name:find(pattern) and not name:find "^galerkin" and not name:find "^sprk" then
      return true
    end
  end
  local n, size = matrix.rows // 2, 0
  for i = 1, n do
    for j = 1, n do size = max(size, sqrt(abs(matrix[n + i][j]))) end
  end
  for i = 1, n do
    for j = 1, n do
      if abs(matrix[n + i][n + j]) > 1e-9 * size then return false end
    end
  end
  return true
end

---- along an orbit ----

local PLACES, LONGEST = 32, 2 ^ 14  -- states that are looked at, and steps of the orbit

-- states (q, v, t) at even times of a run of `steps` steps; nothing where it fails
local function orbit(map, system, start, h, steps)
  local fine, path = pcall(function()
    return system:solver({ rule = "gauss(4)", h = h }):run { q = start.q, v = start.v, p = start.p,
      t0 = start.t, steps = steps, every = math.max(1, steps // PLACES),
      project = map.options.project, watch = { x = function(q) return q end,
      y = function(_, v) return v end } }
  end)
  if not fine and blame.is_stop(path) then error(path, 0) end
  local out, n = {}, system.Q.dimension
  for i = 1, fine and #path or 0 do
    out[i] = { q = {}, v = {}, t = path.t[i] }
    for k = 1, n do
      out[i].q[k] = path:column(n == 1 and "x" or "x" .. k)[i]
      out[i].v[k] = path:column(n == 1 and "y" or "y" .. k)[i]
    end
  end
  return out
end

-- largest difference of two matrices, in parts of the largest entry
local function differ(a, b)
  local worst, size = 0, 0
  for i = 1, a.rows do
    for k = 1, a.columns do
      worst, size = max(worst, abs(a[i][k] - b[i][k])), max(size, abs(a[i][k]))
    end
  end
  return worst > 1e-12 * size
end

-- the frequencies above 0, the largest first
local function oscillations(linear)
  local out = {}
  for _, w in ipairs(linear.frequencies:totable()) do
    if w > 1e-9 * linear.fastest then out[#out + 1] = w end
  end
  table.sort(out, function(a, b) return a > b end)
  return out
end

-- notes what a system linearised at a state has; false where that cannot be
local function note(out, system, state)
  local linearize = require "dm.measure.linearize".linearize
  local fine, its = pcall(linearize, system, { q = state.q, v = state.v, p = state.p, t = state.t })
  if not fine then return false, (tostring(its):gsub("^[^\n]-lua:%d+: ", "")) end
  local first = out.matrices[1]
  out.constant = out.constant and not (first and differ(its.matrix, first))
  out.matrices[#out.matrices + 1] = its.matrix
  if its.fastest > out.fastest then out.fastest, out.where = its.fastest, #out.matrices end
  for k, w in ipairs(oscillations(its)) do out.sums[k] = (out.sums[k] or 0) + w end
  return true
end

-- The system linearised along the orbit of a cell: { fastest, matrices, modes = mean frequencies,
-- the largest first, constant }; nil and why. Where three states have one matrix all have; else the
-- run about the fastest state is looked at again.
local function along_orbit(map, cell)
  local system, options = map.system_of(cell), map.options
  local start = { q = map.start.q(cell), v = map.start.v and map.start.v(cell),
    p = map.start.p and map.start.p(cell), t = options.t0 or 0 }
  local T = options.t or options.steps * map.h[1]
  local h = math.min(map.h[1], T / PLACES)
  local steps = math.ceil(math.min(LONGEST, T / h))
  local states, out = orbit(map, system, start, h, steps), { fastest = 0, matrices = {}, sums = {},
    modes = {}, constant = true }
  local fine, why = note(out, system, states[1] or start)
  if not fine then return nil, why end
  for i = 2, #states do
    if i > 3 and out.constant then break end
    note(out, system, states[i])
  end
  for k, sum in ipairs(out.sums) do out.modes[k] = sum / #out.matrices end
  if not out.constant then
    local from, every = states[max(1, out.where - 1)], max(1, steps // PLACES)
    for _, state in ipairs(orbit(map, system, from, 2 * h * every / PLACES, PLACES)) do
      note(out, system, state)
    end
  end
  if not (out.fastest > 0) then return nil, "nothing oscillates along the orbit" end
  return out
end

-- the same, and what the rule does; nil and why
local function theory_of(map, cell)
  local rule = map.rule_list[cell.rule]
  local fine, z, told = pcall(M.stability_limit, rule)
  if not fine then return nil, (tostring(z):gsub("^[^\n]-lua:%d+: ", "")) end
  local linear, why = along_orbit(map, cell)
  if not linear then return nil, why end
  for _, matrix in ipairs(linear.matrices) do
    if not takes_apart(rule, matrix) then
      return nil, "forces linear in v (magnetic, Coriolis, friction) couple the oscillations, and "
        .. "this rule does not step each by itself"
    end
  end
  return linear, z, told
end

--- The step at which a frequency along the orbit of a cell meets the first window of growth of the
-- rule; nil where there is none; and a sentence.
function M.limit_along_orbit(map, cell)
  local linear, z, told = theory_of(map, cell)
  if not linear then return nil, z end
  local why = ("%s; omega = %.6g%s"):format(told.cause, linear.fastest,
    linear.constant and "" or " is the largest along the orbit")
  if z > 0 and told.gaps[1] and told.gaps[1][2] < huge then
    why = why .. ("; it grows up to h omega = %.6g"):format(told.gaps[1][2])
  end
  return z / linear.fastest, why
end

--- Steps on the axis that turn an oscillation of a cell by 2 pi / n: a list of { n, h, omega }; nil
-- and why.
function M.resonances(map, cell, axis)
  local linear, why, told = theory_of(map, cell)
  if not linear then return nil, why end
  local out, last = {}, nil
  for _, omega in ipairs(linear.modes) do
    if not last or abs(omega - last) > 1e-6 * last then
      for _, r in ipairs(told.resonances) do
        local h = r.z / omega
        if h >= axis[1] and h <= axis[#axis] then
          out[#out + 1] = core.result { n = r.n, h = h, omega = omega }
        end
      end
    end
    last = omega
  end
  table.sort(out, function(a, b) return a.h < b.h end)
  return out
end

core.docs[M.amplification], core.docs[M.stability_limit] = doc_amplification, doc_limit

return M
