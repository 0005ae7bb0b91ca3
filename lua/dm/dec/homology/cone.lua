--- dm.cone: the operator p of the Poincare lemma (Leok 3.11). It takes chains of degree k to degree
-- k + 1 with d p + p d = 1 - projection, and its transpose, the cocone, makes potentials of closed
-- forms.
local blame = require "dm.base.blame"
local chain = require "dm.dec.chain"
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"

local M = {}

local Cone = core.class({ __name = "dm.cone" }, [[
dm.cone: an operator from chains of degree k to degree k + 1, made by K:cone(); p(c) is p of a chain
fields: mesh, rule, hub, poincare (has the mesh the homology of a point, so that d p + p d = 1 but
for the hub?), critical (critical[k], k from 0: cells in no pair of the matching; rules "matching",
"collapse")]])

local fail = option.fail

--- A cone. engine: chain(k, terms) -> terms of degree k + 1, both tables from cells to integers;
-- project(k, terms) -> terms of the same degree; cocone(k, values) -> values of degree k, or nil.
function M.new(mesh, rule, engine, fields)
  local p = setmetatable({ mesh = mesh, rule = rule, engine = engine }, Cone)
  for name, value in pairs(fields or {}) do p[name] = value end
  return p
end

function M.is_cone(x) return getmetatable(x) == Cone end

---- what it does ----

local function need_chains(p, where)
  if not p.engine.chain then
    fail(where, "rule \"linear\" has real coefficients, chains have integers; p:cocone(form) works")
  end
end

local function check_chain(p, c, where)
  if not chain.is_chain(c) or not rawequal(c.mesh, p.mesh) then
    fail(where, "a chain of the cone's mesh is needed (got %s)", option.got(c))
  end
end

Cone.__call = blame.caller(function(p, c)
  check_chain(p, c, "p(chain)")
  need_chains(p, "p(chain)")
  return chain.new(p.mesh, c.degree + 1, p.engine.chain(c.degree, c.coefficients))
end)

class.method("dm.cone", "project", function(p, c)
  check_chain(p, c, "cone:project")
  need_chains(p, "cone:project")
  return chain.new(p.mesh, c.degree, p.engine.project(c.degree, c.coefficients))
end, [[
p:project(c) -> dm.chain
The projection of d p + p d = 1 - projection: on a mesh that can be drawn together, vertices to the
hub and all else to nothing.]])

-- the transpose of p one cell after the other
local function cocone_of_chains(p, k, alpha)
  local values = core.zeros(p.mesh:count(k))
  for cell = 1, #values do
    local sum = 0.0
    for above, x in pairs(p.engine.chain(k, { [cell] = 1 })) do sum = sum + x * alpha[above] end
    values[cell] = sum
  end
  return values
end

--- Values of degree k from values alpha of degree k + 1.
function M.cocone(p, k, alpha)
  if p.engine.cocone then return p.engine.cocone(k, alpha) end
  return cocone_of_chains(p, k, alpha)
end

class.method("dm.cone", "cocone", function(p, a)
  if not form.is_form(a) or not rawequal(a.mesh, p.mesh) or a.side ~= "primal" or a.degree == 0 then
    fail("cone:cocone", "a primal form of the cone's mesh, of degree 1 or more, is needed (got %s)",
      form.is_form(a) and form.name(a) or option.got(a))
  end
  return form.new(p.mesh, a.degree - 1, "primal", M.cocone(p, a.degree - 1, a.values))
end, [[
p:cocone(a) -> dm.form
The transpose H of p, of degree one less: (H a)(c) = a(p c). H d + d H = 1 but for homology, so that
a closed form without periods is d of its cocone.]])

-- terms and all of `more`
local function add_all(terms, more)
  for cell, x in pairs(more) do chain.add(terms, cell, x) end
end

-- largest coefficient of d p c + p d c - c + projection of c, for a cell c
local function defect_of(p, k, cell)
  local m, engine = p.mesh, p.engine
  local out = { [cell] = -1 }
  local function add_boundary(terms, degree)
    for c, x in pairs(terms) do
      for j, face in ipairs(m:faces(degree, c)) do
        chain.add(out, face, j % 2 == 1 and x or -x)
      end
    end
  end
  add_boundary(engine.chain(k, { [cell] = 1 }), k + 1)
  if k > 0 then
    local below = {}
    for j, face in ipairs(m:faces(k, cell)) do below[face] = j % 2 == 1 and 1 or -1 end
    add_all(out, engine.chain(k - 1, below))
  end
  add_all(out, engine.project(k, { [cell] = 1 }))
  local largest = 0
  for _, x in pairs(out) do largest = math.max(largest, math.abs(x)) end
  return largest
end

class.method("dm.cone", "check", function(p)
  if p.engine.defect then return p.engine.defect() end
  local largest = 0
  for k = 0, p.mesh.dimension do
    for cell = 1, p.mesh:count(k) do largest = math.max(largest, defect_of(p, k, cell)) end
  end
  return largest
end, [[
p:check() -> number
The largest coefficient of d p + p d - 1 + projection over all cells: 0, exactly, but for rule
"linear", whose defect is round-off, or the homology that it cannot draw together.]])

function Cone.__tostring(p)
  return ("dm.cone (%s) of a mesh of dimension %d, hub %d%s"):format(p.rule, p.mesh.dimension,
    p.hub, p.poincare and "" or ", onto its homology")
end

return M
