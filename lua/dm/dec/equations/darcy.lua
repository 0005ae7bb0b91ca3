--- Darcy flow v = -kappa grad p, div v = q: the flux is a primal (n - 1)-form, the pressure a dual
-- 0-form. On every facet, with D = d of (n - 1)-forms, o the signs of the top cells and the
-- resistance R = sum over its cells S of |*facet in S| / (kappa_S |facet|),
--   R flux = D^T (o p) - (the sign of a boundary facet) (its pressure),   D flux = q.
-- Where no R is 0 the flux is eliminated; where one is (two cells with one centre) both are solved
-- for together, so such meshes need no pinv.
local class = require "dm.base.class"
local core = require "dm.core"
local loose = require "dm.dec.equations.loose"
local mass = require "dm.dec.equations.mass"
local matrices = require "dm.dec.equations.matrices"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local sample = require "dm.dec.equations.sample"
local solver = require "dm.dec.equations.solver"

local M = {}

local WHERE = "mesh:darcy"
local KNOWN = { "permeability", "source", "pressure", "flux", "solver" }
local SMALL = 1e-12 -- of the largest resistance: less is 0

local function fail(...) option.fail(WHERE, ...) end

---- what is given ----

-- resistances of the facets, exactly 0 where they are but rounding; how many are, and how many are
-- negative
local function resistances(K, options)
  local n = K.dimension
  local kappa = options.permeability
  if kappa == nil then kappa = 1 end
  local k = sample.values(kappa, K, operator.dual(0), K:count(n),
    function() return sample.barycentres(K, n) end, WHERE, "permeability")
  for i = 1, #k do
    if not (k[i] > 0) then fail("permeability must be > 0 (got %g in cell %d)", k[i], i) end
  end
  local R, volume = K:weighted_dual(n - 1, k:map(function(x) return 1 / x end)), K:volume(n - 1)
  local largest, zeros, negatives = 0, 0, 0
  for i = 1, #R do
    R[i] = R[i] / volume[i]
    largest = math.max(largest, math.abs(R[i]))
  end
  for i = 1, #R do
    if math.abs(R[i]) <= SMALL * largest then R[i], zeros = 0, zeros + 1 end
    if R[i] < 0 then negatives = negatives + 1 end
  end
  return R, zeros, negatives
end

-- the source of every top cell, about its ascending vertices
local function sources(K, options)
  local n = K.dimension
  local q = sample.values(options.source or 0, K, operator.primal(n), K:count(n),
    function() return sample.barycentres(K, n) end, WHERE, "source")
  if type(options.source) == "table" and options.source.degree then return q end
  local volume, out = K:volume(n), core.vector(K:count(n))
  for i = 1, #out do out[i] = q[i] * volume[i] end
  return K:oriented(out)
end

-- What holds at the boundary facets: marks of the facets whose flux is not known, their part of the
-- equations, the known fluxes; `held`: is a pressure given anywhere?
local function boundary(K, options)
  local n, facets = K.dimension, K:count(K.dimension - 1)
  local marks, signs = K:boundary_marks(n - 1), K:oriented(mass.ones(K, n))
  local pressure, flux = sample.on_facets(K, options.pressure, WHERE, "pressure"), options.flux
  local through = type(flux) == "table" and flux.values
    and sample.values(flux, K, operator.primal(n - 1), facets, nil, WHERE, "flux")
  local density = not through and sample.on_facets(K, flux, WHERE, "flux")
  local volume = K:volume(n - 1)
  local open, push, known, held = mass.ones(K, n - 1), core.vector(facets), core.vector(facets), {}
  for i = 1, facets do
    if marks[i] ~= 0 then
      local cell = K:cofaces(n - 1, i)[1]
      local outward = signs[cell]
      for j, face in ipairs(K:faces(n, cell)) do
        if face == i and j % 2 == 0 then outward = -outward end
      end
      local p = pressure(i)
      if p then
        push[i] = -outward * p
        held[#held + 1] = cell
      else
        open[i] = 0
        known[i] = through and through[i] or outward * (density(i) or 0) * volume[i]
      end
    end
  end
  return open, push, known, held
end

---- the system ----

-- for every component without a given pressure: the list of its cells; its source must be what
-- flows out, and its first cell is held
local function floating(K, held)
  local cells, has = K:simplices(K.dimension), {}
  for _, cell in ipairs(held) do has[cell] = true end
  return loose.lists(K, #cells, function(i) return cells[i][1] end, function(i) return has[i] end)
end

-- the source of such a component loses what does not flow out: per volume, for the report
local function balance(q, list, volume, signs)
  local sum, size = 0, 0
  for _, i in ipairs(list) do sum, size = sum + signs[i] * q[i], size + volume[i] end
  for _, i in ipairs(list) do q[i] = q[i] - signs[i] * sum / size * volume[i] end
  return sum / size
end

-- P = o p and flux on the open facets, from D flux = q, R flux = D^T P + push
local function eliminated(D, R, push, q, keep, wish)
  local T = R:map(function(x) return 1 / x end)
  local S = D:transpose():gram(T):pick(keep, keep)
  local s = solver.new(S, wish, WHERE)
  local through = matrices.diagonal(T) * push
  local P = core.spread(s:solve(core.pick(q - D * through, keep)), keep)
  return P, through + matrices.diagonal(T) * (D:transpose() * P), s
end

local function together(D, R, push, q, keep, wish)
  local kept = D:pick(keep)
  local facets, cells = D.columns, kept.rows
  local right, rest = core.vector(facets + cells), core.pick(q, keep)
  for i = 1, facets do right[i] = push[i] end
  for i = 1, cells do right[facets + i] = -rest[i] end
  local way = wish or (core.solvers() and "lu" or "dense")
  local s = solver.new(kept:saddle(R), way, WHERE)
  local x = s:solve(right)
  return core.spread(x:slice(facets + 1), keep), x:slice(1, facets), s
end

-- p with mean 0 on a component
local function centred(p, list, volume)
  local sum, size = 0, 0
  for _, i in ipairs(list) do sum, size = sum + volume[i] * p[i], size + volume[i] end
  for _, i in ipairs(list) do p[i] = p[i] - sum / size end
end

local function report_of(K, s, zeros, negatives, means)
  local report, notes = s:report(), {}
  if zeros > 0 then
    notes[1] = ("%d facets have a zero dual: flux and pressure are solved for together"):format(
      zeros)
  end
  if negatives > 0 then
    report.negative_stars = negatives
    notes[#notes + 1] = ("%d facets have a negative dual: the equations are not definite, and "
      .. "fluxes there may be far off; K:quality() counts them"):format(negatives)
  end
  notes[#notes + 1] = mass.note(K)
  if #notes > 0 then report.note = table.concat(notes, "; ") end
  if #means > 0 then
    report.mean = #means == 1 and means[1] or means
    report.text = "no pressure is given: what the sources have more than flows out is taken away, "
      .. "and the pressure has mean 0"
  end
  return report
end

class.method("dm.mesh", "darcy", function(K, options)
  option.check(options, KNOWN, WHERE)
  local wish, n = option.one_of(options, "solver", WHERE, solver.ways), K.dimension
  local signs, volume = K:oriented(mass.ones(K, n)), K:volume(n)
  local R, zeros, negatives = resistances(K, options)
  local open, push, known, held = boundary(K, options)
  local D = K:incidence(n - 1)
  local q, keep, means = sources(K, options) - D * known, mass.ones(K, n), {}
  local floats = floating(K, held)
  for c, list in ipairs(floats) do
    means[c] = balance(q, list, volume, signs)
    keep[list[1]] = 0
  end
  local way = zeros > 0 and together or eliminated
  local P, flux, s = way(D:pick(nil, open), core.pick(R, open), core.pick(push, open), q, keep,
    wish)
  local p = K:oriented(P)
  for _, list in ipairs(floats) do centred(p, list, volume) end
  return core.result { flux = K:form(n - 1, core.spread(flux, open, known)),
    pressure = K:form(0, p, { dual = true }), report = report_of(K, s, zeros, negatives, means) }
end, [[
K:darcy{permeability=, source=, pressure=, flux=, solver=} -> { flux, pressure, report }
Flow through a porous medium, v = -kappa grad p, div v = source. flux: the primal (n - 1)-form of v
through the facets, exact where p is linear; pressure: a dual 0-form, at the centres of cells.
permeability > 0: a number, a function of the point (asked at barycentres), a dual 0-form or a list
(1); source: the same as a density, or an n-form (0). At the boundary: pressure, a number or a
function of the circumcentre of a facet; where it gives nil, and without it, flux is the density
that flows outward, a number or a function of the circumcentre, or an (n - 1)-form (0). Without a
pressure the sources lose what does not flow out, the pressure has mean 0, and report.text says so.
report: solver, unknowns, note, negative_stars of facets. Fluxes and pressures converge where the
cells are well-centred, or nearly: barycentric duals lose that. Raises where the mesh is not
orientable (Leok 3.1).]])

return M
