--- dm.formula: one exact formula or several, which print, have TeX and values.
local core = require "dm.core"
local F = require "dm.frame.calculus.field"
local blame = require "dm.base.blame"
local lists = require "dm.base.lists"
local option = require "dm.base.options"

local M = {}

local class = core.class({ __name = "dm.formula" }, [[
dm.formula: exact formulas in the invariants of a dm.differential_invariants, with rational
coefficients and in a normal form
#f: how many; f[i]: each by itself; fields: label (what it is the formula of); print(f) writes them,
kappa_ss + kappa^3/2. + and - of formulas of one calculus, f == g compares normal forms.]])

local function method(name, f, doc) core.method("dm.formula", name, blame.caller(f), doc) end

function M.is(x) return type(x) == "table" and getmetatable(x) == class end

--- Formulas from a list of expressions of the calculus C. options: labels; value(f, at), what they
-- are at numbers where that is more than each by itself; none, what to print where there are none.
function M.new(C, expressions, options)
  options = options or {}
  local self = setmetatable({ calculus = C, labels = options.labels, valued = options.value,
    none = options.none }, class)
  for i, e in ipairs(expressions) do
    e = F.reduced(e)
    local label = options.labels and options.labels[i]
    self[i] = setmetatable({ calculus = C, expression = e, label = label }, class)
    rawset(self[i], 1, self[i])
  end
  return self
end

local function line(f, text) return f.label and f.label .. " = " .. text or text end

function class.__tostring(f)
  if #f == 0 then return f.none or "no formulas" end
  local out = {}
  for i, row in ipairs(f) do
    local text = tostring(row.expression)
    out[i] = (#f > 1 or f.labels) and line(row, text) or text
  end
  return table.concat(out, "\n")
end

local function combined(f, g, sign)
  if not (M.is(f) and M.is(g)) or f.calculus ~= g.calculus or #f ~= #g then
    error("formulas of one calculus, as many of each, have a sum", 0)
  end
  local out = {}
  for i = 1, #f do
    out[i] = sign > 0 and f[i].expression + g[i].expression or f[i].expression - g[i].expression
  end
  return M.new(f.calculus, out)
end

class.__add = blame.caller(function(f, g) return combined(f, g, 1) end)
class.__sub = blame.caller(function(f, g) return combined(f, g, -1) end)

function class.__eq(f, g)
  if #f ~= #g or f.calculus ~= g.calculus then return false end
  for i = 1, #f do
    if not (f[i].expression - g[i].expression):is_zero() then return false end
  end
  return true
end

method("tex", function(f)
  local out = {}
  for i, row in ipairs(f) do out[i] = row.expression:tex() end
  return table.concat(out, " \\\\\n")
end, [[
f:tex() -> string
The formulas for TeX's mathematics, one a line.]])

---- values ----

-- how many numbers each invariant needs
local function needs(f)
  local out = {}
  for _, row in ipairs(f) do
    for _, info in pairs(row.expression:uses()) do
      if info.name then out[info.name] = math.max(out[info.name] or 0, info.place) end
    end
  end
  return out
end

local function check_known(C, at)
  for name in pairs(at) do
    local known, names = false, {}
    for i, row in ipairs(C.named) do
      known, names[i] = known or row.name == name, row.name
    end
    if not known then
      option.fail("f:value", "unknown invariant '%s': known are %s", tostring(name),
        table.concat(names, ", "))
    end
  end
end

-- the numbers of one invariant, checked
local function numbers_of(C, name, given, count)
  if type(given) == "number" then given = { given } end
  local n = given ~= nil and lists.count(given)
  if not n or n < count then
    local words = {}
    for i = 1, math.min(count, 6) do words[i] = C.word(name, i) end
    option.fail("f:value", "%s needs %d number%s, %s%s (got %s)", name, count,
      count == 1 and "" or "s", table.concat(words, ", "), count > 6 and ", ..." or "",
      n and tostring(n) or lists.got(given))
  end
  for i = 1, count do
    if type(given[i]) ~= "number" then
      option.fail("f:value", "%s[%d] must be a number (got %s)", name, i, option.got(given[i]))
    end
  end
  return given
end

--- The expressions of f at numbers, a list: at = { kappa = { ... } }.
function M.numbers(f, at)
  local C, given = f.calculus, {}
  if type(at) ~= "table" then
    option.fail("f:value", "takes the numbers of the invariants, { %s = { ... } }",
      C.named[1] and C.named[1].name or "kappa")
  end
  check_known(C, at)
  for name, count in pairs(needs(f)) do given[name] = numbers_of(C, name, at[name], count) end
  local out = {}
  for i, row in ipairs(f) do
    out[i] = F.map(row.expression, function(_, info) return given[info.name][info.place] end) + 0.0
    if out[i] ~= out[i] or math.abs(out[i]) == math.huge then
      option.fail("f:value", "the formula %s is not finite there", tostring(row.expression))
    end
  end
  return out
end

method("value", function(f, at)
  if f.valued then return f.valued(f, at) end
  return core.vector(M.numbers(f, at))
end, [[
f:value{kappa = {kappa, kappa_s, ...}, ...} -> dm.vector
The numbers that the formulas are, an entry each, where every named invariant and its derivatives
have these values (in the order of a jet, as I.kappa[1], [2], ... in L). Of a conservation law: of
a jet, value{x, u, u_x, ...}, the conserved vector c. Raises for an unknown invariant, and where
numbers are missing.]])

return M
