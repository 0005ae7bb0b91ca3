--- Linear theory beside a map: the oscillations of a system along the orbit of a cell, and where a
-- rule loses them.
local blame = require "dm.base.blame"
local core = require "dm.core"
local fields = require "dm.stability.fields"
local lines = require "dm.stability.lines"
local rules = require "dm.stability.linear"

local M = {}

local abs, sqrt, max, huge = math.abs, math.sqrt, math.max, math.huge

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
  local fine, path = blame.try(function()
    return system:solver({ rule = "gauss(4)", h = h }):run { q = start.q, v = start.v, p = start.p,
      t0 = start.t, steps = steps, every = math.max(1, steps // PLACES),
      project = map.options.project, watch = { x = function(q) return q end,
      y = function(_, v) return v end } }
  end)
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
  local linearize = require "dm.measure.linearize".frozen
  local fine, its = blame.try(linearize, system,
    { q = state.q, v = state.v, p = state.p, t = state.t })
  if not fine then return false, (tostring(its):gsub("^[^\n]-lua:%d+: ", "")) end
  local first = out.matrices[1]
  out.constant = out.constant and not (first and differ(its.matrix, first))
  out.matrices[#out.matrices + 1] = its.matrix
  if its.fastest > out.fastest then out.fastest, out.where = its.fastest, #out.matrices end
  for k, w in ipairs(oscillations(its)) do out.sums[k] = (out.sums[k] or 0) + w end
  return true
end

-- The system linearised along the orbit of a cell: { fastest, matrices, modes = mean frequencies,
-- the largest first, constant }; nil and why. Where three states have one matrix all do; else it is
-- looked at again about the fastest one.
local function along_orbit(map, cell)
  local system, options = map.system_of(cell), map.options
  if system.field then return fields.along_orbit(map, cell, system) end
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
  local fine, z, told = blame.try(rules.stability_limit, rule)
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
  local system = map.system_of(cell)
  if system.line then return lines.limit(map, cell, system) end
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
  if map.system_of(cell).line then return nil, "they are not looked for on lines" end
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

return M
