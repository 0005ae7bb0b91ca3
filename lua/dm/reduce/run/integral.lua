--- Integrals along a run by the rule's own quadrature: h sum_j b_j f(X_j, X'_j, t_j) over the
-- stages of every step. L + sum_i (W k'_i z'_i + k_i f_i) with k = z = 0 and k', z' at rest leaves
-- the motion of L as it is, since f enters the equations of L times k = 0, while the momentum of
-- k_i grows by h sum_j b_j f_i in every step, whatever the rule is. W keeps z' = p_k / W small
-- beside x', since steps are solved to an accuracy relative to the largest velocity.
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local W = 2 ^ 20

-- the system with r passive pairs (k, z); f(x, v, t) gives r values
local function extended(system, f, r)
  local given, d = system.given, system.Q.dimension
  local out = { Q = core.R(d + 2 * r) }
  local function head(y) return lists.part(y, 0, d) end
  out.L = function(y, w, t)
    local x, v = head(y), head(w)
    local values, sum = f(x, v, t), given.L(x, v, t, given.params)
    for i = 1, r do sum = sum + W * w[d + i] * w[d + r + i] + y[d + i] * values[i] end
    return sum
  end
  if given.constraint then
    out.constraint = function(y, t) return given.constraint(head(y), t, given.params) end
  end
  local function wide(row) return lists.joined(row, lists.zeros(2 * r)) end
  if given.force then
    out.force = function(y, w, t) return wide(given.force(head(y), head(w), t, given.params)) end
  end
  if given.rolling then
    out.rolling = function(y, w, t) return given.rolling(head(y), head(w), t, given.params) end
  end
  if given.reaction then
    out.reaction = function(y, w, t)
      local rows = {}
      for i, row in ipairs(check.rows(given.reaction(head(y), head(w), t, given.params))) do
        rows[i] = wide(row)
      end
      return rows
    end
  end
  return core.system(out)
end

-- rows of a path at equal steps: how many steps apart, or nothing
local function spacing(path)
  local h, t0 = path.h, path.t[1]
  if #path < 2 then return 1 end
  local every = math.floor((path.t[2] - t0) / h + 0.5)
  for i = 2, #path do
    local steps = math.min((i - 1) * every, path.steps)
    if math.abs(path.t[i] - t0 - steps * h) > 1e-9 * h * math.max(1, steps) then return nil end
  end
  return math.max(every, 1)
end

-- rows first .. last of the path again, with the integrals; columns of the run
local function again(path, solver, d, r, first, last, every)
  local options = { q = lists.joined(path.q[first], lists.zeros(2 * r)),
    p = lists.joined(path.p[first], lists.zeros(2 * r)), t0 = path.t[first] }
  if every then
    options.steps, options.every = math.floor((path.t[last] - path.t[first]) / path.h + 0.5), every
  else
    options.at = {}
    for i = first, last do options.at[#options.at + 1] = path.t[i] end
  end
  local run, x, k = solver:run(options), {}, {}
  local names = run.columns
  for j = 1, d do x[j] = run:column(names[1 + j]) end
  for i = 1, r do k[i] = run:column(names[1 + d + 2 * r + d + i]) end
  return #run, x, k
end

-- rows of the new run, counted from the first, that lie on the path
local function agree(path, x, d, first, rows)
  for i = 1, rows do
    local q = path.q[first + i - 1]
    for j = 1, d do
      if not (math.abs(x[j][i] - q[j]) <= 1e-11 * math.max(1, math.abs(q[j]))) then return i - 1 end
    end
  end
  return rows
end

local LOST = "the rows of this path are not followed by '%s' from row %d: is the motion chaotic "
  .. "and rows far apart (keep more of them, a smaller every), does that row lie within a step "
  .. "(let 'at' begin with the start), are stages left unsolved (gauss(s, sweeps)), or were "
  .. "they made by another rule or system, or have its params changed since?"

--- The integrals of f (r values) from the first row to every row: r lists. Where the run again
-- leaves the path (round-off on a chaotic orbit), it goes on from the last row that it reached.
function M.along(path, system, f, r)
  local d, rows = system.Q.dimension, #path
  local given = path.solver
  local solver = extended(system, f, r):solver {
    rule = given and given.rule or path.rule, h = path.h,
    newton = given and { tolerance = given.tolerance, max_iterations = given.max_iterations } }
  local every, out, first, most = spacing(path), {}, 1, rows
  for i = 1, r do out[i] = { 0 } end
  while first < rows do
    local last = math.min(rows, first + most)
    local got, x, k = again(path, solver, d, r, first, last, every)
    local fine = agree(path, x, d, first, math.min(got, last - first + 1))
    if fine < 2 then error(LOST:format(path.rule, first), 0) end
    for i = 1, r do
      local base = out[i][first]
      for row = 2, fine do out[i][first + row - 1] = base + k[i][row] end
    end
    if first + fine - 1 < last then most = fine end
    first = first + fine - 1
  end
  return out
end

return M
