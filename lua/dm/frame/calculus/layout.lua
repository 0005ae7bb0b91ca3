--- Where the derivatives stand in a jet, as action:jet orders them: the point, then for each order
-- and multi-index the dependent entries. C has n, p, q, independent and dependent (lists of entries
-- of the point) and words, the multi-indices.
local multi_index = require "dm.action.multi_index"

local M = {}

local HIGHEST = { 60, 16, 9, 7 } -- order of derivatives, by p

--- The fields of a calculus that tell where entries are; independent: a list, or nothing for
-- curves with a parameter that the group leaves alone.
function M.of(action, independent)
  local C = { n = action.dimension, independent = independent or {}, dependent = {} }
  local is_independent = {}
  for _, i in ipairs(C.independent) do is_independent[i] = true end
  for i = 1, C.n do
    if not is_independent[i] then C.dependent[#C.dependent + 1] = i end
  end
  C.p, C.q = independent and #independent or 1, #C.dependent
  C.words = multi_index.up_to(C.p, HIGHEST[math.min(C.p, #HIGHEST)])
  return C
end

--- Numbers of a jet of that order.
function M.length(C, order) return C.n + (multi_index.count(C.p, order) - 1) * C.q end

--- The entry of the derivative K (its place) of the dependent entry number c.
function M.entry(C, c, place)
  return place == 1 and C.dependent[c] or C.n + (place - 2) * C.q + c
end

--- What entry k is: { independent = i } or { component =, place = }.
function M.at(C, k)
  if k > C.n then
    return { component = (k - C.n - 1) % C.q + 1, place = (k - C.n - 1) // C.q + 2 }
  end
  for i, entry in ipairs(C.independent) do
    if entry == k then return { independent = i } end
  end
  for c, entry in ipairs(C.dependent) do
    if entry == k then return { component = c, place = 1 } end
  end
end

--- The order of the derivative at entry k.
function M.order(C, k)
  local at = M.at(C, k)
  return at.independent and 0 or C.words.order[at.place]
end

--- The entry of the derivative of entry k by variable i.
function M.derivative(C, k, i)
  local at = M.at(C, k)
  return M.entry(C, at.component, C.words.next[at.place][i])
end

--- D_i as it is written.
function M.derivation(C, i) return C.p == 1 and "D" or "D_" .. i end

local LETTERS = { "x", "y", "z" }

--- What entry k is called: u_xx; x, y, z, t are independent ones, u, v, w dependent ones.
function M.name(C, k)
  local at = M.at(C, k)
  local clock = #C.independent == 2 and { "x", "t" } or LETTERS
  if at.independent then return clock[at.independent] or "x" .. at.independent end
  local out = ({ "u", "v", "w" })[at.component] or "u" .. at.component
  local K, letters = C.words.list[at.place], {}
  for i = 1, C.p do letters[i] = (clock[i] or "x" .. i):rep(K[i]) end
  local marks = table.concat(letters)
  return marks == "" and out or out .. "_" .. marks
end

return M
