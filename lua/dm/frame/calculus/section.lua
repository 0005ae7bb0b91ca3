--- The cross-section as exact equations of a jet, solved for as many of its entries.
local blame = require "dm.base.blame"
local core = require "dm.core"
local kits = require "dm.group.kit"
local F = require "dm.frame.calculus.field"
local layout = require "dm.frame.calculus.layout"
local normal = require "dm.frame.calculus.normal"
local option = require "dm.base.options"
local points = require "dm.frame.points"
local read = require "dm.frame.calculus.read"

local M = {}

local WHERE = "dm.differential_invariants"
local HIGHEST = 8  -- order of the jets that a section may ask for

-- what the section gives at a jet of numbers: a list, or nothing and why
local function try(section, length)
  local z = kits.normals(core.random(21), length, length, 1):map(function(x) return 1.5 + x end)
  local fine, value = blame.try(function() return points.entries(section(z)) end)
  if not fine then return nil, value end
  for i = 1, #value do
    if type(value[i]) ~= "number" then return nil, "its entries must be numbers" end
  end
  return value
end

-- the least order of jets that the section can be called with, and how many numbers it gives
local function order_of(C, section)
  local most, why, at = 0, nil, nil
  for order = 0, HIGHEST do
    local value, message = try(section, layout.length(C, order))
    if value and #value >= C.r then return order end
    if value and #value >= most then most, at = #value, order end
    why = message or why
  end
  if not at or most == 0 then
    option.fail(WHERE, "the cross-section fails: %s", tostring(why or "it gives nothing"))
  end
  option.fail(WHERE, "the cross-section has %d equation%s, but the group has %d dimensions: it "
    .. "must "
    .. "return as many numbers", most, most == 1 and "" or "s", C.r)
end

-- the entries that the equations depend on
local function entries_of(f, length)
  local used, out = f:depends()[1], {}
  for k = 1, length do
    if used[k] then out[#out + 1] = k end
  end
  return out
end

---- solving ----

-- rational roots of a polynomial in one variable, coefficients from 0
local function rational_roots(c)
  local out, n = {}, #c
  local function is_root(x)
    local sum, size = 0, 0
    for i = n, 1, -1 do sum, size = sum * x + c[i], size * math.abs(x) + math.abs(c[i]) end
    return math.abs(sum) <= 1e-13 * size
  end
  local top, bottom = math.abs(c[1]), math.abs(c[n])
  if top == 0 then out[1] = 0 end
  for p = 1, math.min(top, 1000) do
    for q = 1, math.min(bottom, 1000) do
      for s = -1, 1, 2 do
        local x = s * p / q
        if top % p == 0 and bottom % q == 0 and is_root(x) then out[#out + 1] = x end
      end
    end
  end
  return out
end

-- the values of variable v that solve the equation e = 0, where only v is in it
local function roots_of(e, v)
  local c, rest = {}, e
  for i = 1, 9 do
    local value = F.map(rest, function() return 0 end) / (i > 1 and 1 or 1)
    c[i] = value
    rest = F.partial(rest, v)
    if rest:is_zero() then break end
    if i == 9 then return {} end
  end
  local scale, factorial = 1, 1
  for i = 2, #c do
    factorial = factorial * (i - 1)
    c[i] = c[i] / factorial
  end
  for d = 1, 1000 do
    local whole = true
    for i = 1, #c do whole = whole and math.abs(c[i] * d - math.floor(c[i] * d + 0.5)) < 1e-12 end
    if whole then
      scale = d
      break
    end
  end
  for i = 1, #c do c[i] = math.floor(c[i] * scale + 0.5) end
  return rational_roots(c)
end

-- entry and value where e = 0 is linear in an entry with a constant factor
local function linear_in(C, e)
  local uses, best = e:uses(), nil
  for v, info in pairs(uses) do
    local slope = F.partial(e, v)
    if slope:constant() and info.entry and (not best or info.entry > best[1]) then
      best = { info.entry, normal.unknown(C, info.entry) - e / slope }
    end
  end
  return best
end

-- entry and its possible values where e = 0 is in one entry alone
local function alone_in(e)
  local v, info = next(e:uses())
  if not v or next(e:uses(), v) or not info.entry or next(e.den) then return nil end
  local roots = roots_of(e, v)
  return #roots > 0 and { info.entry, roots } or nil
end

-- of several values the one where the branch holds
local function choose(C, entry, roots, branch, values)
  if #roots == 1 then return roots[1] end
  local kept = {}
  for _, x in ipairs(roots) do
    local z = core.vector(core.zeros(layout.length(C, C.section.order))):map(function(_, k)
      local known = values[k]
      return k == entry and x or known and known:constant() or 1
    end)
    local fine, b = blame.try(function() return points.entries(branch(z)) end)
    local holds = fine
    for i = 1, fine and #b or 0 do holds = holds and b[i] > 0 end
    if holds then kept[#kept + 1] = x end
  end
  if #kept ~= 1 then
    option.fail(WHERE, "the cross-section leaves %s at %s: say which by branch = function(z) ... "
      .. "end, > 0 there", layout.name(C, entry), table.concat(roots, " or "))
  end
  return kept[1]
end

-- solve the equations one by one for entries of the jet: value[k]
local function solved(C, equations, branch)
  local value, left = {}, { table.unpack(equations) }
  local function put(e)
    return F.map(e, function(_, info) return value[info.entry] or normal.unknown(C, info.entry) end)
  end
  while #left > 0 do
    local found
    for i, equation in ipairs(left) do
      local e = put(equation)
      if not F.is(e) or e:constant() then
        option.fail(WHERE, "the equations of the cross-section depend on each other")
      end
      local linear, alone = linear_in(C, e), nil
      if not linear then alone = alone_in(e) end
      if linear and (not found or not found.alone and linear[2]:constant()) then
        found = { i, linear[1], linear[2] }
        if linear[2]:constant() then break end
      elseif alone and not found then
        found = { i, alone[1], F.number(C.field, choose(C, alone[1], alone[2],
          branch or function() return 0 end, value)) }
      end
    end
    if not found then
      option.fail(WHERE, "the cross-section cannot be solved exactly: its equations must be "
        .. "linear in "
        .. "an entry of the jet, such as z[3] or z[4] - 1 (left: %s = 0)", tostring(put(left[1])))
    end
    table.remove(left, found[1])
    for k, e in pairs(value) do
      value[k] = F.map(e, function(_, info)
        return info.entry == found[2] and found[3] or normal.unknown(C, info.entry)
      end)
      if not F.is(value[k]) then value[k] = F.number(C.field, value[k]) end
    end
    value[found[2]] = found[3]
  end
  return value
end

--- Read and solve: C.section = { order, entries, equations, variable, value }.
function M.read(C, section, branch)
  local order = order_of(C, section)
  local length = layout.length(C, order)
  local f = core.trace(function(z) return points.entries(section(z)) end, length)
  local z, variable = {}, {}
  local S = { order = order, entries = entries_of(f, length), variable = variable }
  C.section = S
  for k = 1, length do z[k] = normal.unknown(C, k) end
  for v, info in pairs(C.field.variables) do
    if info.entry then variable[info.entry] = v end
  end
  S.equations = read.of(f, C.r)(z, F.apply)
  for i, e in ipairs(S.equations) do
    if not F.is(e) then
      option.fail(WHERE, "equation %d of the cross-section does not depend on the jet", i)
    end
  end
  S.value = solved(C, S.equations, branch)
  local used = 0
  for _, k in ipairs(S.entries) do used = math.max(used, layout.order(C, k)) end
  S.order = used
end

return M
