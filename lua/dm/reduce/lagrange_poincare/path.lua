--- What a run of reduced equations gives: rows x, p, mu and f, and the dm.path on Q behind it.
local core = require "dm.core"
local blame = require "dm.base.blame"
local kits = require "dm.group.kit"
local option = require "dm.base.options"
local space = require "dm.reduce.lagrange_poincare.space"

local M = {}

local class = core.class({ __name = "dm.reduced_path" }, [[
dm.reduced_path: a run of a reduced system, of solver:run{x=, p=, mu=} of dm.lagrange_poincare
fields: x, p, mu (a dm.vector a row: shape, its momentum, body momentum), f (f[k] leads from row k
to the next, f = g_k^-1 g_(k+1)), t, path (the dm.path on Q, for functions that take one), #run
rows; after reconstruct{g=} also g, elements. Other fields and methods are those of path.]])

-- rows made when they are asked for, then kept
local function rows(self, make)
  local out = {}
  for k = 1, #self do out[k] = make(k) end
  return core.result(out)
end

local made = {}
function made.x(self)
  local S, q = self.lp.space, self.path.q
  return rows(self, function(k) return (space.split(S, q[k])) end)
end
function made.p(self)
  local S, p = self.lp.space, self.path.p
  return rows(self, function(k) return (space.parts(S, p[k])) end)
end
function made.mu(self)
  local S, p = self.lp.space, self.path.p
  return rows(self, function(k) return select(2, space.parts(S, p[k])) end)
end
function made.f(self)
  local S, q, kit = self.lp.space, self.path.q, self.lp.space.kit
  local out, before = {}, nil
  for k = 1, #self do
    local _, g = space.split(S, q[k])
    if before then out[k - 1] = kit.compose(kit.inverse(before), g) end
    before = g
  end
  return core.result(out)
end

--- What is said of lp, or of a solver or run of it with the step h.
function M.text(lp, h)
  return ("reduced by %s%s, h = %g%s"):format(tostring(lp.group),
    lp.base and ", shapes in " .. tostring(lp.base) or "", h, lp.by and ", " .. lp.by or "")
end

--- The reduced path over a dm.path on Q. shown: does it have g?
function M.new(lp, path, shown)
  local self = setmetatable({ lp = lp, path = path }, class)
  if shown then
    rawset(self, "g", rows(self, function(k) return select(2, space.split(lp.space,
      path.q[k])) end))
  end
  return self
end

-- own fields, own methods, then those of the path
function class.__index(self, key)
  if made[key] then
    local value = made[key](self)
    rawset(self, key, value)
    return value
  end
  local own = class.methods[key]
  if own then return own end
  local value = rawget(self, "path")[key]
  if type(value) ~= "function" then return value end
  return function(_, ...) return value(self.path, ...) end
end

function class.__len(self) return #self.path end
function class.__tostring(self)
  return ("reduced path of %d rows: %s"):format(#self.path, M.text(self.lp, self.path.h))
end

function M.is(x) return type(x) == "table" and getmetatable(x) == class end

-- the same path, moved by an element of the group from the left
local function moved(self, h)
  local lp, path, system = self.lp, self.path, self.lp.system
  local P, S = system.place, lp.space
  local N, D = P.size, P.dimension
  local move = P.flat(space.element(S, core.zeros(S.d), h))
  local columns, q = { path:column "t" }, {}
  for i = 1, N do q[i], columns[1 + i] = path:column("q" .. i), {} end
  for k = 1, #path do
    local here = {}
    for i = 1, N do here[i] = q[i][k] end
    for i, x in ipairs(kits.list_of(P.carry(move, here))) do columns[1 + i][k] = x end
  end
  for i = 1, N do columns[1 + i] = core.vector(columns[1 + i]) end
  for i = 1, D do columns[1 + N + i] = path:column("p" .. i) end
  return core.path { system = system, h = path.h, rule = path.rule, steps = path.steps,
    columns = columns }
end

local function method(name, f, doc) core.method("dm.reduced_path", name, blame.caller(f), doc) end

method("reconstruct", function(self, o)
  local where = "path:reconstruct"
  o = option.check(o or {}, { "g" }, where, "{ g = g0 }")
  local lp = self.lp
  local kit = lp.space.kit
  local g0 = kit.identity()
  if o.g ~= nil then g0 = require "dm.group".element(lp.group, o.g) end
  local _, first = space.split(lp.space, self.path.q[1])
  return M.new(lp, moved(self, kit.compose(g0, kit.inverse(first))), true)
end, [[
path:reconstruct{g=} -> dm.reduced_path
The run on Q over a reduced one that begins at the element g (default: the identity), g_(k+1) = g_k
f_k: the same rows, with elements .g and a dm.path .path on Q.]])

method("phases", function(self) return require "dm.reduce.run.phases".of_path(self.path) end, [[
path:phases() -> {total, dynamic, geometric}
Of a run on SO(3): how far the body has turned about its spatial momentum J, a dm.vector of a number
a row, not wrapped: see path:phases of dm.path.]])

return M
