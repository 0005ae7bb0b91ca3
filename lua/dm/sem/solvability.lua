--- solver:solvability: is there a step with the energy, and which?
--
-- With the momentum of the start held, E_d(h) - H = C h^p + ..., p the order of the curves (2 s):
-- short steps have an energy on one side of H only, that of the sign of C. For curves of degree 1
-- with the midpoint and L = |v|^2/2 - V(q), C = -(|grad V|^2 + p . V'' p)/8.
local class = require "dm.base.class"
local core = require "dm.core"
local options = require "dm.base.options"

local abs, huge, max = math.abs, math.huge, math.max

local WHERE = "solver:solvability"
local SHORTEST, LONGEST = 0.2, 4  -- of the solver's h: where roots are looked for
local SCAN, PART = 200, 16        -- points of the scan, of every narrower look
local LEVELS = 7                  -- lengths h/2^k of the limit

local ROUND = 1e-16

local function is_nan(x) return x ~= x end

-- `count` lengths from a to b
local function lengths(a, b, count)
  local out = {}
  for i = 0, count - 1 do out[i + 1] = i == count - 1 and b or a + (b - a) * i / (count - 1) end
  return out
end

-- f(h) = E_d - E of a list of lengths
local function excess(solver, start, E)
  return function(hs)
    local out = core.sem_energies(solver, start, hs)
    for i = 1, #hs do out[i] = out[i] - E end
    return out
  end
end

-- the zero between two lengths, narrowed until they are neighbours
local function narrow(f, a, b)
  local middle
  repeat
    local before = b - a
    local hs = lengths(a, b, PART)
    local fs = f(hs)
    middle = nil
    for i = 1, PART - 1 do
      if fs[i] == 0 then return hs[i] end
      if not middle and fs[i] * fs[i + 1] <= 0 then a, b, middle = hs[i], hs[i + 1], true end
    end
  until not middle or b - a >= before or b - a <= 4e-16 * b
  return 0.5 * (a + b)
end

-- all zeros that a scan sees, and the length where |f| is least
local function find_roots(f, h)
  local hs, out, nearest, least = lengths(SHORTEST * h, LONGEST * h, SCAN), {}, nil, huge
  local fs = f(hs)
  for i = 1, SCAN do
    if abs(fs[i]) < least then nearest, least = hs[i], abs(fs[i]) end
  end
  for i = 1, SCAN - 1 do
    if fs[i] * fs[i + 1] < 0 then
      out[#out + 1] = narrow(f, hs[i], hs[i + 1])
    elseif fs[i] == 0 then
      out[#out + 1] = hs[i]
    end
  end
  return out, nearest
end

-- the limit of (E_d - H)/h^p, the mean of h and -h, by Neville's scheme in h^2: the entry that its
-- neighbours agree with, as far as round-off of E_d lets them
local function limit(solver, start, p)
  local hs, T, best, error_of = {}, {}, nil, huge
  for k = 1, LEVELS do
    hs[k] = solver.h * 0.5 ^ (k - 1)
    hs[LEVELS + k] = -hs[k]
  end
  local E, H = core.sem_energies(solver, start, hs)
  for k = 1, LEVELS do
    local ahead, behind = (E[k] - H) / hs[k] ^ p, (E[LEVELS + k] - H) / (-hs[k]) ^ p
    T[k] = { 0.5 * (ahead + behind) }
    for j = 2, k do
      local a, b = T[k][j - 1], T[k - 1][j - 1]
      local value = a + (a - b) / (4 ^ (j - 1) - 1)
      local off = max(abs(value - a), abs(value - b)) + ROUND * (abs(H) + abs(E[k])) / hs[k] ^ p
      T[k][j] = value
      if off < error_of then best, error_of = value, off end
    end
  end
  return best, H
end

local function reason(out, E, H, nearest)
  if #out.h > 0 then
    return ("%d length%s from h/5 to 4 h %s the energy"):format(#out.h, #out.h == 1 and "" or "s",
      #out.h == 1 and "has" or "have")
  end
  if nearest == nil then return "no step from h/5 to 4 h can be made: begin with a smaller h" end
  if out.C and (E - H) * out.C < 0 then
    return ("short steps have E_d - H = C h^%d with C = %.6g, and E - H = %.6g has the other sign"):
      format(out.order, out.C, E - H)
  end
  return ("no length from h/5 to 4 h has the energy; E_d comes nearest at h = %.6g"):format(nearest)
end

class.method("dm.solver", "solvability", function(solver, given)
  options.check(given, { "q", "v", "p", "energy" }, WHERE, "{ q =, v =, energy = }")
  local start = { q = given.q, v = given.v, p = given.p }
  local first = core.sem_energies(solver, start, { solver.h })[1]
  local E = options.number(given, "energy", WHERE, "the energy of a step", first)
  if is_nan(E) then
    options.fail(WHERE, "no step of h = %g can be made from this state, whose energy was to be "
      .. "that of the others: take a smaller h, or give 'energy'", solver.h)
  end
  local roots, nearest = find_roots(excess(solver, start, E), solver.h)
  local C, H = limit(solver, start, solver.order)
  local out = core.result { solvable = #roots > 0, h = roots, C = C, order = solver.order,
    energy = E }
  out.why = reason(out, E, H, nearest)
  return out
end, [[
solver:solvability{q=, v= | p=, energy=} -> { solvable, h, C, order, energy, why }
Can a sem rule step from this state with this energy (left out: that of a step of the solver's h)?
h: the lengths from h/5 to 4 h whose discrete energy it is, growing. C: the limit of (E_d - H)/h^p
for h to 0, p = order, H the energy of the state: short steps have energies on that side of H only.
why: a sentence. Raises for rules that do not choose their steps.]])

return {}
