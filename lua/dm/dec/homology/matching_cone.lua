--- The cone of a Morse complex: p = h + g P f in integers, and its transpose over the rationals.
local chain = require "dm.dec.chain"
local integers = require "dm.dec.homology.integers"

local M = {}

-- terms and all of `more`
local function add_all(terms, more)
  for cell, x in pairs(more) do chain.add(terms, cell, x) end
  return terms
end

local function transposed_times(P, x)
  local out = {}
  for j = 1, P.columns do
    out[j] = 0
    for i = 1, P.rows do out[j] = out[j] + P[i][j] * x[i] end
  end
  return out
end

--- p = h + g P f and its transpose, of a Morse complex.
function M.engine(m)
  local engine = {}
  function engine.chain(k, terms)
    local left, along = m:reduce(k, terms)
    if k == m.mesh.dimension then return {} end
    return add_all(along, m:extend(k + 1, integers.apply(m:contraction(k), left)))
  end
  function engine.project(k, terms)
    return m:extend(k, integers.apply(m:projection(k), (m:reduce(k, terms))))
  end
  -- over the rationals: forms see no torsion
  function engine.cocone(k, alpha)
    local at = m.matching:gather(k + 1, alpha)
    return m.matching:cocone(k, alpha, transposed_times(m:contraction(k, true), at))
  end
  return engine
end

return M
