--- The Morse complex of a mesh: its critical cells under an acyclic matching, with the boundary
-- that flows along the pairs. It has the homology of the mesh, in integers, and few cells.
--
-- With h, f, g of dec/matching.h (dh + hd = 1 - g f) and P on the critical cells, where
-- dP + Pd = 1 - pi, p = h + g P f has dp + pd = 1 - g pi f.
local chain = require "dm.dec.chain"
local core = require "dm.core"
local integers = require "dm.dec.homology.integers"

local M = {}

local Morse = {}
Morse.__index = Morse

-- critical cells of every degree, and the place of each among them
local function list_criticals(m)
  m.critical, m.place = {}, {}
  for k = 0, m.mesh.dimension do
    m.critical[k], m.place[k] = m.matching:critical(k), {}
    for i, cell in ipairs(m.critical[k]) do m.place[k][cell] = i end
  end
end

--- The Morse complex of a mesh; options as those of dm.matching.
function M.new(mesh, absent, hub, collapse)
  local m = setmetatable({ mesh = mesh, boundaries = {}, forms = {}, groups = {},
    matching = core.matching(mesh, absent, hub, collapse) }, Morse)
  list_criticals(m)
  return m
end

local known = setmetatable({}, { __mode = "k" })

--- That of the whole mesh, made once.
function M.of(mesh)
  local m = known[mesh]
  if not m then
    m = M.new(mesh)
    known[mesh] = m
  end
  return m
end

--- How many critical cells of degree k; none outside of the mesh.
function Morse:count(k) return self.critical[k] and #self.critical[k] or 0 end

--- d of a table from cells of degree k to integers.
function Morse:boundary_of(k, terms)
  local out = {}
  for cell, x in pairs(terms) do
    for j, face in ipairs(self.mesh:faces(k, cell)) do
      chain.add(out, face, j % 2 == 1 and x or -x)
    end
  end
  return out
end

--- f: what is left of a chain of degree k on critical cells, as a list; and h of it, a table.
function Morse:reduce(k, terms)
  local along, rest = self.matching:flow(k, terms)
  local out = {}
  for i, cell in ipairs(self.critical[k]) do out[i] = rest[cell] or 0 end
  return out, along
end

--- g: the chain, a table, that a list of coefficients of critical cells stands for.
function Morse:extend(k, x)
  local out = {}
  for i, cell in ipairs(self.critical[k]) do
    if x[i] ~= 0 then out[cell] = x[i] end
  end
  if k == 0 or next(out) == nil then return out end
  for cell, y in pairs(self.matching:flow(k - 1, self:boundary_of(k, out))) do
    chain.add(out, cell, -y)
  end
  return out
end

--- The boundary of degree k, from the critical cells of degree k to those of degree k - 1.
function Morse:boundary(k)
  if self.boundaries[k] then return self.boundaries[k] end
  local columns = {}
  for j = 1, k > 0 and self:count(k) or 0 do
    columns[j] = self:reduce(k - 1, self:boundary_of(k, { [self.critical[k][j]] = 1 }))
  end
  self.boundaries[k] = integers.fill(self:count(k - 1), self:count(k), function(i, j)
    return columns[j][i]
  end)
  return self.boundaries[k]
end

--- Smith's form of the boundary of degree k.
function Morse:smith(k)
  self.forms[k] = self.forms[k] or integers.smith(self:boundary(k))
  return self.forms[k]
end

-- the columns of V from `first` on
local function columns_from(V, first)
  return integers.fill(V.rows, V.columns - first + 1, function(i, j) return V[i][first + j - 1] end)
end

--- Cycles over boundaries of degree k: `basis`, columns of critical cells, and `coordinates`, a
-- matrix that takes a cycle to its entries in this basis. Entry i counts modulo factors[i]: 1,
-- nothing; above, torsion; none, freely.
function Morse:group(k)
  if self.groups[k] then return self.groups[k] end
  local form = self:smith(k)
  local from = integers.part(form.X, form.rank + 1, self:count(k))
  local inside = integers.smith(integers.times(from, self:boundary(k + 1)))
  self.groups[k] = { factors = inside.factors, size = self:count(k) - form.rank,
    basis = integers.times(columns_from(form.V, form.rank + 1), inside.W),
    coordinates = integers.times(inside.U, from) }
  return self.groups[k]
end

--- The Betti number of degree k.
function Morse:betti(k)
  local rank = k > 0 and self:smith(k).rank or 0
  return self:count(k) - rank - self:smith(k + 1).rank
end

---- contraction of the critical cells ----

-- V D^+ U of the boundary of degree k + 1, over the integers only where the factor is 1
local function inverse(self, k, over_rationals)
  local s = self:smith(k + 1)
  return integers.fill(self:count(k + 1), self:count(k), function(i, j)
    local total = 0
    for l = 1, s.rank do
      local factor = s.factors[l]
      if s.V[i][l] ~= 0 and s.U[l][j] ~= 0 then
        if factor == 1 then total = chain.sum(total, chain.product(s.V[i][l], s.U[l][j]))
        elseif over_rationals then total = total + s.V[i][l] * s.U[l][j] / factor end
      end
    end
    return total
  end)
end

--- P: critical cells of degree k -> k + 1, such that dP + Pd = 1 - pi with a projection pi: on free
-- homology alone over the rationals, on torsion, too, over the integers. P_k (1 - P_(k-1) d) makes
-- a projection of it.
function Morse:contraction(k, over_rationals)
  local name = over_rationals and "rational" or "whole"
  self[name] = self[name] or {}
  if self[name][k] then return self[name][k] end
  local P = inverse(self, k, over_rationals)
  if k > 0 then
    local B = integers.times(inverse(self, k - 1, over_rationals), self:boundary(k))
    P = integers.plus(P, integers.times(P, B), -1)
  end
  self[name][k] = P
  return P
end

--- pi on the critical cells of degree k, over the integers.
function Morse:projection(k)
  local out = integers.plus(integers.unit(self:count(k)),
    integers.times(self:boundary(k + 1), self:contraction(k)), -1)
  if k == 0 then return out end
  return integers.plus(out, integers.times(self:contraction(k - 1), self:boundary(k)), -1)
end

return M
