--- A traced function carried out in another algebra: numbers, exact expressions, power series. Its
-- graph as text is a Lua chunk; whatever has + - * / ^ can stand for its inputs.
local core = require "dm.core"
local functions = require "dm.frame.calculus.functions"

local M = {}

local function refuse(name)
  return function()
    error(("'%s' has no exact formula: use + - * / ^, sqrt, exp, log and circular functions")
      :format(name), 0)
  end
end

local REFUSED = { "abs", "sign", "min", "max", "where", "atan2" }

-- numbers that the text of a graph writes as nan and inf
local NOT_FINITE = { __index = function(_, name)
  if name ~= "nan" and name ~= "inf" then return nil end
  error("a number in the formula is NaN or infinite: is there a 0/0 in it, or does it overflow?", 0)
end }

-- the functions of a chunk, in an algebra where apply(name, x) is f(x)
local function environment(apply)
  local env = { fma = function(a, b, c) return a * b + c end }
  for name in pairs(functions) do env[name] = function(x) return apply(name, x) end end
  for _, name in ipairs(REFUSED) do env[name] = refuse(name) end
  function env.sqrt(x) return x ^ 0.5 end
  function env.rsqrt(x) return x ^ -0.5 end
  function env.rsqrt3(x) return x ^ -1.5 end
  return setmetatable(env, NOT_FINITE)
end

--- reader(inputs, apply) -> list of the `count` outputs of the dm.function f.
function M.of(f, count)
  local text = f:graph()
  local chunk
  return function(inputs, apply)
    local env = environment(apply)
    for i = 1, #inputs do env["x" .. i] = inputs[i] end
    chunk = assert(load(text, "=formula", "t", env))
    chunk()
    local out = {}
    for i = 1, count do out[i] = env["y" .. i] end
    return out
  end
end

--- The same of a Lua function of a vector of n entries that gives `count` numbers.
function M.traced(f, n, count) return M.of(core.trace(f, n), count) end

return M
