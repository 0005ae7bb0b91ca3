-- sequences known by an equation: dm.sequence
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

-- x^2 = y + 1, y' = x: to the golden ratio
local function golden(more)
  local o = { equation = function(y, x) return { x[1] ^ 2 - y[1] - 1 } end, next = function(y, x) return { x[1] } end,
    start = function(y) return { y[1] } end, y = { 3 }, unknowns = 1, steps = 100 }
  for k, v in pairs(more or {}) do o[k] = v end
  return dm.sequence(o)
end
local rows, report = golden()
ok(report.code == "ok" and report.done == 100 and rows.rows == 101, "a row for every step and the start")
near(rows[101][1], (1 + math.sqrt(5)) / 2, 4e-16, "the golden ratio is the fixed point")
near(rows[2][1], 2, 4e-16, "one step by hand")
local sparse = golden { every = 30 }
ok(sparse.rows == 5 and sparse[2][1] == rows[31][1] and sparse[5][1] == rows[101][1], "every so many, and the last")
ok(golden({ steps = 0 }).rows == 1, "no step: the start alone")

-- two unknowns, against the closed form of an implicit midpoint step of the rotation (Cayley)
local h = 0.1
local spin, fine = dm.sequence { unknowns = 2, steps = 50, y = { 1, 0 }, start = function(y) return y end, next = function(y, x) return x end,
  equation = function(y, x) return { x[1] - y[1] - h / 2 * (x[2] + y[2]), x[2] - y[2] + h / 2 * (x[1] + y[1]) } end }
local angle = -50 * 2 * math.atan(h / 2)
near(spin[51][1], math.cos(angle), 1e-14, "the Cayley transform, fifty times")
near(spin[51][2], math.sin(angle), 1e-14, "and its other entry")
ok(fine.iterations <= 2, "a linear equation needs no search", fine.iterations)

-- failures keep the rows before them
local down, no_root = dm.sequence { equation = function(y, x) return { x[1] ^ 2 - y[1] } end, next = function(y, x) return { x[1] - 1 } end,
  start = function(y) return { y[1] + 0.1 } end, y = { 2 }, unknowns = 1, steps = 100 }
ok(no_root.code == "no_convergence" and no_root.done == down.rows - 1 and no_root.residual > 0, "no root: a report, and the rows so far")
near(down[2][1], math.sqrt(2) - 1, 4e-16, "which are right")
local _, outside = golden { inside = function(y, x) return { 10, x[1] - 1.7 } end }
ok(outside.outside == 2 and outside.code == "no_convergence", "a root that is not allowed: which condition it broke")
local _, nan = dm.sequence { equation = function(y, x) return { x[1] - y[1] } end, next = function(y, x) return { math.log(x[1] - 1) } end,
  start = function(y) return { 0 } end, y = { 2 }, unknowns = 1, steps = 5 }
ok(nan.code == "not_finite" and nan.done == 1, "what is not a number ends the sequence", nan.code)

raises("'equation' must be a function", dm.sequence, { y = { 1 }, unknowns = 1, steps = 1 })
raises("field 'y' must be a list", dm.sequence, { unknowns = 1, steps = 1 })
raises("did you mean 'steps'", dm.sequence, { step = 1 })
raises("must return 2 numbers", golden, { unknowns = 2 })
raises("too many", golden, { steps = 2 ^ 40 })

-- sums over windows made stationary: a hanging chain of two coordinates a site against its own equations, natural ends, misuse
local function stationary(more)
  local o = { term = function(w) return (w[2] - w[1]) ^ 2 / 2 + 0.1 * w[1] ^ 4 end, sites = 9, block = 1, window = 2,
    x = { 1, 0, 0, 0, 0, 0, 0, 0, 2 }, given = { true, false, false, false, false, false, false, false, true } }
  for k, v in pairs(more or {}) do o[k] = v end
  return dm.stationary(o)
end
local x, found = stationary()
local defect = 0
for i = 2, 8 do defect = math.max(defect, math.abs(2 * x[i] - x[i - 1] - x[i + 1] + 0.4 * x[i] ^ 3)) end
ok(found.code == "ok" and defect < 1e-15 and x[1] == 1 and x[9] == 2, "a chain with both ends given: its own equations hold", defect)
local free = stationary { given = { true, false, false, false, false, false, false, false, false } }
near(free[9], free[8], 1e-15, "a free end has the natural condition")
local _, lost = stationary { term = function(w) return math.log(w[1]) + w[2] end, x = { 1, -1, 0, 0, 0, 0, 0, 0, 2 } }
ok(lost.code == "not_finite", "a guess outside of the domain is reported", lost.code)
local _, flat = stationary { term = function(w) return w[2] - w[1] end }
ok(flat.code == "singular", "and a term without curvature", flat.code)
raises("'term' must be a function", dm.stationary, {})
raises("must be a list of booleans", stationary, { given = { true } })
raises("more sites than there are", stationary, { window = 10 })
raises("must return a number", stationary, { term = function() return {} end })

-- a sum that cancels while it is written keeps the sign of what comes behind it
local function cancelling(z)
  local p, q, r, u, a, b, c, s = table.unpack(z, 1, 8)
  local t9 = p * s - q * c
  local zero, t12, t13 = q * c + (t9 - p * s), r * c - (p * c + q * s), t9 + u * c
  return { zero, t13, t12 * b - t13 * a + zero * a }
end
local z = { 0.8, -0.3, 0.3, -0.1, 0.2, -0.4, 0.6, 0.5 }
local compacted = dm.sequence { check = false, unknowns = 1, steps = 1, y = z, start = function() return { 1 } end, equation = function(y, x) return { x[1] - 1 } end,
  next = function(y)
    local out = cancelling { y[1], y[2], y[3], y[4], y[5], y[6], y[7], y[8] }
    return { out[1], out[2], out[3], 0, 0, 0, 0, 0 }
  end }
for i, value in ipairs(cancelling(z)) do near(compacted[2][i], value, 1e-15, "compaction keeps the value of output " .. i) end
tap.done()
