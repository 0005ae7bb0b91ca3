--- What acts beside Ld: discrete forces F1, F2 (Leok 2.8.2), rolling constraints phi(q0, q1) and
-- the rows E of their reactions (Cuell-Patrick 3). They are reduced where the group moves them as
-- it moves the points and each is zero along the group, F1 . xi_Q(q0) = F2 . xi_Q(q1) = E_c .
-- xi_Q(q0) = 0: then mu is kept, and psi_mu solves what it solved without them (Leok 2.8.2-2.8.3).
local blame = require "dm.base.blame"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"
local places = require "dm.reduce.discrete.places"

local M = {}

local abs, max = math.abs, math.max

---- as functions of numbers or symbols ----

-- all scalars of nested lists, in their order, behind those of out
local function flatten(out, value)
  if not lists.count(value) then
    out[#out + 1] = value
  else
    for i = 1, #value do flatten(out, value[i]) end
  end
  return out
end

-- f(q0, q1 [, h]) with params of Ld, and its h, bound: a list of all its entries
local function bound_list(Ld, f)
  local own, given = Ld.h, Ld.params
  return function(q0, q1, h) return flatten({}, { f(q0, q1, h or own, given) }) end
end

-- how many entries f has, as the trace of it tells
local function count_of(f, n)
  local count
  core.trace(function(q0, q1)
    local out = f(q0, q1)
    count = #out
    return core.vector(out)
  end, n, n)
  return count
end

--- { rolls = entries of phi, push(q0, q1 [, h]) -> F1, F2, rolling(q0, q1) -> list,
-- reaction(q0, q1) -> rows E }; what Ld has not is nil, and so is all of it where it has nothing.
function M.of(Ld)
  local n = Ld.Q.dimension
  if not Ld.force and not Ld.rolling then return nil end
  local out = { rolls = 0 }
  if Ld.force then
    local force = bound_list(Ld, Ld.force)
    function out.push(q0, q1, h)
      local F = force(q0, q1, h)
      return lists.part(F, 0, n), lists.part(F, n, n)
    end
  end
  if Ld.rolling then
    out.rolling = bound_list(Ld, Ld.rolling)
    out.rolls = count_of(out.rolling, n)
    local reaction = bound_list(Ld, Ld.reaction)
    function out.reaction(q0, q1)
      local E, rows = reaction(q0, q1), {}
      for c = 1, out.rolls do rows[c] = lists.part(E, (c - 1) * n, n) end
      return rows
    end
  end
  return out
end

---- over shapes ----

--- The entries of a covector in (theta, x) that belong to the shape.
function M.of_shape(info, J, F) return core.vector((model.split(info, places.pulled(J, F)))) end

---- is all of it invariant, and nothing along the group? ----

local NONE, SAME = 1e-9, 1e-8 -- of the largest entry, each times its coordinate
local ROUND = check.ROUND / SAME

-- everything at two points: a list of { name, covector or nil, value }
local function seen(D, at, q0, q1)
  local out = {}
  if D.forces.push then
    local F1, F2 = D.forces.push(q0, q1)
    local words = "it pushes"
    out[1] = { "the discrete force F1", places.pulled(at.J0, F1), words, round = ROUND }
    out[2] = { "the discrete force F2", places.pulled(at.J1, F2), words, round = ROUND }
  end
  if D.forces.rolling then
    for c, E in ipairs(D.forces.reaction(q0, q1)) do
      local name = "row " .. c .. " of 'reaction'"
      out[#out + 1] = { name, places.pulled(at.J0, E), "it pulls", round = 0 }
    end
    out[#out + 1] = { "'rolling'", value = core.vector(D.forces.rolling(q0, q1)) }
  end
  return out
end

-- what round-off of the points makes of entry i of item k
local function noise(D, at, k, i)
  return places.noise(at, function(q0, q1)
    local item = seen(D, at, q0, q1)[k]
    return (item[2] or item.value)[i]
  end)
end

local ALONG = "%s of this Ld has a component along the group: %s '%s' with %.6g, for x0 = %s, x1 = "
  .. "%s, so the momentum of '%s' is not kept and cannot be eliminated"
local MOVED = "%s of this Ld is not invariant: entry %d changes from %.6g to %.6g when the group "
  .. "moves q0 and q1 by %.6g, for x0 = %s, x1 = %s"

-- what entry i of an item is multiplied with, so that entries of all units compare: coordinates
local function weights(info, item, look)
  local out = {}
  if item.value then return nil end
  for j, i in ipairs(info.shape) do out[i] = max(abs(look.x0[j]), abs(look.x1[j])) end
  for _, i in ipairs(info.cyclic) do out[i] = 1 end
  return out
end

-- the size of entry i: of its covector, or its own; a force is nothing beside what is round-off of
-- the action of L
local function size_of(item, w, i, look)
  if not w then return abs(item.value[i]) end
  local size = item.round * look.action
  for k = 1, #item[2] do size = max(size, abs(item[2][k]) * w[k]) end
  return size
end

-- sizes[k][i] of entry i of item k at the middle one of all looks: what rests here moves there
local function usual_sizes(info, seen_at)
  local out, first = {}, seen_at[1].lists[1]
  for k, item in ipairs(first) do
    out[k] = {}
    for i = 1, #(item[2] or item.value) do
      local all = {}
      for l, one in ipairs(seen_at) do
        all[l] = size_of(one.lists[1][k], weights(info, item, one.look), i,
          one.look)
      end
      out[k][i] = lists.middle(all)
    end
  end
  return out
end

local function check_along(D, at, k, item, w, usual, look)
  local F, info = item[2], D.info
  for _, i in ipairs(F and info.cyclic or {}) do
    if abs(F[i]) > NONE * max(size_of(item, w, i, look), usual[i])
      and abs(F[i]) > noise(D, at, k, i) then
      error(ALONG:format(item[1], item[3], info.names[i], F[i], check.text(look.x0),
        check.text(look.x1), info.names[i]), 0)
    end
  end
end

local function check_same(D, at, k, item, before, w, usual, look, theta)
  local now, was = item[2] or item.value, before[2] or before.value
  for i = 1, #now do
    local apart, size = abs(now[i] - was[i]) * (w and w[i] or 1), size_of(before, w, i, look)
    if apart > SAME * max(size, usual[i])
      and abs(now[i] - was[i]) > noise(D, at, k, i) then
      error(MOVED:format(item[1], i, was[i], now[i], theta[1], check.text(look.x0),
        check.text(look.x1)), 0)
    end
  end
end

-- are all of them numbers here?
local function is_finite(list)
  for _, item in ipairs(list) do
    local x = item[2] or item.value
    for i = 1, #x do if not (abs(x[i]) < math.huge) then return false end end
  end
  return true
end

--- Raises at one of `looks`, pairs of shapes x0, x1, psi apart, where something is along the group
-- or depends on where the group is: at the first of the look's places and at the others.
function M.check(D, looks)
  local seen_at = {}
  for _, look in ipairs(looks) do
    local one = { look = look, lists = {}, places = {}, at = {} }
    for _, theta in ipairs(look.places) do
      local fine, at, list = blame.try(function()
        local at = places.of(D, look, theta)
        return at, seen(D, at, at.q0, at.q1)
      end)
      if fine and is_finite(list) then
        local l = #one.lists + 1
        one.lists[l], one.places[l], one.at[l] = list, theta, at
      end
    end
    if #one.lists > 0 then seen_at[#seen_at + 1] = one end
  end
  local usual = #seen_at > 0 and usual_sizes(D.info, seen_at)
  for _, one in ipairs(seen_at) do
    for l, list in ipairs(one.lists) do
      for k, item in ipairs(list) do
        local w = weights(D.info, item, one.look)
        check_along(D, one.at[l], k, item, w, usual[k], one.look)
        if l > 1 then
          check_same(D, one.at[l], k, item, one.lists[1][k], w, usual[k], one.look, one.places[l])
        end
      end
    end
  end
end

return M
