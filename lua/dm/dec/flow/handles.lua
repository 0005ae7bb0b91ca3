--- Handles of a surface that carries a flow: closed 1-forms eta that are no d psi, as many as the
-- surface has once every loop of its boundary is drawn together to a point. They are 0 along the
-- boundary, of no divergence inside and without flux out of holes, so that psi and they share no
-- energy. First integer cocycles: a tree of edges joins all vertices, a tree of triangles crosses
-- other edges, and every edge that is left is 1 in a cocycle that is 0 on the first tree; then from
-- each the nearest d phi is taken away (Hodge), and what is left is made orthonormal.
local core = require "dm.core"
local form = require "dm.dec.form"
local operator = require "dm.dec.equations.operator"
local option = require "dm.base.options"
local sample = require "dm.dec.equations.sample"

local M = {}

---- trees ----

-- sets that grow together: join(a, b) is true where they were two
local function sets()
  local parent = {}
  local function root(x)
    while parent[x] do
      if parent[parent[x]] then parent[x] = parent[parent[x]] end
      x = parent[x]
    end
    return x
  end
  return function(a, b)
    a, b = root(a), root(b)
    if a ~= b then parent[a] = b end
    return a ~= b
  end
end

-- edges of triangles { ab, bc, ac }, and of every edge its triangles
local function sides(K)
  local number, of, triangles = {}, {}, {}
  for e, ends in ipairs(K:simplices(1)) do number[ends[1] << 32 | ends[2]], of[e] = e, {} end
  for t, c in ipairs(K:simplices(2)) do
    local abc = { number[c[1] << 32 | c[2]], number[c[2] << 32 | c[3]], number[c[1] << 32 | c[3]] }
    for _, e in ipairs(abc) do table.insert(of[e], t) end
    triangles[t] = abc
  end
  return triangles, of
end

-- next[t]: list of { edge, triangle } of a tree of triangles; edges that are in neither tree
local function cut_open(K, of)
  local edges, joined, crossed = K:simplices(1), sets(), sets()
  local next, left, boundary = {}, {}, K:boundary_marks(1)
  for t = 1, K:count(2) do next[t] = {} end
  for e, ends in ipairs(edges) do
    if boundary[e] ~= 0 then joined(ends[1], ends[2]) end
  end
  for e, ends in ipairs(edges) do
    if boundary[e] == 0 and not joined(ends[1], ends[2]) then
      local s, t = of[e][1], of[e][2]
      if crossed(s, t) then
        table.insert(next[s], { e, t })
        table.insert(next[t], { e, s })
      else
        left[#left + 1] = e
      end
    end
  end
  return next, left
end

-- list of { triangle, the edge to the one before } of all trees of triangles, roots first
local function order_of(next)
  local order, seen = {}, {}
  for root = 1, #next do
    if not seen[root] then
      local at = #order + 1
      order[at], seen[root] = { root }, true
      while order[at] do
        for _, pair in ipairs(next[order[at][1]]) do
          if not seen[pair[2]] then
            seen[pair[2]] = true
            order[#order + 1] = { pair[2], pair[1] }
          end
        end
        at = at + 1
      end
    end
  end
  return order
end

-- the closed form that is 1 on the edge and 0 on others off the tree of triangles
local function cocycle(count, triangles, order, edge)
  local c = core.vector(count)
  c[edge] = 1
  for i = #order, 1, -1 do
    local t, e = order[i][1], order[i][2]
    if e then
      local abc = triangles[t]
      local turn = c[abc[1]] + c[abc[2]] - c[abc[3]] -- c[e] is 0 so far
      c[e] = e == abc[3] and turn or -turn
    end
  end
  return c
end

---- harmonic forms ----

-- c without the nearest d phi, phi a constant on every loop of the boundary
local function across(K, system, masses, c)
  local phi, load = core.vector(K:count(0)), K:incidence(0):transpose() * masses:map(function(x, e)
    return x * c[e]
  end)
  if system.solver then
    phi = core.spread(system.solver:solve(core.pick(load, system.solved)), system.solved, phi)
  end
  local holes = system.holes
  for i, g in ipairs(holes.list) do
    local factor = 0
    for j, other in ipairs(holes.list) do
      factor = factor + holes.inverse[(i - 1) * holes.count + j] * other:dot(load)
    end
    phi = phi + factor * g
  end
  return c - K:incidence(0) * phi
end

-- Gram and Schmidt's, twice: what the first one leaves is round-off
local function orthonormal(list, product)
  for k, form in ipairs(list) do
    for _ = 1, 2 do
      for j = 1, k - 1 do form = form - product(list[j], form) * list[j] end
    end
    list[k] = form / math.sqrt(product(form, form))
  end
  return list
end

--- { count, list of eta, on_triangles: their values on the edges ab and ac of all triangles, one
-- after the other }; masses: stars of edges; system: solved, solver, holes of the flow.
function M.of(K, system, masses)
  if not K.manifold then
    return { count = 0, list = {}, on_triangles = core.vector(0),
      note = "the surface is no manifold: flows round handles are left out" }
  end
  local triangles, of = sides(K)
  local next, left = cut_open(K, of)
  local order, list, flat = order_of(next), {}, {}
  for k, edge in ipairs(left) do
    list[k] = across(K, system, masses, cocycle(K:count(1), triangles, order, edge))
  end
  orthonormal(list, function(a, b) return a:dot(masses:map(function(x, e) return x * b[e] end)) end)
  for _, eta in ipairs(list) do
    for _, abc in ipairs(triangles) do
      flat[#flat + 1], flat[#flat + 2] = eta[abc[1]], eta[abc[3]]
    end
  end
  return { count = #list, list = list, on_triangles = core.vector(flat) }
end

---- the flow round them ----

--- How much of every eta the option 'harmonic' has, the velocity as a 1-form u: the integral of
-- eta ^ u, which is eta . beta for u = *beta. Left out: none.
function M.around(options, K, system, where)
  local handles, out = system.handles, {}
  local u = options.harmonic
  if u ~= nil and handles.count == 0 then
    option.fail(where, "option 'harmonic': the surface has no handles")
  end
  if form.is_form(u) then
    u = sample.values(u, K, operator.primal(1), K:count(1), nil, where, "option 'harmonic'")
  elseif type(u) == "number" or type(u) == "boolean" then
    option.fail(where, "option 'harmonic' must be a 1-form, a list of its values or a function")
  end
  u = u and K:form(1, u)
  for k, eta in ipairs(handles.list) do
    out[k] = u and K:form(1, eta):wedge(u).values:dot(system.sign) or 0
  end
  return core.vector(out)
end

--- beta = d psi + sum around[k] eta_k, a dm.form.
function M.beta(K, handles, psi, around)
  local beta = K:incidence(0) * psi
  for k, eta in ipairs(handles.list) do beta = beta + around[k] * eta end
  return K:form(1, beta)
end

return M
