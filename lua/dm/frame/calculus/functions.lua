--- Elementary functions that exact formulas know: value(x) of numbers, slope(u, apply) = f'(u), and
-- where f is a whole number exactly.
local function one(u) return u * 0 + 1 end

return {
  exp = { value = math.exp, exact = { [0] = 1 }, slope = function(u, f) return f("exp", u) end },
  log = { value = math.log, exact = { [1] = 0 }, tex = "ln",
    slope = function(u) return one(u) / u end },
  sin = { value = math.sin, exact = { [0] = 0 }, slope = function(u, f) return f("cos", u) end },
  cos = { value = math.cos, exact = { [0] = 1 }, slope = function(u, f) return -f("sin", u) end },
  tan = { value = math.tan, exact = { [0] = 0 },
    slope = function(u, f) return f("tan", u) ^ 2 + 1 end },
  asin = { value = math.asin, exact = { [0] = 0 }, tex = "arcsin",
    slope = function(u) return one(u) / (1 - u ^ 2) ^ 0.5 end },
  acos = { value = math.acos, exact = { [1] = 0 }, tex = "arccos",
    slope = function(u) return -one(u) / (1 - u ^ 2) ^ 0.5 end },
  atan = { value = math.atan, exact = { [0] = 0 }, tex = "arctan",
    slope = function(u) return one(u) / (1 + u ^ 2) end },
  sinh = { value = function(x) return (math.exp(x) - math.exp(-x)) / 2 end, exact = { [0] = 0 },
    slope = function(u, f) return f("cosh", u) end },
  cosh = { value = function(x) return (math.exp(x) + math.exp(-x)) / 2 end, exact = { [0] = 1 },
    slope = function(u, f) return f("sinh", u) end },
  tanh = { value = function(x) return 1 - 2 / (math.exp(2 * x) + 1) end, exact = { [0] = 0 },
    slope = function(u, f) return 1 - f("tanh", u) ^ 2 end },
}
