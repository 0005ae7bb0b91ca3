--- K:cone: the rules by which a cone operator is made (Leok 3.11).
require "dm.dec.homology.augment" -- p:augment, p:carry
local chain = require "dm.dec.chain"
local class = require "dm.base.class"
local cone = require "dm.dec.homology.cone"
local linear = require "dm.dec.homology.linear_cone"
local matching = require "dm.dec.homology.matching_cone"
local morse = require "dm.dec.homology.morse"
local option = require "dm.base.options"
local star = require "dm.dec.homology.star_cone"

local fail = option.fail

-- is the homology that of a point?
local function is_acyclic(m)
  for k = 0, m.mesh.dimension do
    local group = m:group(k)
    local free = group.size - #group.factors
    if free ~= (k == 0 and 1 or 0) then return false end
    for _, factor in ipairs(group.factors) do
      if factor > 1 then return false end
    end
  end
  return true
end

local function of_morse(K, rule, m)
  return cone.new(K, rule, matching.engine(m),
    { critical = m.critical, poincare = is_acyclic(m), hub = m.critical[0][1] })
end

-- what collapses leave over, in words
local function core_text(m)
  local out = {}
  for k = 0, m.mesh.dimension do
    local count = m.matching:core(k)
    if count > 0 then out[#out + 1] = ("%d of degree %d"):format(count, k) end
  end
  return table.concat(out, ", ")
end

local rules = {}

function rules.matching(K, hub)
  return of_morse(K, "matching", hub and morse.new(K, nil, hub) or morse.of(K))
end

function rules.collapse(K, hub)
  local m = morse.new(K, nil, hub, true)
  local left = 0
  for k = 0, K.dimension do left = left + m.matching:core(k) end
  if left > 1 then
    fail("mesh:cone", "the mesh is not collapsible by free faces: cells that stay: %s; rule "
      .. "\"matching\" goes on, in integers", core_text(m))
  end
  return of_morse(K, "collapse", m)
end

-- to the hub in degree 0, to nothing above
local function to_hub(hub)
  return function(k, terms)
    if k > 0 then return {} end
    local out = {}
    for _, x in pairs(terms) do chain.add(out, hub, x) end
    return out
  end
end

local function of_table(K, rule, hub, engine)
  engine.project = to_hub(hub)
  return cone.new(K, rule, engine, { hub = hub, poincare = true })
end

function rules.star(K, hub) return of_table(K, "star", hub or 1, star.engine(K, hub or 1)) end

function rules.shells(K, hub)
  if hub and hub ~= 1 then fail("mesh:cone", "the hub of rule \"shells\" is vertex 1") end
  return of_table(K, "shells", 1, star.engine_of_shells(K))
end

function rules.linear(K, hub)
  local engine = linear.engine(K, hub or 1)
  return cone.new(K, "linear", engine, { hub = hub or 1, poincare = engine.defect() < 1e-9 })
end

local RULES = { "matching", "star", "shells", "collapse", "linear" }

class.method("dm.mesh", "cone", function(K, options)
  options = option.check(options or {}, { "rule", "hub" }, "mesh:cone")
  local rule = option.one_of(options, "rule", "mesh:cone", RULES, "matching")
  local hub = option.whole(options, "hub", "mesh:cone", 1, K:count(0))
  return rules[rule](K, hub)
end, [[
K:cone{rule=, hub=} -> dm.cone
A cone operator p of the Poincare lemma: d p + p d = 1 - projection (Leok 3.11). rule = "matching"
(the default): in integers along an acyclic matching of the cells, of any mesh; the projection is on
homology, torsion too. "collapse": along free faces; raises where they end before a vertex. "star":
sums of the simplices in the geometric cone from the vertex hub. "shells": that of dm.mesh{shells=},
whatever the points are. "linear": by pseudo-inverses, in real numbers; forms alone. hub: the vertex
that the mesh is drawn together to (default: the first).]])

return {}
