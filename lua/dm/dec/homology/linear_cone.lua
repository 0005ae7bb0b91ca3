--- The cone by pseudo-inverses: p_k = d_(k+1)^+ (1 - p_(k-1) d_k), in degree 0 after the projection
-- on the hub. It needs no matching and has real coefficients; what it cannot draw together is
-- homology (spec 2.13).
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local MOST = 1200 -- cells of a degree: dense matrices

local function zeros(rows, columns)
  local out = {}
  for i = 1, rows do
    out[i] = {}
    for j = 1, columns do out[i][j] = 0 end
  end
  return out
end

-- d of degree k as rows of faces
local function boundary(K, k)
  local out = zeros(K:count(k - 1), K:count(k))
  for cell = 1, K:count(k) do
    for j, face in ipairs(K:faces(k, cell)) do out[face][cell] = j % 2 == 1 and 1 or -1 end
  end
  return out
end

local function times(A, B)
  local out = zeros(#A, #B > 0 and #B[1] or 0)
  for i, row in ipairs(A) do
    for k, x in ipairs(row) do
      if x ~= 0 then
        for j, y in ipairs(B[k]) do out[i][j] = out[i][j] + x * y end
      end
    end
  end
  return out
end

-- the least solution X of A X = B, column after column: by orthogonal rows of A (Gram-Schmidt,
-- twice for round-off), with what each is made of
local function least_solution(A, B)
  local rows, n, m = {}, #A[1], #B[1]
  for i = 1, #A do
    local v, b = { table.unpack(A[i]) }, { table.unpack(B[i]) }
    local size = 0
    for _, x in ipairs(v) do size = size + x * x end
    for _ = 1, 2 do
      for _, row in ipairs(rows) do
        local share = 0
        for j = 1, n do share = share + v[j] * row.v[j] end
        for j = 1, n do v[j] = v[j] - share * row.v[j] end
        for j = 1, m do b[j] = b[j] - share * row.b[j] end
      end
    end
    local left = 0
    for _, x in ipairs(v) do left = left + x * x end
    if left > 1e-18 * size then
      local scale = 1 / left ^ 0.5
      for j = 1, n do v[j] = v[j] * scale end
      for j = 1, m do b[j] = b[j] * scale end
      rows[#rows + 1] = { v = v, b = b }
    end
  end
  local out = zeros(n, m)
  for _, row in ipairs(rows) do
    for i = 1, n do
      if row.v[i] ~= 0 then
        for j = 1, m do out[i][j] = out[i][j] + row.v[i] * row.b[j] end
      end
    end
  end
  return out
end

-- 1 - p d, or 1 - projection on the hub in degree 0
local function remainder(K, k, hub, below)
  local out = k > 0 and times(below, boundary(K, k)) or zeros(K:count(0), K:count(0))
  for i, row in ipairs(out) do
    for j = 1, #row do row[j] = (i == j and 1 or 0) - row[j] end
    if k == 0 and i == hub then for j = 1, #row do row[j] = row[j] - 1 end end
  end
  return out
end

--- cocone and defect of the mesh.
function M.engine(K, hub)
  for k = 0, K.dimension do
    if K:count(k) > MOST then
      option.fail("mesh:cone", "rule \"linear\" is for meshes of at most %d cells a degree, not %d",
        MOST, K:count(k))
    end
  end
  local p, worst = {}, 0
  for k = 0, K.dimension do
    local wanted = remainder(K, k, hub, p[k - 1])
    local d = k < K.dimension and boundary(K, k + 1)
    p[k] = d and least_solution(d, wanted)
    local got = d and times(d, p[k])
    for i, row in ipairs(wanted) do
      for j, x in ipairs(row) do worst = math.max(worst, math.abs(x - (got and got[i][j] or 0))) end
    end
  end
  local engine = {}
  function engine.defect() return worst end
  function engine.cocone(k, alpha)
    local out = core.zeros(K:count(k))
    for i, row in ipairs(p[k]) do
      for j, x in ipairs(row) do
        if x ~= 0 then out[j] = out[j] + x * alpha[i] end
      end
    end
    return out
  end
  return engine
end

return M
