--- Lyapunov exponents and MEGNO: tangent vectors that run beside an orbit by the exact tangent map
-- of the rule, and are made orthonormal again as they grow (Benettin, Galgani, Giorgilli & Strelcyn
-- 1980).
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local on_group = require "dm.measure.on_group"
local own_step = require "dm.measure.own_step"
local option = require "dm.base.options"
local prolong = require "dm.measure.prolong"
local prolonged = require "dm.measure.prolonged_run"
local starts = require "dm.base.start"
local tangent_space = require "dm.measure.tangent_space"

local M = {}

local abs, log, max, min = math.abs, math.log, math.max, math.min

local WHERE = "solver:lyapunov"
local LARGEST = 200  -- growth of ln |tangent vector| within a block: far from overflow
local SAME = 1e-6    -- of the largest entry of q, of p: ends of one orbit beside unlike vectors
local SPREAD = 10    -- of ln |w_1| - ln |w_k|: what is orthogonal to the first still has digits

---- tangent vectors w = (u, dp): lists of 2 n numbers ----

-- of vectors with what is measured of them behind them: of the last `size` entries
local function dot(a, b, size)
  local sum = 0
  for i = #a - size + 1, #a do sum = sum + a[i] * b[i] end
  return sum
end

-- the largest modulus
local function largest(a)
  local out = 0
  for i = 1, #a do out = max(out, abs(a[i])) end
  return out
end

local function scaled(a, factor)
  local out = {}
  for i = 1, #a do out[i] = a[i] * factor end
  return out
end

-- units of masses and of time are taken out of (u, dp): u sqrt(m) and dp T / sqrt(m), m the
-- diagonal of d2L/dv2 at the start and T = 1 where a step is a thousandth of it or more, and not
-- more
local function weights_of(solver, s)
  local fine, mass = blame.try(function()
    return solver.system:mass(s.q, solver.system:velocity(s.q, s.p, s.t), s.t)
  end)
  local n, out, h = s.n, {}, solver.h
  for i = 1, n do
    local m = fine and abs(mass[i][i]) or 1
    if not (m > 0 and m < math.huge) then m = 1 end
    out[i], out[n + i] = m ^ 0.5, max(h, min(1, 1000 * h)) / m ^ 0.5
  end
  return out
end

-- the first one: given, or one without symmetry
local function first_vector(options, n, weights)
  for _, name in ipairs { "u", "dp" } do
    local given = options[name]
    if given ~= nil and lists.count(given) ~= n then
      option.fail(WHERE, "option '%s' must be a vector or table of %d numbers (got %s)", name, n,
        tostring(lists.got(given)))
    end
  end
  local u, dp, out = options.u or {}, options.dp or {}, {}
  for i = 1, n do
    out[i] = u[i] or (options.dp and 0 or 1 / (1 + i) / weights[i])
    out[n + i] = dp[i] or (options.u and 0 or 1 / (2 + i * i) / weights[n + i])
  end
  for i = 1, 2 * n do
    if type(out[i]) ~= "number" or not (abs(out[i]) < math.huge) then
      option.fail(WHERE, "the entries of u and dp must be finite numbers (got %s)",
        option.got(out[i]))
    end
  end
  local size = largest(out)
  if size == 0 then option.fail(WHERE, "the tangent vector u, dp is zero") end
  if size > 1e100 or size < 1e-100 then return scaled(out, 1 / size) end -- its square has a value
  return out
end

-- Gram and Schmidt: the vectors made orthonormal in what is measured of them, and ln of what was
-- left of each
local function orthonormal(vectors, measured)
  local out, growth, size = {}, {}, #vectors[1]
  for j, w in ipairs(vectors) do
    w = measured(w)
    local whole = dot(w, w, size)
    for _ = 1, 2 do -- twice, for round-off
      for _, e in ipairs(out) do
        local share = dot(w, e, size)
        local left = {}
        for i = 1, #w do left[i] = w[i] - share * e[i] end
        w = left
      end
    end
    local left = dot(w, w, size)
    if not (left > 1e-24 * whole) then return nil, j end
    out[j], growth[j] = scaled(w, left ^ -0.5), 0.5 * log(left)
  end
  for j, w in ipairs(out) do out[j] = table.move(w, 1, size, 1, {}) end
  return out, growth
end

-- vector i of a basis along no axis: a vector in an invariant subspace would stay there until
-- round-off leads it out, with the rate of another one, and constraints may take an axis away
local function basis_vector(i, weights)
  local out = {}
  for j, x in ipairs(weights) do
    out[j] = (math.cos(2.7 * i * j + 1.3 * j) + (i == j and 1 or 0)) / x
  end
  return out
end

-- k vectors: the first, then those of a basis that are not in their span; of each what `allowed`
-- leaves
local function frame(first, k, s, allowed, weights)
  local measured, size = s.measured(s.q, s.t), #first
  local out = orthonormal({ allowed(first) }, measured)
  for i = 1, size do
    if out and #out == k then break end
    local more = table.move(out or {}, 1, out and #out or 0, 1, {})
    more[#more + 1] = allowed(basis_vector(i, weights))
    if largest(more[#more]) > 1e-8 then out = orthonormal(more, measured) or out end
  end
  if not out or #out < k then
    option.fail(WHERE, "constraints leave only %d independent tangent vectors: fewer exponents",
      out and #out or 0)
  end
  return out
end

---- a block of steps ----

-- (u, dp) in a row of a run of the prolonged system
local function vector_of(path, row)
  local x, p = path.q[row], path.p[row]
  local n = #x // 2
  return lists.joined(lists.part(x, n, n), lists.part(p, 0, n)):totable()
end

-- x -> the change that the constraints leave of it at the start: where a run of no steps begins
local function allowed_by(lifted, s)
  if not s.project then return function(x) return x end end
  local n = s.n
  return function(w)
    return vector_of(lifted:run { q = lists.joined(s.q, lists.part(w, 0, n)),
      p = lists.joined(lists.part(w, n, n), s.p), t0 = s.t, steps = 0, project = true }, 1)
  end
end

-- a number has outgrown all others: a shorter block is to be taken. Of inertia that is not said,
-- which is that of the orbit alone; short blocks would not know how it fell before.
local OUTGROWN = { not_finite = true, no_convergence = true }

-- the run of vector j beside the orbit from state s: its path and its end; nothing where a number
-- has outgrown all others
local function run_beside(lifted, s, j, steps, every)
  local n, w = s.n, s.vectors[j]
  local fine, path = blame.try(lifted.run, lifted, { q = lists.joined(s.q, lists.part(w, 0, n)),
    p = lists.joined(lists.part(w, n, n), s.p), t0 = s.t, steps = steps, every = every,
    project = s.project })
  if not fine then
    local code = type(path) == "table" and path.code
    if steps > 1 and OUTGROWN[code] then return nil end
    error(path, 0)
  end
  local x, p = path.q[#path], path.p[#path]
  return path, { q = lists.part(x, 0, n), p = lists.part(p, n, n), vector = vector_of(path, #path) }
end

-- Do two ends of a block belong to one orbit? Implicit steps solve for orbit and vector together:
-- orbits beside unlike vectors differ by rounding, and chaos makes much of that.
local function is_same_orbit(s, a, b)
  for _, name in ipairs { "q", "p" } do
    local size = max(largest(s[name]), largest(a[name]))
    for i = 1, s.n do
      if abs(a[name][i] - b[name][i]) > SAME * size then return false end
    end
  end
  return true
end

-- All vectors over a block. Nothing where they grow too far, or too far apart, or their orbits do:
-- a shorter one is then to be taken. s is changed only where it succeeds.
local function advance(lifted, s, steps, every)
  local vectors, path, finish = {}, nil, nil
  for j = 1, #s.vectors do
    local its_path, its_end = run_beside(lifted, s, j, steps, j == 1 and min(every, steps) or steps)
    if not its_path then return nil end
    if j == 1 then path, finish = its_path, its_end end
    if steps > 1 and not is_same_orbit(s, finish, its_end) then return nil end
    vectors[j] = its_end.vector
  end
  local now = s.t + steps * lifted.h
  local next_ones, growth = orthonormal(vectors, s.measured(finish.q, now))
  if not next_ones then
    if steps > 1 then return nil end
    option.fail(WHERE, "there are only %d independent tangent vectors: fewer exponents", growth - 1)
  end
  local least, largest = min(table.unpack(growth)), max(table.unpack(growth))
  if steps > 1 and (largest > LARGEST or least < -LARGEST or largest - least > SPREAD) then
    return nil
  end
  s.q, s.p, s.vectors = finish.q, finish.p, next_ones
  for j, x in ipairs(growth) do s.sums[j] = s.sums[j] + x end
  return path, max(abs(least), abs(largest)) / LARGEST, (largest - least) / SPREAD
end

---- what is recorded ----

-- MEGNO (Cincotta & Simo 2000): Y(t) = 2/t int (d ln|u|/ds) s ds, and its mean over time
local function follow(record, t, dt, growth)
  record.sum = record.sum + growth * (t - 0.5 * dt - record.t0)
  record.growth = record.growth + growth
  local Y = 2 * record.sum / (t - record.t0)
  record.mean = record.mean + 0.5 * (Y + record.Y) * dt
  record.Y = Y
end

local function note(record, t)
  local i, age = #record.t + 1, t - record.t0
  record.t[i], record.exponent[i] = t, record.growth / age
  record.megno[i] = record.mean / age
end

-- ln of the length of (u, dp) in a row
local function length_of(s, path, row)
  local w = vector_of(path, row)
  local size, x = #w, s.measured(lists.part(path.q[row], 0, s.n), path.t[row])(w)
  return 0.5 * log(dot(x, x, size))
end

-- the rows of a block that begins after `done` steps; those of every `every` steps are kept
local function note_block(record, s, path, done, steps, every, last)
  local before = 0 -- of a unit vector, which row 1 may have projected
  for i = 2, #path do
    local ln = length_of(s, path, i)
    follow(record, path.t[i], path.t[i] - path.t[i - 1], ln - before)
    before = ln
    local at = i == #path and done + steps or done + (i - 1) * every
    if at % every == 0 or at == last then note(record, path.t[i]) end
  end
end

-- Steps of the next block: within a row, or whole rows.
local function next_length(length, done, steps, every)
  if length >= every and done % every == 0 then length = length // every * every end
  if done % every ~= 0 then length = min(length, every - done % every) end
  return min(length, steps - done)
end

local function follow_all(lifted, s, steps, every, h)
  local record = { t0 = s.t, sum = 0, growth = 0, mean = 0, Y = 0, t = {}, exponent = {},
    megno = {} }
  local done, length, t0 = 0, every * 64, s.t
  while done < steps do
    local now = next_length(length, done, steps, every)
    local path, used, apart = advance(lifted, s, now, every)
    if path then
      note_block(record, s, path, done, now, every, steps)
      done, s.t = done + now, t0 + (done + now) * h
      if max(used, apart) < 0.25 and length < every * 4096 then length = length * 2 end
    else
      length = max(1, now // 2)
    end
  end
  return record
end

---- on a group or with a dm.step, by its own tangent map ----

local SHORT = 8  -- steps at most that vectors are followed before they are made orthonormal again

-- along(s, steps, vectors) of dm.measure.on_group
local function follow_on_group(along, s, steps, every, h)
  local record = { t0 = s.t, sum = 0, growth = 0, mean = 0, Y = 0, t = {}, exponent = {},
    megno = {} }
  local done = 0
  while done < steps do
    local now = next_length(SHORT, done, steps, every)
    local vectors = along(s, now, s.vectors)
    local next_ones, growth = orthonormal(vectors, s.measured(s.q, record.t0 + (done + now) * h))
    if not next_ones then
      option.fail(WHERE, "there are only %d independent tangent vectors: fewer exponents",
        growth - 1)
    end
    done, s.vectors = done + now, next_ones
    s.t = record.t0 + done * h
    for j, x in ipairs(growth) do s.sums[j] = s.sums[j] + x end
    follow(record, s.t, now * h, growth[1])
    if done % every == 0 or done == steps then note(record, s.t) end
  end
  return record
end

---- the verb ----

local doc_lyapunov = [[
solver:lyapunov{q=, v= | p=, steps= | t=, exponents=, every=, u=, dp=, t0=} -> {exponent, megno, t}
Follow one tangent vector (u, dp; default: one without symmetry) by the exact tangent map of the
rule. exponent: ln |growth| / t, the largest Lyapunov exponent, per unit of time, of the last row;
megno: the mean of MEGNO (Cincotta & Simo 2000), which tends to 2 on a regular orbit and to exponent
* t / 2 on a chaotic one. A row is taken every `every` steps (default: 1000 rows). history: {t,
exponent, megno} of all rows; q, p, t: the end. exponents = k, from 1 to 2 dim Q: k vectors that are
kept orthonormal; exponents: their rates of growth, the largest first, and sum of them, the rate at
which volumes of that dimension grow (Benettin et al. 1980). Vectors are rescaled as they grow, so
that no time is too long. Lengths are taken in units of the masses at the start, under constraints
of what of dp these leave, so that volumes are those of Liouville: all exponents of a symplectic
rule have the sum 0. On a group they are changes g^-1 dg and that of the body momentum.]]

-- the state of the orbit at the start
local function state_of(solver, options, n)
  if solver.system.place then
    prolonged.check_start(options)
    local s = on_group.start(solver.system, options)
    s.sums, s.n = {}, n
    return s
  end
  local q, p, t0 = prolonged.start_of(solver, options)
  return { n = n, t = t0, q = q, p = p, project = prolonged.is_constrained(solver), sums = {} }
end

M.lyapunov = blame.caller(function(solver, options)
  options, solver = starts.lists(options, solver)
  prolonged.check_options(options, WHERE,
    { "q", "v", "p", "t0", "steps", "t", "every", "u", "dp", "exponents" })
  prolonged.refuse(solver, WHERE)
  local own = solver.system.place
  if not own and not own_step.is(solver) and not prolonged.prolongs(solver) then
    option.fail(WHERE, "the method of these curves is not linear in the values of f, so that the "
      .. "prolonged system has other steps; solver:tangent knows their derivative")
  end
  local n, steps = own and own.dimension or #(options.q or {}), prolonged.steps_of(solver, options)
  if steps < 1 then option.fail(WHERE, "needs at least one step") end
  local every = option.whole(options, "every", WHERE, 1, steps, max(1, steps // 1000))
  local k = option.whole(options, "exponents", WHERE, 1, 2 * n, 1)
  local s, record = state_of(solver, options, n), nil
  local by_map, lifted = own or own_step.is(solver), nil
  if not by_map then lifted = prolonged.solver_of(solver, prolong.system(solver.system)) end
  local allowed = own and on_group.allowed(solver.system, s) or allowed_by(lifted, s)
  local weights = weights_of(solver, s)
  s.measured = tangent_space.measured(solver.system, weights)
  s.vectors = frame(first_vector(options, n, weights), k, s, allowed, weights)
  for j = 1, k do s.sums[j] = 0 end
  if by_map then
    local along = own and on_group.map(solver, WHERE) or own_step.map(solver, WHERE)
    record = follow_on_group(along, s, steps, every, solver.h)
  else
    record = follow_all(lifted, s, steps, every, solver.h)
  end
  local last, out, sum = #record.t, {}, 0
  for j = 1, k do
    out[j] = s.sums[j] / (steps * solver.h)
    sum = sum + out[j]
  end
  table.sort(out, function(a, b) return a > b end)
  return core.result { exponent = record.exponent[last], megno = record.megno[last],
    t = record.t[last], exponents = out, sum = sum,
    history = { t = core.vector(record.t), exponent = core.vector(record.exponent),
      megno = core.vector(record.megno) },
    q = s.q, p = s.p }
end)

class.method("dm.solver", "lyapunov", M.lyapunov, doc_lyapunov)

return M
