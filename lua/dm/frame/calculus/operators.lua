--- Linear differential operators on the normalized variations theta^1 ... theta^q: op[b][place] is
-- the coefficient of D^K theta^b; in a word D^K the derivation with the smallest number comes
-- first.
local F = require "dm.frame.calculus.field"
local normal = require "dm.frame.calculus.normal"

local M = {}

--- theta^b itself; without b the operator that is zero.
function M.identity(C, b)
  local op = {}
  for c = 1, C.q do op[c] = {} end
  if b then op[b][1] = F.number(C.field, 1) end
  return op
end

--- a + c b, c an expression; a is not changed.
function M.add(C, a, b, c)
  local out = M.identity(C)
  for beta = 1, C.q do
    for place, x in pairs(a[beta]) do out[beta][place] = x end
    for place, x in pairs(b[beta]) do
      local sum = out[beta][place]
      local more = c and x * c or x
      sum = sum and sum + more or more
      out[beta][place] = not sum:is_zero() and sum or nil
    end
  end
  return out
end

function M.is_zero(C, a)
  for beta = 1, C.q do
    if next(a[beta]) then return false end
  end
  return true
end

-- D_i D^K theta^b in the order of words
local function of_word(C, i, place, beta)
  local K = C.words.list[place]
  for l = 1, i - 1 do
    if K[l] > 0 then
      local less = { table.unpack(K) }
      less[l] = less[l] - 1
      local X = M.identity(C)
      X[beta][C.words.place[table.concat(less, ",")]] = F.number(C.field, 1)
      local out = M.D(C, l, M.D(C, i, X))
      for k, y in ipairs(normal.commutator(C, i, l)) do
        if not y:is_zero() then out = M.add(C, out, M.D(C, k, X), y) end
      end
      return out
    end
  end
  local next_place = C.words.next[place][i]
  if not next_place then error("a formula has derivatives of too high an order", 0) end
  local out = M.identity(C)
  out[beta][next_place] = F.number(C.field, 1)
  return out
end

--- D_i after the operator.
function M.D(C, i, op)
  local out = M.identity(C)
  for beta = 1, C.q do
    for place, x in pairs(op[beta]) do
      out = M.add(C, out, of_word(C, i, place, beta), x)
      local rate = normal.D(C, i, x)
      if not rate:is_zero() then
        local single = M.identity(C)
        single[beta][place] = rate
        out = M.add(C, out, single)
      end
    end
  end
  return out
end

-- the adjoint of D_i for omega^1 ... omega^p: -D_i + sum_j Y^j_(i j)
local function adjoint_of_derivation(C, i, e)
  local out = -normal.D(C, i, e)
  for j = 1, C.p do
    if j ~= i then
      local y = normal.commutator(C, i, j)[j]
      if not y:is_zero() then out = out + y * e end
    end
  end
  return out
end

--- The adjoint of component b of an operator, applied to an expression: sum over words of (D^K)*
-- (c_K e).
function M.adjoint(C, op, beta, e)
  local sum = F.number(C.field, 0)
  for place, c in pairs(op[beta]) do
    local term, K = e and c * e or c, C.words.list[place]
    for i = 1, C.p do
      for _ = 1, K[i] do term = adjoint_of_derivation(C, i, term) end
    end
    sum = sum + term
  end
  return F.reduced(sum)
end

return M
