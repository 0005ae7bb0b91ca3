--- Coefficients of collocation at Gauss and Lobatto nodes, and the partner for momenta: b_i = int
-- l_i, a_ij = int_0^c_i l_j, A_ij = b_j (1 - a_ji / b_i) (HLW II.1.2, VI.4; Leok 2.4.2-3).
local core = require "dm.core"

local M = {}

local abs, cos, pi = math.abs, math.cos, math.pi

-- P_n(z), P'_n(z)
local function legendre(n, z)
  local p0, p1 = 1, z
  if n == 0 then return 1, 0 end
  for j = 2, n do p0, p1 = p1, ((2 * j - 1) * z * p1 - (j - 1) * p0) / j end
  return p1, abs(z) == 1 and n * (n + 1) / 2 * z ^ (n + 1) or n * (z * p1 - p0) / (z * z - 1)
end

local function root(z, step)
  for _ = 1, 100 do
    local move = step(z)
    z = z - move
    if abs(move) < 1e-17 then break end
  end
  return z
end

-- nodes in [0, 1]; nil where there are too few of them
local nodes = {}

function nodes.gauss(s)
  local c = {}
  for i = 1, s do
    local z = root(-cos(pi * (i - 0.25) / (s + 0.5)), function(z)
      local p, slope = legendre(s, z)
      return p / slope
    end)
    c[i] = (1 + z) / 2
  end
  return c
end

-- -1, 1 and the zeros of P'_(s-1), whose second derivative is in Legendre's equation
function nodes.lobatto(s)
  local c, n = { 0 }, s - 1
  if n < 1 then return nil end
  for i = 2, s - 1 do
    local z = root(-cos(pi * (i - 1) / n), function(z)
      local p, slope = legendre(n, z)
      return slope * (1 - z * z) / (2 * z * slope - n * (n + 1) * p)
    end)
    c[i] = (1 + z) / 2
  end
  c[s] = 1
  return c
end

local function lagrange(c, j, t)
  local product = 1
  for k = 1, #c do
    if k ~= j then product = product * (t - c[k]) / (c[j] - c[k]) end
  end
  return product
end

-- int_0^x l_j, exact by Gauss nodes
local function integral(c, j, x)
  local s = #c
  local sum = 0
  for _, t in ipairs(nodes.gauss(s)) do
    local _, slope = legendre(s, 2 * t - 1)
    local z = 2 * t - 1
    sum = sum + x / ((1 - z * z) * slope * slope) * lagrange(c, j, x * t)
  end
  return sum
end

local function collocation(c)
  local a, b = {}, {}
  for i = 1, #c do
    a[i], b[i] = {}, integral(c, i, 1)
    for j = 1, #c do a[i][j] = integral(c, j, c[i]) end
  end
  return a, b
end

local ALIAS = { midpoint = "gauss(1)" }

--- a, A, b of the rule that is named, or of the options a, b.
function M.read(options)
  local a, b = options.a, options.b
  if options.rule ~= nil then
    local name = ALIAS[options.rule] or tostring(options.rule)
    name = name:match "^rsprk%((.*)%)$" or name
    local kind, s = name:match "^(%a+)%s*%(%s*(%d+)%s*%)$"
    s = s and math.tointeger(tonumber(s))
    local c = nodes[kind] and s > 0 and s <= 12 and nodes[kind](s)
    if not c then
      error(("the rule must be gauss(s) or lobatto(s) with up to 12 stages, or give its "
        .. "coefficients a and b (got %s)")
        :format(tostring(options.rule)), 0)
    end
    a, b = collocation(c)
  elseif type(a) ~= "table" or type(b) ~= "table" then
    error("give the rule, \"gauss(s)\" or \"lobatto(s)\", or its coefficients a (rows) and b", 0)
  end
  -- refuses what is not symplectic, and names where
  core.sprk { a = a, b = b, A = options.A, B = options.A and b }
  local A = options.A or {}
  for i = 1, options.A and 0 or #b do
    A[i] = {}
    for j = 1, #b do A[i][j] = b[j] * (1 - a[j][i] / b[i]) end
  end
  return a, A, b
end

return M
