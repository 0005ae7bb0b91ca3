--- Derivatives by several variables: multi-indices K = { k1, ..., kp }, by total order, and of one
-- order as in u_xx, u_xt, u_tt.
local M = {}

-- all K of p entries with sum n, those with more of the first variable first
local function of_order(p, n, head, out)
  if p == 1 then
    local K = { table.unpack(head) }
    K[#K + 1] = n
    out[#out + 1] = K
    return out
  end
  for first = n, 0, -1 do
    local longer = { table.unpack(head) }
    longer[#longer + 1] = first
    of_order(p - 1, n - first, longer, out)
  end
  return out
end

function M.key(K) return table.concat(K, ",") end

--- The multi-indices of p variables up to an order: list, place[key(K)], order[i] of each,
-- next[i][k] the place of K + e_k (nothing beyond the order), first[n] where order n begins,
-- from[i] = { k, place of K - e_k } with the first k that can be.
function M.up_to(p, order)
  local out = { list = {}, place = {}, order = {}, next = {}, first = {}, from = {}, p = p }
  for n = 0, order do
    out.first[n] = #out.list + 1
    for _, K in ipairs(of_order(p, n, {}, {})) do
      local i = #out.list + 1
      out.list[i], out.place[M.key(K)], out.order[i] = K, i, n
    end
  end
  for i, K in ipairs(out.list) do
    out.next[i] = {}
    for k = 1, p do
      local longer = { table.unpack(K) }
      longer[k] = longer[k] + 1
      local at = out.place[M.key(longer)]
      out.next[i][k] = at
      if at and not (out.from[at] and out.from[at][1] < k) then out.from[at] = { k, i } end
    end
  end
  return out
end

--- How many there are of p variables of order up to n: (n + p)!/(n! p!).
function M.count(p, n)
  local c = 1
  for k = 1, p do c = c * (n + k) // k end
  return c
end

return M
