--- Components of a mesh on which nothing is held: there a solution is known up to a constant, and
-- is there only for a load without mean. Items are vertices, or cells of the highest degree.
local M = {}

--- Lists of the items of such components, in the order of their first items. count: how many items
-- there are; vertex_of(i): a vertex of item i; is_held(i).
function M.lists(K, count, vertex_of, is_held)
  local component, held, out, at = K:component_of(), {}, {}, {}
  for i = 1, count do
    if is_held(i) then held[component[vertex_of(i)]] = true end
  end
  for i = 1, count do
    local c = component[vertex_of(i)]
    if not held[c] then
      if not at[c] then
        at[c] = {}
        out[#out + 1] = at[c]
      end
      table.insert(at[c], i)
    end
  end
  return out
end

return M
