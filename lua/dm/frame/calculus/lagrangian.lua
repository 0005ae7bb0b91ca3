--- A Lua function L(I) of the invariants as an exact expression: I.kappa[1] is kappa, I.kappa[2]
-- its derivative.
local core = require "dm.core"
local F = require "dm.frame.calculus.field"
local formula = require "dm.frame.calculus.formula"
local normal = require "dm.frame.calculus.normal"
local option = require "dm.base.options"
local read = require "dm.frame.calculus.read"

local M = {}

-- what stands for an invariant and its derivatives, which is no number itself
local function events_of(name, index)
  local out = { __index = index }
  local function refuse()
    error(("I.%s is %s with its derivatives: the invariant itself is I.%s[1]"):format(name, name,
      name), 0)
  end
  for _, event in ipairs { "add", "sub", "mul", "div", "pow", "unm", "mod", "idiv", "lt", "le",
    "concat", "call" } do
    out["__" .. event] = refuse
  end
  return out
end

--- The expression of L, a function or a formula.
function M.of(C, L)
  if formula.is(L) then
    if L.calculus ~= C or #L ~= 1 then error("L must be one formula of this calculus", 0) end
    return L[1].expression
  end
  if type(L) ~= "function" then
    error(("L must be a function of the invariants, L(I) with I.%s[1], ... (got %s)"):format(
      C.named[1] and C.named[1].name or "kappa", type(L)), 0)
  end
  L = option.numeric(L, "L")
  local most = math.min(#C.words.list, 30)
  local inputs, places = {}, {}
  for j in ipairs(C.named) do
    for place = 1, most do
      inputs[#inputs + 1] = normal.invariant(C, j, place)
      places[j * 1000 + place] = #inputs
    end
  end
  local function row(x, j)
    return setmetatable({}, events_of(C.named[j].name, function(_, k)
      if math.type(k) ~= "integer" or k < 1 or k > most then
        error(("I.%s[k] is the invariant (k = 1) and its derivatives, k up to %d (got %s)"):format(
          C.named[j].name, most, option.got(k)), 0)
      end
      return x[places[j * 1000 + k]]
    end))
  end
  local function f(x)
    local I = setmetatable({}, { __index = function(_, name) return row(x, C.find(name,
      "L(I)")) end })
    return L(I)
  end
  if #inputs == 0 then error("dm.differential_invariants: no invariants are named, so L has "
    .. "nothing to depend on", 0) end
  local value = read.of(core.trace(f, #inputs), 1)(inputs, F.apply)[1]
  return F.is(value) and value or F.number(C.field, value)
end

return M
