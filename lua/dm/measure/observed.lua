--- What is looked at on a group under a name: entries of the element, momenta, flat coordinates.
local place = require "dm.group.place"

local M = {}

--- The function (g, xi, t, mu) of that name, or nothing: "R31" or "R31_k" for an entry of the
-- element (of factor k of a product), "p1" or "mu1" for a momentum, "q1" for a flat coordinate that
-- does not jump.
function M.of(own, name)
  local kind, digits = tostring(name):match "^(%a+)(%d+)$"
  local i = math.tointeger(tonumber(digits))
  if (kind == "p" or kind == "mu") and i >= 1 and i <= own.dimension then
    return function(_, _, _, mu) return mu[i] end
  end
  if kind == "q" and not own.jumps and i >= 1 and i <= own.size then
    return function(g) return own.flat(g)[i] end
  end
  local entry = place.entry(own, name)
  return entry and function(g) return entry(g) end
end

local function numbered(letter, n)
  local out = {}
  for i = 1, n do out[i] = letter .. i end
  return out
end

--- Names that tell the state of a system without a choice of sign: entries of the element, or flat
-- coordinates where it has no matrix; of a reduced system its momenta.
function M.names(own)
  local out, parts = {}, own.kit.parts
  if own.reduced then return numbered("p", own.dimension) end
  for k, part in ipairs(parts or { own.kit }) do
    local m = part.matrix and part.matrix(part.identity())
    if not m then return numbered("q", own.size) end
    for i = 1, m.rows do
      for j = 1, m.columns do out[#out + 1] = ("R%d%d%s"):format(i, j, parts and "_" .. k or "") end
    end
  end
  return out
end

return M
