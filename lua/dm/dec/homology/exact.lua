--- Exact sequences of free modules given by matrices, over the integers, the rationals or a prime
-- field (Leok, appendix A). A map from Z^a to Z^b is a list of b rows of a integers.
local blame = require "dm.base.blame"
local core = require "dm.core"
local integers = require "dm.dec.homology.integers"
local option = require "dm.base.options"
local smith = require "dm.dec.homology.smith"

local M = {}

---- rings ----

local MOST_PRIME = 2 ^ 31 -- products of two residues fit in 64 bits

local function is_prime(p)
  if math.type(p) ~= "integer" or p < 2 or p > MOST_PRIME then return false end
  for d = 2, math.tointeger(p ^ 0.5 // 1) do if p % d == 0 then return false end end
  return true
end

-- a^-1 modulo p, by Euclid's algorithm
local function inverse_modulo(a, p)
  local r, s, x, y = p, a % p, 0, 1
  while s ~= 0 do
    local q = r // s
    r, s, x, y = s, r - q * s, y, x - q * y
  end
  return x % p
end

local function reduced(A, p)
  return p and integers.fill(A.rows, A.columns, function(i, j) return A[i][j] % p end) or A
end

-- A B, modulo p where there is one
local function times(A, B, p)
  if not p then return integers.times(A, B) end
  return integers.fill(A.rows, B.columns, function(i, j)
    local total = 0
    for k = 1, A.columns do total = (total + A[i][k] * B[k][j]) % p end
    return total
  end)
end

-- rank, a matrix G with A G A = A, by elimination of [A | 1] modulo p: rows E A have units at the
-- pivots
local function form_modulo(A, p)
  local m, n, pivots = A.rows, A.columns, {}
  local T = integers.fill(m, n + m, function(i, j)
    return j <= n and A[i][j] % p or (j - n == i and 1 or 0)
  end)
  for c = 1, n do
    local row
    for i = #pivots + 1, m do if T[i][c] ~= 0 then row = row or i end end
    if row then
      local t = #pivots + 1
      T[t], T[row] = T[row], T[t]
      local scale = inverse_modulo(T[t][c], p)
      for j = 1, n + m do T[t][j] = T[t][j] * scale % p end
      for i = 1, m do
        local factor = T[i][c]
        if i ~= t and factor ~= 0 then
          for j = 1, n + m do T[i][j] = (T[i][j] - factor * T[t][j]) % p end
        end
      end
      pivots[t] = c
    end
  end
  local G = integers.zeros(n, m)
  for t, c in ipairs(pivots) do for j = 1, m do G[c][j] = T[t][n + j] end end
  return { rank = #pivots, is_saturated = true, torsion = {}, inverse = G }
end

-- the same by Smith's form, G = V D^+ U; over the integers G only where all factors are 1
local function form_of_integers(A, over)
  local s, torsion = integers.smith(A), {}
  for _, d in ipairs(s.factors) do if d > 1 then torsion[#torsion + 1] = d end end
  local is_saturated = over == "Q" or #torsion == 0
  return { rank = s.rank, is_saturated = is_saturated, torsion = over == "Z" and torsion or {},
    inverse = is_saturated and integers.fill(A.columns, A.rows, function(i, j)
      local total = 0
      for l, d in ipairs(s.factors) do
        if s.V[i][l] ~= 0 and s.U[l][j] ~= 0 then
          total = total + (d == 1 and s.V[i][l] * s.U[l][j] or s.V[i][l] * s.U[l][j] / d)
        end
      end
      return total
    end) }
end

local function ring_of(o, where)
  local over = o.over == nil and "Z" or o.over
  if over == "Z" or over == "Q" then return { over = over } end
  if is_prime(over) then return { over = over, p = over } end
  return option.fail(where, "option 'over' must be \"Z\", \"Q\" or a prime below 2^31 (got %s)",
    option.got(over))
end

-- a map with its form over a ring
local function read(A, ring, where)
  local out = { A = reduced(smith.read(A, where), ring.p) }
  out.form = ring.p and form_modulo(out.A, ring.p) or form_of_integers(out.A, ring.over)
  out.is_mono = out.form.rank == out.A.columns
  out.is_epi = out.form.rank == out.A.rows and out.form.is_saturated
  return out
end

local function check_shapes(f, g, where)
  if f.A.rows ~= g.A.columns then
    option.fail(where, "g must have %d columns, as many as f has rows (got %d)", f.A.rows,
      g.A.columns)
  end
end

-- im f = ker g
local function is_exact(f, g, ring)
  return integers.is_zero(times(g.A, f.A, ring.p)) and f.form.rank == f.A.rows - g.form.rank
    and f.form.is_saturated
end

---- dm.exact ----

local function plain(A)
  local out = {}
  for i = 1, A.rows do out[i] = table.move(A[i], 1, A.columns, 1, {}) end
  return out
end

local function minus(A, B, p)
  return integers.fill(A.rows, A.columns, function(i, j)
    local x = A[i][j] - B[i][j]
    return p and x % p or x
  end)
end

-- h with g h = 1, and k with k f = 1; where both are there k h = 0, so that (f, h) and (k, g) are
-- inverse to each other
local function splittings(f, g, ring, out)
  local h = g and g.is_epi and g.form.inverse
  local k = f.is_mono and f.form.inverse
  if h and k and out.exact then
    k = times(k, minus(integers.unit(g.A.columns), times(h, g.A, ring.p), ring.p), ring.p)
  end
  out.section, out.retraction = h and plain(h) or nil, k and plain(k) or nil
end

M.exact = blame.caller(function(f, g, options)
  local where = "dm.exact"
  options = option.check(options or {}, { "over" }, where)
  local ring = ring_of(options, where)
  f, g = read(f, ring, where), g and read(g, ring, where)
  if g then check_shapes(f, g, where) end
  local out = { over = ring.over, mono = f.is_mono, epi = not g or g.is_epi,
    exact = not g or is_exact(f, g, ring),
    cokernel = { rank = f.A.rows - f.form.rank, torsion = f.form.torsion } }
  splittings(f, g, ring, out)
  out.short = out.mono and out.exact and out.epi
  out.splits = out.short and out.retraction ~= nil
  return core.result(out)
end)

core.docs[M.exact] = [[
dm.exact(f [, g] [, {over=}]) -> {exact, mono, epi, short, splits, section, retraction, cokernel}
Is A -f-> B -g-> C exact, im f = ker g? Maps are lists of rows of integers; over = "Z" (the
default), "Q" or a prime. mono: is f one to one; epi: does g reach all of C; short: is 0 -> A -> B
-> C -> 0 exact; splits: then, is B the sum of A and C? section: h with g h = 1, retraction: k with
k f = 1, where there are any; if both and exact, k h = 0. cokernel of f: rank, torsion. Without g it
is C = B/im f, which over Z may have torsion: 0 -> Z -2-> Z -> Z/2 -> 0 does not split (Leok,
appendix A).]]

---- dm.five_lemma ----

local function read_all(list, count, name, ring)
  local where = "dm.five_lemma"
  if type(list) ~= "table" or #list ~= count then
    option.fail(where, "option '%s' must be a list of %d matrices (got %s)", name, count,
      type(list) == "table" and #list or option.got(list))
  end
  local out = {}
  for i = 1, count do out[i] = read(list[i], ring, where) end
  return out
end

local function is_row_exact(row, ring, is_short)
  for i = 1, #row - 1 do
    check_shapes(row[i], row[i + 1], "dm.five_lemma")
    if not is_exact(row[i], row[i + 1], ring) then return false end
  end
  return not is_short or row[1].is_mono and row[#row].is_epi
end

-- maps[i + 1] top[i] = bottom[i] maps[i]
local function commutes(top, bottom, maps, ring)
  for i = 1, #top do
    local a, b, c, d = maps[i + 1].A, top[i].A, bottom[i].A, maps[i].A
    if a.columns ~= b.rows or c.columns ~= d.rows or a.rows ~= c.rows or b.columns ~= d.columns then
      option.fail("dm.five_lemma", "the sizes of square %d do not fit", i)
    end
    if not integers.is_zero(minus(times(a, b, ring.p), times(c, d, ring.p), ring.p)) then
      return false
    end
  end
  return true
end

-- what the lemma says of the map in the middle: { mono =, epi = }
local function conclusion(maps)
  if #maps == 3 then
    return { mono = maps[1].is_mono and maps[3].is_mono, epi = maps[1].is_epi and maps[3].is_epi }
  end
  return { mono = maps[2].is_mono and maps[4].is_mono and maps[1].is_epi,
    epi = maps[2].is_epi and maps[4].is_epi and maps[5].is_mono }
end

M.five_lemma = blame.caller(function(o)
  option.check(o, { "top", "bottom", "maps", "over" }, "dm.five_lemma",
    "{ top =, bottom =, maps = }")
  local ring = ring_of(o, "dm.five_lemma")
  local count = type(o.maps) == "table" and #o.maps == 5 and 5 or 3
  local maps = read_all(o.maps, count, "maps", ring)
  local top = read_all(o.top, count - 1, "top", ring)
  local bottom = read_all(o.bottom, count - 1, "bottom", ring)
  local out = { maps = {}, commutes = commutes(top, bottom, maps, ring),
    exact = is_row_exact(top, ring, count == 3) and is_row_exact(bottom, ring, count == 3) }
  for i, a in ipairs(maps) do
    out.maps[i] = { mono = a.is_mono, epi = a.is_epi, iso = a.is_mono and a.is_epi }
  end
  local says = conclusion(maps)
  says.mono, says.epi = out.commutes and out.exact and says.mono, out.commutes and out.exact
    and says.epi
  out.says = { mono = says.mono, epi = says.epi, iso = says.mono and says.epi }
  local middle = out.maps[(count + 1) // 2]
  out.holds = (not says.mono or middle.mono) and (not says.epi or middle.epi)
  return core.result(out)
end)

core.docs[M.five_lemma] = [[
dm.five_lemma{top=, bottom=, maps=, over=} -> {commutes, exact, maps, says, holds}
The five lemma on a diagram of two rows: top and bottom are lists of two maps, short exact rows, and
maps the three between them; or four, and five. commutes, exact: is the diagram as the lemma asks?
maps[i]: mono, epi, iso of each; says: what the lemma then says of the one in the middle; holds: so
it is. over as for dm.exact (Leok, appendix A).]]

return M
