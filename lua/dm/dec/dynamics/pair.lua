--- dm.pair: the pair groupoid of a set of points (Leok 3.13), in which motions take steps: a pair
-- (a, b) goes from its source a to its target b, and composable pairs are discrete curves.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local Pair = core.class({ __name = "dm.pair" }, [[
dm.pair: an element (a, b) of the pair groupoid, made by dm.pair(a, b)
fields: source, target; g * h = (a, c) for g = (a, b) and h = (b, c), g == h]])

local Tuple = core.class({ __name = "dm.pair_tuple" }, [[
dm.pair_tuple: composable pairs, a discrete curve of p + 1 points, made by dm.pair(q0, ..., qp)
fields: points; tuple[i] is pair i, #tuple = p]])

local WHERE = "dm.pair"
local fail = option.failing(WHERE)

---- points ----

local function same_list(a, b, same)
  if #a ~= #b then return false end
  for i = 1, #a do
    if not same(a[i], b[i]) then return false end
  end
  return true
end

local function is_plain(x) return type(x) == "table" and not getmetatable(x) end

-- every entry of a is one of b, and b has no other
local function same_table(a, b, same)
  for key, x in pairs(a) do
    if b[key] == nil or not same(x, b[key]) then return false end
  end
  for key in pairs(b) do
    if a[key] == nil then return false end
  end
  return true
end

--- Are two points one? Numbers, texts and objects by ==, tables and vectors entry by entry.
local function same(a, b)
  if rawequal(a, b) or a == b then return true end
  if is_plain(a) and is_plain(b) then return same_table(a, b, same) end
  local vectors = option.got(a) == "dm.vector" or option.got(b) == "dm.vector"
  return (vectors and lists.count(a) and lists.count(b) and same_list(a, b, same)) or false
end
M.same = same

local function has_nan(x)
  if x ~= x then return true end
  if is_plain(x) then
    for _, entry in pairs(x) do
      if has_nan(entry) then return true end
    end
  elseif option.got(x) == "dm.vector" then
    for i = 1, #x do
      if x[i] ~= x[i] then return true end
    end
  end
  return false
end

-- NaN is no point: it would not even be its own identity
local function check_point(x, number)
  if x == nil then
    fail("point %d is missing: dm.pair(a, b) takes a source and a target", number)
  end
  if has_nan(x) then fail("point %d %s NaN", number, x ~= x and "is" or "has an entry that is") end
  return x
end

-- a list as {1, 2}, names behind it
local function text(x)
  if not is_plain(x) then return tostring(x) end
  local out, names = {}, {}
  for i = 1, #x do out[i] = text(x[i]) end
  for key in pairs(x) do
    if not (math.type(key) == "integer" and out[key]) then names[#names + 1] = key end
  end
  table.sort(names, function(a, b) return tostring(a) < tostring(b) end)
  for _, key in ipairs(names) do out[#out + 1] = tostring(key) .. " = " .. text(x[key]) end
  return "{" .. table.concat(out, ", ") .. "}"
end

---- pairs ----

local function new(a, b) return setmetatable({ source = a, target = b }, Pair) end

local function tuple(points) return setmetatable({ points = points }, Tuple) end

M.pair = blame.caller(function(...)
  local points, count = { ... }, select("#", ...)
  for i = 1, math.max(2, count) do check_point(points[i], i) end
  if count > 2 then return tuple(points) end
  return new(points[1], points[2])
end)

core.docs[M.pair] = [[
dm.pair(a, b) -> dm.pair   or   dm.pair(q0, q1, ..., qp) -> dm.pair_tuple
The element (a, b) of the pair groupoid, from its source a to its target b: numbers, lists, vectors
or objects. g * h of (a, b) and (b, c) is (a, c), and raises where the target of g is not the source
of h; g:inverse() is (b, a); (a, a) are the identities. More points: the p composable pairs of a
discrete curve (Leok 3.13).]]

local function is_pair(x) return getmetatable(x) == Pair end

local function check_joint(g, h, where)
  if not same(g.target, h.source) then
    option.fail(where, "the pairs cannot be composed: the target %s of the first is not the source "
      .. "%s of the second", text(g.target), text(h.source))
  end
end

function Pair.__mul(g, h)
  if not (is_pair(g) and is_pair(h)) then
    option.fail("pair * pair", "two pairs are needed (got %s)", option.got(is_pair(g) and h or g))
  end
  check_joint(g, h, "pair * pair")
  return new(g.source, h.target)
end

function Pair.__eq(g, h)
  return is_pair(g) and is_pair(h) and same(g.source, h.source) and same(g.target, h.target)
end

function Pair.__tostring(g) return ("(%s, %s)"):format(text(g.source), text(g.target)) end

class.method("dm.pair", "inverse", function(g) return new(g.target, g.source) end,
  "g:inverse() -> dm.pair\n(b, a) of (a, b): g * g:inverse() is the identity (a, a).")

class.method("dm.pair", "is_identity", function(g) return same(g.source, g.target) end,
  "g:is_identity() -> boolean\nIs it (a, a)?")

class.method("dm.pair", "join", function(g, ...)
  local points = { g.source, g.target }
  for i, h in ipairs { ... } do
    if not is_pair(h) then
      option.fail("pair:join", "argument %d must be a pair (got %s)", i, option.got(h))
    end
    check_joint(new(points[#points - 1], points[#points]), h, "pair:join")
    points[#points + 1] = h.target
  end
  return tuple(points)
end, [[
g:join(h, ...) -> dm.pair_tuple
The tuple of composable pairs g, h, ...: raises where a target is not the next source.]])

---- tuples ----

function Tuple.__len(t) return #t.points - 1 end

local index = Tuple.__index
function Tuple.__index(t, key)
  if math.type(key) == "integer" then
    local points = rawget(t, "points")
    return key >= 1 and points[key + 1] ~= nil and new(points[key], points[key + 1]) or nil
  end
  return index(t, key)
end

function Tuple.__eq(s, t)
  return getmetatable(s) == Tuple and getmetatable(t) == Tuple
    and same_list(s.points, t.points, same)
end

function Tuple.__tostring(t)
  local out = {}
  for i, x in ipairs(t.points) do out[i] = text(x) end
  return ("%d pairs: %s"):format(#t, table.concat(out, " -> "))
end

class.method("dm.pair_tuple", "product", function(t)
  return new(t.points[1], t.points[#t.points])
end, "t:product() -> dm.pair\nThe product of all of its pairs: from the first point to the last.")

class.method("dm.pair_tuple", "inverse", function(t)
  local out, count = {}, #t.points
  for i, x in ipairs(t.points) do out[count + 1 - i] = x end
  return tuple(out)
end, "t:inverse() -> dm.pair_tuple\nThe curve back: the inverses in the other order.")

return M
