--- Normalized jets: iota of every entry, and how it changes along the invariant derivations
-- D_1 ... D_p (Fels & Olver; Bogfjellmo 2.4). With phi_J^a the prolonged generators, R_i = -(J
-- psi)^-1 J iota(D_i z) = (D_i rho) rho^-1 and J = dZ:
--   D_i iota(u_J) = iota(u_(J,i)) + sum_a R_i^a iota(phi_J^a).
-- phi_J at a normalized jet is read off the power series u(x0 + t) = sum I_K t^K/K!: it is J! times
-- the coefficient of t^J in phi(x, u) - (xi(x, u) - xi(x0, u0)) u_x.
local F = require "dm.frame.calculus.field"
local layout = require "dm.frame.calculus.layout"
local series = require "dm.frame.calculus.series"

local M = {}

---- variables ----

--- The variable that stands for iota(entry k) until it is expressed by the named invariants.
function M.unknown(C, k)
  return F.variable(C.field, "entry " .. k, { rank = 1e9 + k, entry = k,
    text = ("iota(%s)"):format(layout.name(C, k)), tex = ("\\iota(%s)"):format(layout.name(C, k)) })
end

local GREEK = {}
for word in ([[alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau
phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega]]):gmatch "%a+" do
  GREEK[word] = "\\" .. word
end

local function marks(C, K)
  local letters = C.p == 1 and { #C.independent == 0 and "x" or "s" } or nil
  local out = {}
  for i = 1, C.p do
    local letter = letters and letters[i] or tostring(i)
    out[i] = K[i] > 5 and letters and ("%d%s"):format(K[i], letter) or letter:rep(K[i])
  end
  return table.concat(out)
end

--- The variable D^K of the named invariant j.
function M.invariant(C, j, place)
  local row, K = C.named[j], C.words.list[place]
  local below, base = marks(C, K), row.name
  local greek = GREEK[base] or (#base > 1 and ("\\mathrm{%s}"):format(base) or base)
  return F.variable(C.field, ("%s %d"):format(base, place), {
    rank = place * 1000 - j, name = base, invariant = j, place = place,
    text = below == "" and base or base .. "_" .. below,
    tex = below == "" and greek or ("%s_{%s}"):format(greek, below) })
end

---- generators at normalized jets ----

-- coefficients of t^K of the point of a normalized jet: a series for every entry
local function point_series(C, space, value)
  local out = {}
  for i, k in ipairs(C.independent) do
    out[k] = series.of(space, { [1] = value(k) })
    local one = {}
    for j = 1, C.p do one[j] = j == i and 1 or 0 end
    local place = space.place[table.concat(one, ",")] -- none in order 0
    if place then out[k] = out[k] + series.of(space, { [place] = 1 }) end
  end
  for c, k in ipairs(C.dependent) do
    local terms = {}
    for place = 1, #space.list do
      local x = value(layout.entry(C, c, place))
      if not x:is_zero() then terms[place] = x / space.factorial[place] end
    end
    out[k] = series.of(space, terms)
  end
  return out
end

local function coefficient(C, s, place)
  local c = type(s) == "table" and s.terms and s.terms[place] or place == 1 and type(s) ~= "table"
    and s or 0
  return F.is(c) and c or F.number(C.field, c)
end

local function is_series(x) return type(x) == "table" and x.terms ~= nil end

-- a series, also where the reader gave a number
local function as_series(space, x) return is_series(x) and x or series.of(space, x ~= 0 and { x }
  or {}) end

--- The generators along a normalized jet up to an order, value(k) being iota of entry k: phi[a][c]
-- [place] = iota(phi_K^a), xi[a][i] series, base[a][entry] series of the base generators, and slope
-- [a][entry][entry] series of their derivatives.
local function generators(C, order, value)
  local space = series.space(C.p, order)
  local z, r, n = point_series(C, space, value), C.r, C.n
  local flat = C.read_generators(z, series.apply)
  local out = { space = space, z = z, phi = {}, xi = {}, base = {} }
  for a = 1, r do
    out.base[a], out.xi[a], out.phi[a] = {}, {}, {}
    for i = 1, n do out.base[a][i] = as_series(space, flat[(i - 1) * r + a]) end
    for i, k in ipairs(C.independent) do out.xi[a][i] = out.base[a][k] end
  end
  for c, k in ipairs(C.dependent) do
    local rates = {}
    for i = 1, #C.independent do rates[i] = series.derivative(z[k], i) end
    for a = 1, r do
      local sum = out.base[a][k]
      for i = 1, #C.independent do
        local xi = out.xi[a][i]
        sum = sum - (xi - series.of(space, { xi.terms[1] })) * rates[i]
      end
      out.phi[a][c] = {}
      for place = 1, #space.list do
        out.phi[a][c][place] = coefficient(C, sum, place) * space.factorial[place]
      end
    end
  end
  return out
end

--- phi_k^a of an entry of the jet, from such generators.
local function phi_of(C, g, a, k)
  local at = layout.at(C, k)
  if at.independent then return coefficient(C, g.xi[a][at.independent], 1) end
  return g.phi[a][at.component][at.place]
end

--- Generators at a jet expressed by the named invariants, at least up to an order.
function M.generators(C, order)
  local g = C.expressed
  if not g or g.space.order[#g.space.order] < order then
    g = generators(C, order, function(k) return M.entry(C, k) end)
    C.expressed = g
  end
  return g
end

function M.phi(C, a, k) return phi_of(C, M.generators(C, layout.order(C, k)), a, k) end

---- the frame ----

-- solve A X = B by elimination in the field, A r x r; nothing where A is singular
local function solve(A, B)
  local r, width = #A, #B[1]
  for c = 1, r do
    local pivot
    for i = c, r do
      if not A[i][c]:is_zero() and (not pivot or A[i][c]:constant()) then pivot = i end
    end
    if not pivot then return nil, c end
    A[c], A[pivot], B[c], B[pivot] = A[pivot], A[c], B[pivot], B[c]
    local inverse = 1 / A[c][c]
    for k = c, r do A[c][k] = A[c][k] * inverse end
    for k = 1, width do B[c][k] = B[c][k] * inverse end
    for i = 1, r do
      local factor = A[i][c]
      if i ~= c and not factor:is_zero() then
        for k = c, r do A[i][k] = A[i][k] - A[c][k] * factor end
        for k = 1, width do B[i][k] = B[i][k] - B[c][k] * factor end
      end
    end
  end
  return B
end

M.solve = solve

--- T = -(J psi)^-1 J, r rows by the entries that the section depends on (C.section.entries); in
-- unknowns. singular(c) raises.
function M.turning(C, singular)
  local section, r = C.section, C.r
  local function value(k) return M.normalized(C, k) end
  local g = generators(C, section.order, value)
  local J, A = {}, {}
  for row = 1, r do
    J[row], A[row] = {}, {}
    for c, k in ipairs(section.entries) do
      local slope = F.partial(section.equations[row], section.variable[k])
      J[row][c] = F.map(slope, function(_, info) return M.normalized(C, info.entry) end)
      if not F.is(J[row][c]) then J[row][c] = F.number(C.field, J[row][c]) end
    end
    for a = 1, r do
      local sum = F.number(C.field, 0)
      for c, k in ipairs(section.entries) do
        if not J[row][c]:is_zero() then sum = sum + J[row][c] * phi_of(C, g, a, k) end
      end
      A[row][a] = sum
    end
  end
  local B, column = solve(A, J)
  if not B then return singular(column) end
  for a = 1, r do
    for c = 1, #section.entries do B[a][c] = -B[a][c] end
  end
  return B
end

--- iota of entry k as the section leaves it: its value there, or an unknown.
function M.normalized(C, k) return C.section.value[k] or M.unknown(C, k) end

--- e in unknowns, by the named invariants.
function M.express(C, e)
  local out = F.map(e, function(_, info) return M.entry(C, info.entry) end)
  return F.is(out) and out or F.number(C.field, out)
end

--- R_i^a = iota of (D_i rho) rho^-1.
function M.rate(C, i, a)
  local known = C.rates[i][a]
  if known then return known end
  local sum = F.number(C.field, 0)
  for c, k in ipairs(C.section.entries) do
    local t = C.turning[a][c]
    if not t:is_zero() then
      local at = layout.at(C, k)
      local moving = at.independent and F.number(C.field, at.independent == i and 1 or 0)
        or M.normalized(C, layout.derivative(C, k, i))
      sum = sum + t * moving
    end
  end
  C.rates[i][a] = M.express(C, sum)
  return C.rates[i][a]
end

---- entries by the named invariants ----

-- iota(u_(k,i)) = D_i iota(u_k) - sum R_i^a phi_k^a
local function by_recurrence(C, k, i)
  local sum = M.D(C, i, M.entry(C, k))
  for a = 1, C.r do
    local phi = M.phi(C, a, k)
    if not phi:is_zero() then sum = sum - M.rate(C, i, a) * phi end
  end
  return F.reduced(sum)
end
M.by_recurrence = by_recurrence

-- the entries whose derivative entry k is: { entry, i }
function M.below(C, k)
  local at, out = layout.at(C, k), {}
  for i = 1, at.place and C.p or 0 do
    local K = { table.unpack(C.words.list[at.place]) }
    K[i] = K[i] - 1
    local place = K[i] >= 0 and C.words.place[table.concat(K, ",")]
    if place then out[#out + 1] = { layout.entry(C, at.component, place), i } end
  end
  return out
end

local function unnamed(C, k)
  local names = {}
  for _, row in ipairs(C.named) do names[#names + 1] = ("%s = %d"):format(row.name, row.entry) end
  error(("dm.differential_invariants: entry %d of the jet, normalized, iota(%s), is not "
    .. "expressed by "
    .. "the invariants%s: name it too, invariants = { %s }"):format(k, layout.name(C, k),
    #names > 0 and " " .. table.concat(names, ", ") or " (none are named)",
    table.concat(names, ", ") .. (#names > 0 and ", " or "") .. "I" .. k .. " = " .. k), 0)
end

--- iota of entry k, by the named invariants and their derivatives.
function M.entry(C, k)
  local known = C.entries[k]
  if known then return known end
  if known == false then unnamed(C, k) end
  C.entries[k] = false
  local value = C.section.value[k]
  if value then
    value = M.express(C, value)
  elseif C.named_at[k] then
    value = M.invariant(C, C.named_at[k], 1)
  else
    for _, from in ipairs(M.below(C, k)) do
      if not value and not C.section.value[from[1]] then value = by_recurrence(C, from[1],
        from[2]) end
    end
    if not value then unnamed(C, k) end
  end
  C.entries[k] = value
  return value
end

---- invariant derivations ----

-- iota(D_j xi_a^k)
local function slope_of_clock(C, a, k, j)
  local g = M.generators(C, 1)
  return coefficient(C, g.xi[a][k], g.space.next[1][j])
end
M.slope_of_clock = slope_of_clock

--- Y with [D_i, D_j] = sum_k Y_k D_k, since d omega^k = sum R_i^a iota(D_j xi_a^k) omega^i omega^j.
function M.commutator(C, i, j)
  local key = i * 100 + j
  if C.commutators[key] then return C.commutators[key] end
  local out = {}
  for k = 1, C.p do
    local sum = F.number(C.field, 0)
    for a = 1, #C.independent > 0 and C.r or 0 do
      local x, y = slope_of_clock(C, a, k, i), slope_of_clock(C, a, k, j)
      if not x:is_zero() then sum = sum + M.rate(C, j, a) * x end
      if not y:is_zero() then sum = sum - M.rate(C, i, a) * y end
    end
    out[k] = F.reduced(sum)
  end
  C.commutators[key] = out
  return out
end

-- D_i iota(x^k) of an independent variable: delta + sum R_i^a xi_a^k
local function rate_of_clock(C, i, k)
  local sum = F.number(C.field, i == k and 1 or 0)
  for a = 1, C.r do
    local xi = M.phi(C, a, C.independent[k])
    if not xi:is_zero() then sum = sum + M.rate(C, i, a) * xi end
  end
  return sum
end

-- D_i of the variable D^K kappa_j: D_i D_l = D_l D_i + [D_i, D_l], so that the first derivation of
-- a word has the smallest number
local function rate_of(C, i, info)
  local clock = layout.at(C, C.named[info.invariant].entry).independent
  if clock then return rate_of_clock(C, i, clock) end
  local K = C.words.list[info.place]
  for l = 1, i - 1 do
    if K[l] > 0 then
      local less = { table.unpack(K) }
      less[l] = less[l] - 1
      local X = M.invariant(C, info.invariant, C.words.place[table.concat(less, ",")])
      local sum = M.D(C, l, M.D(C, i, X))
      for k, y in ipairs(M.commutator(C, i, l)) do
        if not y:is_zero() then sum = sum + y * M.D(C, k, X) end
      end
      return sum
    end
  end
  local place = C.words.next[info.place][i]
  if not place then error("a formula has derivatives of too high an order", 0) end
  return M.invariant(C, info.invariant, place)
end

--- The invariant derivation D_i of an expression.
function M.D(C, i, e)
  return F.derive(e, function(v, info)
    local known = C.derivatives[i][v]
    if not known then
      known = rate_of(C, i, info)
      C.derivatives[i][v] = known
    end
    return known
  end)
end

return M
