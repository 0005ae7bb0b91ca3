--- Functions of a user that go wrong: after some calls that are right.
local dm = require "dm"

local M = {}

local function deep(n) return n == 0 and 0 or 1 + deep(n - 1) end

-- a run inside the function that a run, a trace or a quadrature calls
local function run_inside(right)
  local inside = false
  return function(...)
    if inside then return right(...) end
    inside = true
    local fine, result = pcall(function(...)
      dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end })
        :solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 3 }
      return right(...)
    end, ...)
    inside = false
    if not fine then error(result, 0) end
    return result
  end
end

local WRONG = {
  function() end, function() return nil, nil end,
  function(right, ...) return right(...), right(...), 3 end,
  function() return 0 / 0 end, function() return -1 / 0 end, function() return 1e308 end,
  function() return "text" end, function() return true end, function() return {} end,
  function() return { {}, { 1, "x" } } end, function() return { 1, 2, 3, 4, 5, 6, 7 } end,
  function() return function() end end, function() error "raised on purpose" end,
  function() error {} end, function() error(nil) end, function() return coroutine.yield(1) end,
  function(_, ...) return (...) end,
}

--- A function that returns what `right` does for some calls, then something else: too many values,
-- none, other types, NaN, errors of every type, a yield, a run inside itself, an overflowing stack,
-- or value(), anything at all.
function M.callback(random, right, value)
  local from, kind = random(0, 6), random(#WRONG + 2)
  if kind == #WRONG + 1 then return run_inside(right) end
  local wrong, calls = WRONG[kind], 0
  if not wrong then wrong = function() return value(1) end end
  if random(60) == 1 then wrong = function() return deep(1e7) end end
  return function(...)
    calls = calls + 1
    if calls <= from then return right(...) end
    return wrong(right, ...)
  end
end

return M
