-- random numbers that are the same everywhere, and forms of them
local M = {}

--- random(): a number from -1/2 to 1/2
function M.random(seed)
  return function()
    seed = (seed * 1103515245 + 12345) % 2 ^ 31
    return seed / 2 ^ 31 - 0.5
  end
end

--- cochain(K, k [, dual]): a form whose values these numbers are
function M.of(random)
  return function(K, k, dual)
    local x = {}
    for i = 1, K:count(dual and K.dimension - k or k) do x[i] = random() end
    return K:form(k, x, { dual = dual })
  end
end

return M
