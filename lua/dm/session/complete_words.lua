--- What completes a string: names of rules, of a path's columns, of demonstrations, words that an
-- option takes; where none is known, names of files. No code of the user runs: of his values only
-- the columns of a path are asked.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local function rules()
  local list = {}
  for i, rule in ipairs(core.rules()) do list[i] = rule.name end
  return list
end

-- option -> words, or what gives them
local OPTIONS = {
  rule = rules, rules = rules, backend = { "jit", "tape", "cc" },
  derivatives = { "exact", "hyperdual" }, side = { "left", "right" },
  map = { "linear", "affine", "projective", "stereographic", "translation" },
  direction = { "up", "down", "both" },
  style = { "lines", "points", "linespoints" },
}

local function topics()
  local list = { "keys", "options", "rules", "classes", "topics", "demos", "examples", "failures" }
  for _, row in ipairs(require "dm.session.failures") do list[#list + 1] = row[1] end
  for class in next, core.docs do list[#list + 1] = type(class) == "string" and class or nil end
  for _, name in ipairs(require "dm.session.examples".names) do list[#list + 1] = name end
  return list
end

local FUNCTIONS = { demo = function() return require "dm.session.demo".names() end, help = topics }

local OF_COLUMNS = { column = true, drift = true, plot = true, series = true }
local WORST = { "constraint", "rolling" }

-- names of the columns of a path, and what else its methods take
local function columns(object, method)
  if not object or object.class ~= "dm.path" then return nil end
  if method == "worst" then return WORST end
  if not OF_COLUMNS[method] or object.value == nil then return nil end
  local fine, names = blame.try(function() return object.value.columns end)
  if not fine then return nil end
  local list = { method ~= "column" and "energy" or nil }
  for _, name in ipairs(names) do list[#list + 1] = name end
  return list
end

local function given(words) return type(words) == "function" and words() or words end

-- the option whose value, or list of values, the string at the end belongs to
local function option(tokens, at, enclosing)
  if tokens[at].text ~= "=" then
    at = enclosing(tokens, at)
    at = at and tokens[at].text == "{" and at - 1
  end
  local key = at and at > 1 and tokens[at].text == "=" and tokens[at - 1]
  return key and OPTIONS[key.text]
end

-- the name of the function that the string at the end is given to: f "x", f("x", f(a, "x", f(a, {
-- "x"
local function callee(tokens, at, enclosing)
  for _ = 1, 3 do
    if not at or at < 1 then return nil end
    local text = tokens[at].text
    if tokens[at].kind == "name" then return at end
    if text ~= "(" and text ~= "{" then at = enclosing(tokens, at) end
    at = at and at - 1
  end
end

--- The words that can stand where the last token, a string that is open, begins; nothing: names of
-- files. resolve, enclosing: of dm.complete.
function M.words(tokens, resolve, enclosing)
  local at = #tokens - 1
  if at < 1 then return nil end
  local words = option(tokens, at, enclosing)
  if words then return given(words) end
  local name = callee(tokens, at, enclosing)
  if not name then return nil end
  local before = tokens[name - 1]
  if before and before.text == ":" and name > 2 then
    return columns(resolve(tokens, name - 2), tokens[name].text)
  end
  return given(FUNCTIONS[tokens[name].text])
end

return M
