--- dm.differential_invariants: the calculus of differential invariants of a group action, in exact
-- formulas (Fels & Olver 1999; Kogan & Olver 2003; Bogfjellmo 2.4, 5.2-5.4).
local core = require "dm.core"
local actions = require "dm.action"
local blame = require "dm.base.blame"
local F = require "dm.frame.calculus.field"
local formula = require "dm.frame.calculus.formula"
local layout = require "dm.frame.calculus.layout"
local normal = require "dm.frame.calculus.normal"
local option = require "dm.base.options"
local read = require "dm.frame.calculus.read"
local section = require "dm.frame.calculus.section"
require "dm.frame.calculus.text"

local M = {}


local WHERE = "dm.differential_invariants"
local fail = option.failing(WHERE)

local class = core.class({ __name = "dm.calculus" }, [[
dm.calculus: the differential invariants of an action, made by dm.differential_invariants
fields: action, names (of the invariants); methods give dm.formula.]])

local function method(name, f, doc) core.method("dm.calculus", name, blame.caller(f), doc) end

function class.__tostring(self)
  local C = self.C
  local words = {}
  for i, row in ipairs(C.named) do
    words[i] = ("%s = iota(%s)"):format(row.name, layout.name(C, row.entry))
  end
  return ("differential invariants of the %s: %s"):format(tostring(self.action),
    #words > 0 and table.concat(words, ", ") or "none are named")
end

---- making one ----

local KNOWN = { "action", "independent", "cross_section", "branch", "solution", "invariants" }

-- a list of the independent entries; nothing: a parameter
local function independent_of(o)
  local given, n = o.independent, o.action.dimension
  if given == nil then return nil end
  local list = type(given) == "table" and given or { given }
  local seen = {}
  for _, i in ipairs(list) do
    if math.type(i) ~= "integer" or i < 1 or i > n or seen[i] then
      fail("option 'independent' must be an entry of the point, 1 to %d, or a list of them (got "
        .. "%s)",
        n, option.got(i))
    end
    seen[i] = true
  end
  if #list == 0 or #list >= n then
    fail("option 'independent' must leave an entry that depends on the others")
  end
  return list
end

local function check_options(o)
  option.check(o, KNOWN, WHERE, "{ action =, cross_section =, invariants = { kappa = 4 } }")
  option.demand(actions.is_action(o.action), o, "action", WHERE, "a dm.action")
  option.need(o, "cross_section", WHERE,
    "a function of the jet that gives as many numbers as the group has dimensions")
  for _, key in ipairs { "cross_section", "branch", "solution" } do
    option.callable(o, key, WHERE, "the jet")
  end
  local action = o.action
  if action.base then fail("takes the action on points, not a lift or a joint action of it") end
  if action.side == "right" then
    fail("is for left actions: take that of the inverse, map = function(g, z) ... g^-1 ... end")
  end
  if action.on.dimension ~= action.dimension then
    fail("takes actions on coordinates, dm.R(n) or dm.T(n), not on %s", tostring(action.on))
  end
end

-- the named invariants, in the order of their entries
local function named_of(C, given)
  if given ~= nil and type(given) ~= "table" then
    fail("option 'invariants' must be a table such as { kappa = 4 }")
  end
  local out, at = {}, {}
  for name, entry in pairs(given or {}) do
    if type(name) ~= "string" or not name:match "^%a[%w_]*$" then
      fail("option 'invariants' must have names, { kappa = 4 } (got %s)", option.got(name))
    end
    if math.type(entry) ~= "integer" or entry < 1 or entry > layout.length(C, 8) then
      fail("invariants.%s must be an entry of the jet, a whole number from 1 (got %s)", name,
        option.got(entry))
    end
    out[#out + 1] = { name = name, entry = entry }
  end
  table.sort(out, function(a, b) return a.entry < b.entry or a.entry == b.entry
    and a.name < b.name end)
  for j, row in ipairs(out) do
    if at[row.entry] then
      fail("invariants '%s' and '%s' are one entry", out[at[row.entry]].name, row.name)
    end
    at[row.entry] = j
  end
  return out, at
end

local function check_named(C)
  for _, row in ipairs(C.named) do
    local value = C.section.value[row.entry]
    if value then
      fail("invariants.%s = %d: that entry, %s, is fixed by the cross-section (%s)", row.name,
        row.entry,
        layout.name(C, row.entry), tostring(value))
    end
  end
end

-- what the generators of the action and their derivatives are, in any algebra
local function read_generators(C, action)
  local n, r = action.dimension, C.r
  local function entries(z)
    local rows, out = actions.generator_rows(action, z), {}
    for i = 1, n do
      for a = 1, r do out[#out + 1] = rows[i][a] end
    end
    return core.vector(out)
  end
  C.read_generators = read.traced(entries, n, n * r)
  C.read_slopes = read.traced(function(z)
    local J, out = core.derivative(entries, n)(z), {}
    for i = 1, n * r do
      for j = 1, n do out[#out + 1] = J[i][j] end
    end
    return core.vector(out)
  end, n, n * r * n)
end

-- no frame: the isotropy of general jets says why
local function not_transversal(C)
  return function()
    local order = math.max(1, C.section.order)
    local lifted = C.action:jet(order, C.parametrized and nil
      or { independent = C.given_independent })
    local fine, isotropy = blame.try(function()
      local z = require "dm.action.points".sample_point(lifted.on, core.random(5), 3)
      return lifted:isotropy(z).dimension
    end)
    if fine and isotropy > 0 then
      fail("the jets of order %d have an isotropy group of dimension %d, so no cross-section "
        .. "fixes a "
        .. "frame: take a section of higher derivatives, or a smaller group", order, isotropy)
    end
    fail("the cross-section is not transversal to the orbits: J psi is singular on all of it; "
      .. "choose "
      .. "entries of the jet that the group does change")
  end
end

-- the words for D^k of an invariant, and its number by name
local function add_names(C)
  function C.find(name, where)
    local names = {}
    for j, row in ipairs(C.named) do
      if row.name == name then return j end
      names[j] = row.name
    end
    option.fail(where, "unknown invariant '%s': known are %s", tostring(name),
      #names > 0 and table.concat(names, ", ") or "none (invariants = { kappa = 4 } names one)")
  end
  function C.word(name, place) return tostring(normal.invariant(C, C.find(name, WHERE), place)) end
end

M.differential_invariants = blame.caller(function(o)
  check_options(o)
  local independent = independent_of(o)
  local C = layout.of(o.action, independent)
  C.action, C.r, C.field, C.given = o.action, o.action.group.dimension, F.new(), o
  C.parametrized, C.given_independent = independent == nil, o.independent
  C.entries, C.commutators, C.thetas, C.turned, C.varied, C.clocks = {}, {}, {}, {}, {}, {}
  C.lifts, C.rates, C.derivatives, C.rests = {}, {}, {}, {}
  for i = 1, C.p do C.rates[i], C.derivatives[i] = {}, {} end
  C.named, C.named_at = named_of(C, o.invariants)
  add_names(C)
  read_generators(C, o.action)
  section.read(C, core.one(o.cross_section, "cross_section"), o.branch)
  check_named(C)
  C.turning = normal.turning(C, not_transversal(C))
  local names = {}
  for j, row in ipairs(C.named) do names[j] = row.name end
  return setmetatable({ C = C, action = o.action, names = names }, class)
end)

core.docs[M.differential_invariants] = [[
dm.differential_invariants{action=, independent=, cross_section=, branch=, invariants=} -> calculus
The differential invariants of a left action on dm.R(n) by the moving frame of a cross-section of
its jets, in exact formulas. independent: as in action:jet, an entry of the point or a list of them;
left out: curves with a parameter that the group leaves alone. cross_section(z): of the jet, in the
order of action:jet, as many numbers as the group has dimensions, each linear in an entry, such as
z[3] or z[4] - 1; branch(z) > 0 on it. invariants = { kappa = 4 } names entries of the normalized
jet; the others follow from these and their derivatives kappa_s = D kappa along the invariant
arclength omega = iota(dx) (by several variables kappa_1, kappa_2, whose derivations do not commute;
by a parameter x kappa_x). Methods: iota, recurrence, syzygies, operator, maurer_cartan,
euler_lagrange, conservation_law, extremal, invariants. Raises where the section is not transversal
(the isotropy of the jets), cannot be solved, or an invariant that is needed has no name.]]

---- formulas of the frame ----

local function expression_of(C, k)
  if math.type(k) ~= "integer" or k < 1 then
    option.fail("calculus:iota", "takes an entry of the jet, a whole number from 1 (got %s)",
      option.got(k))
  end
  return normal.entry(C, k)
end

method("iota", function(self, k)
  local C = self.C
  return formula.new(C, { expression_of(C, k) })
end, [[
calculus:iota(k) -> dm.formula
Entry k of the jet, normalized, by the named invariants: of curves in the plane under SE(2) iota(6),
of u_xxxx, is kappa_ss + 3 kappa^3.]])

-- entries up to one order more than the section and the named invariants have
local function last_entry(C, more)
  local order = C.section.order
  for _, row in ipairs(C.named) do order = math.max(order, layout.order(C, row.entry)) end
  return layout.length(C, order + more)
end

method("recurrence", function(self)
  local C = self.C
  local rows, labels = {}, {}
  for k = 1, last_entry(C, 0) do
    local clock = layout.at(C, k).independent
    for i = 1, C.p do
      local sum, name = F.number(C.field, 0), layout.name(C, k)
      for a = 1, C.r do
        local phi = normal.phi(C, a, k)
        if not phi:is_zero() then sum = sum + normal.rate(C, i, a) * phi end
      end
      rows[#rows + 1] = sum
      local next_name = clock and (clock == i and "1" or "0")
        or ("iota(%s)"):format(layout.name(C, layout.derivative(C, k, i)))
      labels[#rows] = ("%s iota(%s) - %s"):format(layout.derivation(C, i), name, next_name)
    end
  end
  return formula.new(C, rows, { labels = labels })
end, [[
calculus:recurrence() -> dm.formula
What D iota(u_J) and iota(u_(J,x)) differ by, sum_a R^a iota(phi_J^a), for every entry of the jet up
to the order of the section and of the named invariants; by several variables for every D_i.]])

method("syzygies", function(self)
  local C = self.C
  local rows, labels = {}, {}
  for k = C.n + 1, last_entry(C, 2) do
    local ways = {}
    for _, from in ipairs(normal.below(C, k)) do
      if not C.section.value[from[1]] and not C.section.value[k] then ways[#ways + 1] = from end
    end
    for _, from in ipairs(ways) do
      local e = F.reduced(normal.by_recurrence(C, from[1], from[2]) - normal.entry(C, k))
      if not e:is_zero() then
        rows[#rows + 1] = e
        labels[#rows] = ("0, of iota(%s),"):format(layout.name(C, k))
      end
    end
  end
  return formula.new(C, rows, { labels = labels,
    none = "no syzygies: the invariants are free, nothing relates them and their derivatives" })
end, [[
calculus:syzygies() -> dm.formula
Expressions of the named invariants that vanish identically: where a derivative is reached in two
ways, up to two orders beyond the named invariants (Gauss and Codazzi of surfaces). None where the
invariants are free, as those of curves are unless too many are named.]])

method("maurer_cartan", function(self)
  local C = self.C
  local rows, labels = {}, {}
  for i = 1, C.p do
    for a = 1, C.r do
      rows[#rows + 1] = normal.rate(C, i, a)
      labels[#rows] = C.p == 1 and "R^" .. a or ("R_%d^%d"):format(i, a)
    end
  end
  return formula.new(C, rows, { labels = labels })
end, [[
calculus:maurer_cartan() -> dm.formula
(D rho) rho^-1, dim G formulas, its components in the basis of the algebra; by several variables
those of D_1 rho, then of D_2 rho.]])

require "dm.frame.calculus.methods"

return M
