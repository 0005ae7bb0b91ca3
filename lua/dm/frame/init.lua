--- Moving frames (Fels & Olver): rho(z) is the group element that brings z to a cross-section Z = 0
-- of the orbits.
--
-- The frame is right-equivariant, rho(g z) = rho(z) g^-1, so z -> rho(z) z does not change along
-- orbits: its entries are the fundamental invariants, and F(rho(z) z) is an invariant function
-- whatever F is (Bogfjellmo ch. 2). rho is the user's formula, or the root of Z(g z) = 0 in flat
-- coordinates of the group; both take symbols.
local actions = require "dm.action"
local groups = require "dm.group"
local blame = require "dm.base.blame"
local class_methods = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local options = require "dm.base.options"
local tangent = require "dm.frame.tangent"
local partial = class_methods.module(function() return require "dm.frame.partial" end)
local points = require "dm.frame.points"
local text = require "dm.frame.text"
local trial = require "dm.frame.trial"

local M = {}

local point, split, flat = points.point, points.split, points.flat

local class = core.class({ __name = "dm.frame" }, [[
dm.frame: a moving frame, made by dm.moving_frame{action=, points=, cross_section=}
fields: action, group, points, cross_section, branch, solution, name; rho(z1, ..., zk) is the group
element.]])
class.__tostring = text.describe

function M.is_frame(x) return type(x) == "table" and getmetatable(x) == class end
local function method(name, f, doc) core.method("dm.frame", name, blame.caller(f), doc) end

local KNOWN = { "action", "points", "cross_section", "branch", "solution", "start", "name",
  "invariants", "partial" }
local NAME = "dm.moving_frame"
local fail = options.failing(NAME)

---- lists of points ----

local function points_of(self, list, least)
  local out = points.list(list, self.m,
    "a list of points is wanted (got " .. kits.class_of(list) .. ")")
  if #out < least then
    error(("%s is made of %d points (got %d)"):format(text.name(self), least, #out), 0)
  end
  return out
end

-- points given one by one or as one list
local function listed(self, ...)
  local first = ...
  if select("#", ...) > 1 or not blame.try(function() return #first end) then return { ... } end
  return points.unstacked(first, self.m)
end

local function moved(self, g, list)
  local out = {}
  for i, z in ipairs(list) do out[i] = actions.move(self.action, g, z) end
  return out
end

-- Z of a list of k points as a list of numbers
local function section(self, list)
  return points.entries(self.cross_section(table.unpack(list, 1, self.k)))
end

M.point, M.flat, M.split, M.list = point, flat, split, points.list
M.points_of, M.listed, M.moved, M.section = points_of, listed, moved, section

---- making one ----

local function check_options(o)
  options.check(o, KNOWN, NAME, "{ action =, points =, cross_section = }")
  options.demand(actions.is_action(o.action), o, "action", NAME, "a dm.action")
  options.need(o, "cross_section", NAME, "a function of the points that gives as many numbers "
    .. "as the group has dimensions")
  for _, key in ipairs { "cross_section", "branch", "solution" } do
    options.callable(o, key, NAME, "the points")
  end
  options.text(o, "name", NAME)
  if o.solution then
    options.meaningless(o, "start", NAME, "nothing is solved for beside a solution")
  end
  options.demand(o.invariants == nil or type(o.invariants) == "table", o, "invariants", NAME,
    "a table { name = { point, entry } or a function }")
end

-- the action on one point and the number of points: on_pairs() and on_points(k) are joint actions
-- of their own
local function base_of(o)
  local action, k = o.action, o.points
  if action.base and action.points then
    if k and k ~= action.points then
      fail("the action is on %d points already, so 'points' cannot be %s", action.points,
        tostring(k))
    end
    return action.base, action.points
  end
  return action, options.whole(o, "points", NAME, 1, 16, 1)
end

-- as many equations as dimensions, at a point that is not special
local function check_section(self)
  local list = points.sample(self, 1)
  debug.getregistry().dm_forget()
  local fine, value = blame.try(section, self, list)
  if not fine then
    fail("the cross-section fails at %s: %s", text.points(list), tostring(value))
  end
  if #value == 0 then
    fail("the cross-section gives nothing: %s",
      debug.getregistry().dm_noted() or "is a return missing?")
  end
  for i = 1, #value do
    if type(value[i]) ~= "number" then
      fail("entry %d of the cross-section must be a number (got %s)", i, type(value[i]))
    end
  end
  if #value ~= self.r then
    fail("the cross-section has %d equation%s, but the group has %d dimension%s: it must return as "
      .. "many numbers as the group has dimensions%s", #value, #value == 1 and "" or "s", self.r,
      self.r == 1 and "" or "s", partial.advice(self))
  end
end

-- the branch condition at a list of points: a number that must be > 0, or several
local function branch_values(self, list)
  if not self.branch then return {} end
  return points.entries(self.branch(table.unpack(list, 1, self.k)))
end

local function check_branch(self)
  local list = points.sample(self, 1)
  local fine, values = blame.try(branch_values, self, list)
  if not fine then fail("the branch fails at %s: %s", text.points(list), tostring(values)) end
  if self.branch and #values == 0 then fail "the branch gives nothing: is a return missing?" end
  for _, b in ipairs(values) do
    if type(b) ~= "number" then
      fail("the branch must return a number that is > 0 where it holds, or several (got %s)",
        type(b))
    end
  end
end

local function least(values)
  for i = 1, #values do
    if not kits.is_scalar(values[i]) then
      fail("the branch must return a number that is > 0 where it holds, or several (got %s)",
        kits.class_of(values[i]))
    end
  end
  local out = values[1]
  for i = 2, #values do out = core.min(out, values[i]) end
  return out
end

-- where Newton's method begins, in turn: the identity, a quarter, a half and a whole turn's worth
-- from it along every axis, and, where one axis is not enough (SO(4), SL(3)), elements that are
-- spread over the group, always the same
local TURNS, SPREAD = { 1.6, -1.6, 3.1, 0.7, -0.7, -2.4, 2.4 }, 8
local begun = setmetatable({}, { __mode = "k" }) -- by the kit of the group
local function beginnings(G, r)
  local kit = kits.of(G)
  if begun[kit] then return begun[kit] end
  local out = { kits.list_of(kit.flat(kit.identity())) }
  for _, angle in ipairs(TURNS) do
    for j = 1, r do
      local xi = {}
      for i = 1, r do xi[i] = i == j and angle or 0 end
      out[#out + 1] = kits.list_of(kit.flat(kit.exp(core.vector(xi))))
    end
  end
  local stream = core.random(5)
  for i = 1, r > 3 and SPREAD or 0 do
    out[#out + 1] = kits.list_of(kit.flat(kit.exp(kits.normals(stream, i, r, 1))))
  end
  begun[kit] = out
  return out
end

-- a start that is a function of the points gives an element
local function start_of(self, start)
  local G, k, m = self.group, self.k, self.m
  if start == nil then return beginnings(G, self.r) end
  if type(start) ~= "function" then return start end
  start = core.one(start, "start")
  return function(z) return points.entries(G:flat(start(table.unpack(split(z, k, m))))) end
end

-- places of the flat coordinates that are angles
local function angles_of(G)
  local out = {}
  for i in pairs(kits.of(G).angles) do out[#out + 1] = i end
  return out
end

--- The element that a root y stands for.
function M.of_root(self, y)
  if self.chart then return partial.element(self, y) end
  return kits.of(self.group).unflat(kits.list_of(y))
end

-- the root y(z) of Z(g(y) z) = 0, bonds(y) = 0
local function solved(self, start)
  local G, k, m = self.group, self.k, self.m
  if self.chart then
    return partial.root(self, start, moved, section, branch_values, least)
  end
  local begin, bonds = start_of(self, start), kits.of(G).bonds
  local function at(y, z) return moved(self, M.of_root(self, y), split(z, k, m)) end
  return core.root {
    name = text.name(self), start = begin, failure = text.advice, angles = angles_of(G),
    equations = function(y, z)
      local out = section(self, at(y, z))
      for _, bond in ipairs(bonds(kits.list_of(y))) do out[#out + 1] = bond end
      return out
    end,
    branch = self.branch and function(y, z) return least(branch_values(self, at(y, z))) end or nil,
  }
end

local doc_new = [[
dm.moving_frame{action=, points=, cross_section=, branch=, solution=, start=, partial=, ...} -> rho
The right-equivariant moving frame rho(z1, ..., zk) of an action on k points (`points`, default 1;
or action:on_points(k), action:on_pairs(), a tangent or jet action with one): the group element g
with cross_section(g z1, ..., g zk) = 0, which gives as many numbers as the group has dimensions.
branch(z1, ..., zk) gives a number (or several) that must be > 0 on the section, where the equations
have more than one root. solution(z1, ..., zk) gives g by formula; without it g is solved for
(dm.root) from `start`: flat coordinates, or a function of the points that gives an element
(default: from the identity, turns about every axis and a few elements spread over the group). When
it is made the frame is tried at random points and under large elements of the group: it must be one
of the group, on the section and its branch, and equivariant, wherever it is finite; an error
has the point and the defect. A solution is trusted inside of runs; a root looks at branch and
transversality every time. partial = true: a frame up to isotropy, where the action is not free
(a discrete group, as half turns about the normal of a surface, is isotropy too): cross_section
gives as many numbers as the orbits have dimensions (a slice), rho is an element that brings the
points there, and rho(h z) is rho(z) h^-1 up to what leaves the section where it is;
invariants are as ever. invariants: names for entries, {name = {point, entry}}, which
dm.invariant_problem uses. Takes numbers and symbols, so what is made with it is differentiated
exactly. Methods: rho(z...), rho:invariants, phantom, invariantize, transversality, tangent,
correction, derivative_correction, syzygies, check.]]

-- is the root found in the flat coordinates of the group?
local function is_flat(self)
  local kit = kits.of(self.group)
  local y = kit.flat(kit.identity())
  return not self.basis and #y - #kit.bonds(y) == self.r
end

-- a frame from checked options, not tried yet
local function assembled(o)
  local action, k = base_of(o)
  local self = setmetatable({ action = action, group = action.group, k = k, points = k,
    m = action.dimension, r = action.group.dimension, cross_section = o.cross_section,
    branch = o.branch or false, solution = core.one(o.solution, "solution") or false,
    name = o.name, partial = o.partial or false, basis = false, discrete = false,
    invariants_named = o.invariants }, class)
  if o.partial then partial.prepare(self, section) end
  self.chart = not is_flat(self) and partial.chart(self)
  check_section(self)
  check_branch(self)
  if not self.solution then self.root = solved(self, o.start) end
  return self
end

--- A frame that is not tried: one that need hold only near the identity.
function M.near_identity(o) return assembled(o) end

M.moving_frame = blame.caller(function(o)
  check_options(o)
  options.demand(o.partial == nil or type(o.partial) == "boolean", o, "partial", NAME,
    "true or false")
  local self = assembled(o)
  tangent.check_orbits(self, trial.on_section)
  trial.check(self, section)
  return self
end)

---- the frame at points ----

-- the error for points that have no frame
local function no_frame(self, list, why)
  local fine, _, condition = blame.try(tangent.transversality, self, list)
  error(text.no_frame(self, list, fine and condition or math.huge, why), 0)
end

-- is g really the frame of the points? Numbers only
local function verify(self, g, list)
  local there = moved(self, g, list)
  local off, condition = tangent.distance(self, there, section(self, there))
  if not (condition < tangent.CONDITION) then no_frame(self, list) end
  if not (off <= tangent.allowed(condition)) then
    no_frame(self, list, "the solution is not on the cross-section")
  end
  for _, b in ipairs(branch_values(self, there)) do
    if not (b > 0) then no_frame(self, list, "the branch condition does not hold") end
  end
end

local function element(self, list)
  local k = self.k
  if points.symbolic(list) then
    if self.solution then return self.solution(table.unpack(list, 1, k)) end
    return M.of_root(self, self.root(flat({ table.unpack(list, 1, k) })))
  end
  local first = { table.unpack(list, 1, k) }
  local g
  if self.solution then
    g = groups.element(self.group, self.solution(table.unpack(first)))
  else
    local fine, y = blame.try(self.root, flat(first))
    if not fine then no_frame(self, first, tostring(y):gsub("^.-root of ", "")) end
    g = M.of_root(self, y)
  end
  verify(self, g, first)
  return g
end
M.element = element

class.__call = blame.caller(function(self, ...)
  return element(self, points_of(self, listed(self, ...), self.k))
end)

local doc_invariants = [[
rho:invariants{z1, ..., zn} -> {I1, ..., In}   or   rho:invariants(z1, ..., zn)
The points moved by the frame of the first k of them: I_j = rho(z1, ..., zk) . z_j, whose entries
are the fundamental invariants of the joint action (vectors; those the cross-section fixes are
constant, rho:phantom()).]]

local function invariants(self, list)
  local z = points_of(self, list, self.k)
  return core.result(moved(self, element(self, z), z))
end
M.invariants = invariants
method("invariants", function(self, ...) return invariants(self, listed(self, ...)) end,
  doc_invariants)

---- what has modules of its own ----

for name, module in pairs { check = "check", invariantize = "invariantize",
  transversality = "derivatives", tangent = "derivatives", correction = "derivatives",
  derivative_correction = "derivatives", syzygies = "derivatives", phantom = "derivatives" } do
  class_methods.later("dm.frame", name, "dm.frame." .. module)
end

core.docs[M.moving_frame] = doc_new

return M
