--- Holes of a surface that carries a flow: psi is a constant on every loop of the boundary, 0 on
-- the longest of each component, and what it is on the others, the holes, follows from the
-- circulation round them, which no flow changes (Kelvin). With functions g_i, harmonic inside, 1 on
-- hole i and 0 on all other loops, psi = psi_0 + sum c_i g_i, and Green's formula says
--   circulation_i = sum_j (g_i . S g_j) c_j + g_i . M w,
-- the integral of du = d psi/dn along the loop, with the fluid on the left.
local blame = require "dm.base.blame"
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

-- marks of the vertices of every loop, and its length
local function loops(K)
  local edge, vertices = K:boundary()
  if not edge then return {} end
  local of, count = edge:component_of()
  local out, lengths = {}, edge:volume(1)
  for i = 1, count do out[i] = { marks = core.vector(K:count(0)), length = 0 } end
  for i, v in ipairs(vertices) do
    local loop = out[of[i]]
    loop.marks[v], loop.vertex = 1, loop.vertex or v
  end
  for e, ends in ipairs(edge:simplices(1)) do
    local loop = out[of[ends[1]]]
    loop.length = loop.length + lengths[e]
  end
  return out
end

-- all loops but the longest of each component of the surface
local function inner(K, all)
  local of, longest, out = K:component_of(), {}, {}
  for _, loop in ipairs(all) do
    local c = of[loop.vertex]
    if not longest[c] or loop.length > longest[c].length then longest[c] = loop end
  end
  for _, loop in ipairs(all) do
    if longest[of[loop.vertex]] ~= loop then out[#out + 1] = loop.marks end
  end
  return out
end

--- { count, functions (all g_i, one after the other), list of them, inverse of g_i . S g_j, row by
-- row }; S: -div grad; solver: of S on the solved vertices, or nil.
function M.of(K, S, solved, solver)
  local marks, g, flat, inverse = inner(K, loops(K)), {}, {}, {}
  for i, one in ipairs(marks) do
    g[i] = one
    if solver then
      local x, at = solver:solve(S:pick(solved, nil) * one * -1), 0
      for v = 1, #one do
        if solved[v] ~= 0 then
          at = at + 1
          g[i][v] = x[at]
        end
      end
    end
    table.move(g[i]:totable(), 1, #g[i], #flat + 1, flat)
  end
  local rows = {}
  for i, one in ipairs(g) do
    local flux = S * one
    rows[i] = {}
    for j, other in ipairs(g) do rows[i][j] = flux:dot(other) end
  end
  local C = #g > 0 and core.matrix(rows):inverse()
  for i = 1, #g do
    for j = 1, #g do inverse[#inverse + 1] = C[i][j] end
  end
  return { count = #g, list = g, functions = core.vector(flat), inverse = core.vector(inverse) }
end

-- the circulations of a flow with vorticity w whose psi is 0 on all loops
local function at_rest(K, holes, w)
  local mass, load, out = K:dual_volume(0), core.vector(#w), {}
  for v = 1, #w do load[v] = mass[v] * w[v] end
  for i, one in ipairs(holes.list) do out[i] = one:dot(load) end
  return core.vector(out)
end

--- The option 'circulations', a number for every hole, or what it is when it is left out.
function M.circulations(options, K, holes, w, where)
  local given = options.circulations
  if given == nil then return at_rest(K, holes, w) end
  local fine, out = blame.try(core.vector, given)
  if not fine or type(given) == "number" or #out ~= holes.count then
    option.fail(where, "option 'circulations' must be a list with a number for every hole, %d in "
      .. "all", holes.count)
  end
  for i = 1, #out do
    if out[i] - out[i] ~= 0 then
      option.fail(where, "circulations[%d] must be finite (got %s)", i, option.got(out[i]))
    end
  end
  return out
end

return M
