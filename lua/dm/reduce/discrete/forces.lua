--- What acts beside Ld: discrete forces F1, F2 (Leok 2.8.2), rolling constraints phi(q0, q1) and
-- the rows E of their reactions (Cuell-Patrick 3). They are reduced where the group moves them as
-- it moves the points and each is zero along the group, F1 . xi_Q(q0) = F2 . xi_Q(q1) = E_c .
-- xi_Q(q0) = 0: then mu is kept, and psi_mu solves what it solved without them (Leok 2.8.2-2.8.3).
local blame = require "dm.base.blame"
local check = require "dm.reduce.routh.check"
local core = require "dm.core"
local lists = require "dm.base.lists"
local model = require "dm.reduce.routh.model"

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

-- J^T F: a covector in the coordinates (theta, x)
local function pulled(info, J, F)
  if not J then return F end
  local out = {}
  for k = 1, info.n do
    out[k] = 0
    for i = 1, info.n do out[k] = out[k] + J[i][k] * F[i] end
  end
  return core.vector(out)
end

--- The entries of a covector in (theta, x) that belong to the shape.
function M.of_shape(info, J, F) return core.vector((model.split(info, pulled(info, J, F)))) end

---- is all of it invariant, and nothing along the group? ----

-- everything at ((theta, x0), (theta + psi, x1)): a list of { name, covector or nil, value }
local function seen(D, x0, x1, theta, psi)
  local info, there, out = D.info, {}, {}
  for a = 1, info.m do there[a] = theta[a] + psi[a] end
  local z0, z1, A = model.embed(info, x0, theta), model.embed(info, x1, there), info.ambient
  local q0, q1 = A and A.chart(z0) or z0, A and A.chart(z1) or z1
  local J0, J1 = A and A.slope(z0), A and A.slope(z1)
  if D.forces.push then
    local F1, F2 = D.forces.push(q0, q1)
    out[1] = { "the discrete force F1", pulled(info, J0, F1), "it pushes" }
    out[2] = { "the discrete force F2", pulled(info, J1, F2), "it pushes" }
  end
  if D.forces.rolling then
    for c, E in ipairs(D.forces.reaction(q0, q1)) do
      out[#out + 1] = { "row " .. c .. " of 'reaction'", pulled(info, J0, E), "it pulls" }
    end
    out[#out + 1] = { "'rolling'", value = core.vector(D.forces.rolling(q0, q1)) }
  end
  return out
end

local NONE, SAME = 1e-9, 1e-8 -- of the largest entry

local ALONG = "%s of this Ld has a component along the group: %s '%s' with %.6g, for x0 = %s, x1 = "
  .. "%s, so the momentum of '%s' is not kept and cannot be eliminated"
local MOVED = "%s of this Ld is not invariant: entry %d changes from %.6g to %.6g when the group "
  .. "moves q0 and q1 by %.6g, for x0 = %s, x1 = %s"

-- the largest entry of a list, 1 at least
local function size_of(x)
  local size = 1
  for i = 1, #x do size = max(size, abs(x[i])) end
  return size
end

local function check_along(info, item, x0, x1)
  local F = item[2]
  for _, i in ipairs(F and info.cyclic or {}) do
    if abs(F[i]) > NONE * size_of(F) then
      error(ALONG:format(item[1], item[3], info.names[i], F[i], check.text(x0), check.text(x1),
        info.names[i]), 0)
    end
  end
end

local function check_same(item, before, x0, x1, theta)
  local now, was = item[2] or item.value, before[2] or before.value
  for i = 1, #now do
    if abs(now[i] - was[i]) > SAME * size_of(was) then
      error(MOVED:format(item[1], i, was[i], now[i], theta[1], check.text(x0), check.text(x1)), 0)
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

--- Raises at a pair of shapes, psi apart, where something is along the group or depends on where
-- the group is: at the first of these places and at the others.
function M.check(D, x0, x1, psi, places)
  local first
  for _, theta in ipairs(places) do
    local fine, list = blame.try(seen, D, x0, x1, theta, psi)
    if fine and is_finite(list) then
      for k, item in ipairs(list) do
        check_along(D.info, item, x0, x1)
        if first then check_same(item, first[k], x0, x1, theta) end
      end
      first = first or list
    end
  end
end

return M
