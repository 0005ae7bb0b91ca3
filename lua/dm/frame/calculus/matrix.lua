--- dm.invariant_operator: matrices of differential operators with exact coefficients, as text and
-- by their coefficients.
local core = require "dm.core"
local blame = require "dm.base.blame"
local F = require "dm.frame.calculus.field"
local formula = require "dm.frame.calculus.formula"
local layout = require "dm.frame.calculus.layout"
local lists = require "dm.base.lists"
local normal = require "dm.frame.calculus.normal"
local O = require "dm.frame.calculus.operators"
local variation = require "dm.frame.calculus.variation"

local M = {}

-- how coefficients, derivations (power k of the i-th), variations and labels are written
local PLAIN = {
  coefficient = tostring,
  derivation = function(C, i, k) return layout.derivation(C, i) .. (k > 1 and "^" .. k or "") end,
  variation = function(b) return "t" .. b end,
  label = function(name) return name .. ": " end,
}
local TEX = {
  coefficient = function(c) return c:tex() end,
  derivation = function(C, i, k)
    return "\\mathcal{D}" .. (C.p > 1 and ("_{%d}"):format(i) or "")
      .. (k > 1 and ("^{%d}"):format(k) or "")
  end,
  variation = function(b) return ("t_{%d}"):format(b) end,
  label = function() return "" end,
}

-- one operator as text: (kappa^2 + 1) D^2 + ...
local function operator_text(C, op, write)
  local out = {}
  for b = 1, C.q do
    local places = {}
    for place in pairs(op[b]) do places[#places + 1] = place end
    table.sort(places, function(x, y) return x > y end)
    for _, place in ipairs(places) do
      local K, word = C.words.list[place], {}
      for i = 1, C.p do
        if K[i] > 0 then word[#word + 1] = write.derivation(C, i, K[i]) end
      end
      if C.q > 1 then word[#word + 1] = write.variation(b) end
      local c, name = write.coefficient(F.reduced(op[b][place])), table.concat(word, " ")
      if name ~= "" and c:find " [+-] " then c = "(" .. c .. ")" end
      if name ~= "" and c == "1" then c = "" end
      if name ~= "" and c == "-1" then c = "-" end
      out[#out + 1] = c .. ((c == "" or c == "-" or name == "") and "" or " ") .. name
    end
  end
  return #out > 0 and (table.concat(out, " + "):gsub("%+ %-", "- ")) or "0"
end

-- the adjoint of component b as an operator on one function
local function adjoint(C, op, b)
  local one = { p = C.p, q = 1 }
  setmetatable(one, { __index = C })
  local sum = O.identity(one)
  for place, c in pairs(op[b]) do
    local term, K = O.add(one, O.identity(one), O.identity(one, 1), c), C.words.list[place]
    for i = 1, C.p do
      for _ = 1, K[i] do
        local next_term = O.add(one, O.identity(one), O.D(one, i, term), F.number(C.field, -1))
        for j = 1, C.p do
          local y = j ~= i and normal.commutator(C, i, j)[j]
          if y and not y:is_zero() then next_term = O.add(one, next_term, term, y) end
        end
        term = next_term
      end
    end
    sum = O.add(one, sum, term)
  end
  return sum
end

local operator_class = core.class({ __name = "dm.invariant_operator" }, [[
dm.invariant_operator: a matrix of differential operators with exact coefficients, from
calculus:operator(); fields rows, columns; print(H) writes its rows.]])

local function new_operator(C, rows, columns, labels)
  return setmetatable({ C = C, list = rows, rows = #rows, columns = columns, labels = labels },
    operator_class)
end

local function rows_of(H, write)
  local out = {}
  for i, row in ipairs(H.list) do
    local entries = {}
    for k, op in ipairs(row) do entries[k] = operator_text(op.C or H.C, op, write) end
    out[i] = write.label(H.labels[i]) .. table.concat(entries, ", ")
  end
  return table.concat(out, "\n")
end

function operator_class.__tostring(H) return rows_of(H, PLAIN) end

core.method("dm.invariant_operator", "coefficient", blame.caller(function(H, i, j, ...)
  local C, K = H.C, { ... }
  for k = 1, C.p do K[k] = K[k] or 0 end
  local row = H.list[lists.whole(i) or 0]
  if not row or not lists.whole(j) or j < 1 or j > H.columns then
    error(("H:coefficient takes a row, 1 to %d, and a column, 1 to %d"):format(H.rows, H.columns),
      0)
  end
  local place = C.words.place[table.concat(K, ",")]
  local op = #row == 1 and row[1][j] or row[j][1]
  return formula.new(C, { op[place] or F.number(C.field, 0) })
end), [[
H:coefficient(i, j, k, ...) -> dm.formula
The coefficient of D^k (by several variables D_1^k D_2^l ...) in entry i, j.]])

core.method("dm.invariant_operator", "tex", blame.caller(function(H) return rows_of(H, TEX) end), [[
H:tex() -> string
Its rows for TeX's mathematics, one a line.]])

--- H and H* of the named invariants.
function M.of(C)
  local H, names, adjoints, variations = {}, {}, {}, {}
  for j, row in ipairs(C.named) do
    H[j], names[j] = { variation.of_variable(C, j, 1) }, row.name
  end
  for b = 1, C.q do
    adjoints[b], variations[b] = {}, "E of " .. layout.name(C, C.dependent[b])
    for j in ipairs(C.named) do adjoints[b][j] = adjoint(C, H[j][1], b) end
  end
  local star = new_operator(C, adjoints, #C.named, variations)
  for b = 1, C.q do
    for j in ipairs(C.named) do adjoints[b][j].C = setmetatable({ q = 1 }, { __index = C }) end
  end
  return new_operator(C, H, C.q, names), star
end

return M
