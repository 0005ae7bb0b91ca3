--- Where a wave lives: points, potential and start as the equation wants them.
local blame = require "dm.base.blame"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local vector = require "dm.wave.vector"

local M = {}

local WHERE = "dm.schroedinger"
local fail = option.failing(WHERE)

local LEAST, MOST = 4, 2 ^ 24  -- points
local MOST_DENSE = 1200        -- unknowns of matrices
local SMALL = 1e-140           -- sizes of psi whose squares are numbers

---- points ----

local function is_finite(x) return type(x) == "number" and x - x == 0 end

--- from, to, N of x = { from, to, N }; raises where they do not fit the boundary and the space.
function M.interval(options, walls, galerkin)
  local x = option.need(options, "x", WHERE, "{ from, to, number of points }")
  if type(x) ~= "table" or not (is_finite(x[1]) and is_finite(x[2])) or #x ~= 3 then
    fail "option 'x' must be { from, to, N }: two ends and a number of points"
  end
  local N = lists.whole(x[3])
  if not (x[1] < x[2]) then fail("option 'x': %g to %g is no interval", x[1], x[2]) end
  if not N or N < LEAST or N > MOST then
    fail("option 'x': N must be a whole number from %d to %d (got %s)", LEAST, MOST,
      option.got(x[3]))
  end
  if not walls and N % 2 ~= 0 then
    fail("option 'x': N must be even on a ring (got %d): the mode N/2 is a cosine; walls take any",
      N)
  end
  if (walls or galerkin) and N > MOST_DENSE then
    fail("option 'x': %s works with matrices of N^2 numbers: N up to %d (got %d)",
      walls and 'boundary = "walls"' or 'space = "galerkin"', MOST_DENSE, N)
  end
  return x[1] * 1.0, x[2] * 1.0, N
end

-- a vector with a zero on both sides
local function with_ends(v, first, last)
  local out = core.zeros(#v + 2)
  out[1], out[#v + 2] = first, last
  for j = 1, #v do out[j + 1] = v[j] end
  return out
end

--- The N points and the weights of integrals; between walls the walls are among them.
function M.points(wave)
  local x, weight = core.wave_points(wave.kind, wave.from, wave.to, wave.unknowns)
  if wave.kind ~= "walls" then return x, weight end
  local last = wave.N - 1
  local end_weight = (wave.to - wave.from) / 2 / (last % 2 == 0 and last ^ 2 - 1 or last ^ 2)
  return with_ends(x, wave.from, wave.to), with_ends(weight, end_weight, end_weight)
end

---- V ----

-- the functions of a script that take t, too
local function takes_time(V)
  local info = debug.getinfo(V, "u")
  return info.nparams >= 2 and not info.isvararg
end

local function energy_at(V, x)
  local y = V(x)
  if not is_finite(y) then
    fail("V(%g) must be a finite number (got %s): is it singular there? Shift the points, or cut "
      .. "it off", x, option.got(y))
  end
  return y * 1.0
end

local function sampled(V, x)
  local out = core.zeros(#x)
  for j = 1, #x do out[j] = energy_at(V, x[j]) end
  return out
end

-- a list of N values
local function listed(V, wave)
  local fine, values = blame.try(core.vector, V)
  if not fine or #values ~= wave.N then
    fail("option 'V' must be a function of x, a number, or a list of N = %d numbers (got %s)",
      wave.N, fine and #values .. " numbers" or option.got(V))
  end
  for j = 1, #values do
    if not is_finite(values[j]) then fail("V at point %d is %s", j, tostring(values[j])) end
  end
  if wave.kind ~= "walls" then return values end
  return core.wave_nodes("walls", wave.from, wave.to, wave.unknowns, values)
end

--- V at the nodes of the equation, a dm.vector.
function M.potential(options, wave)
  local V = options.V
  if V == nil then V = 0 end
  if type(V) == "number" then
    local constant = V
    V = function() return constant end
  end
  if type(V) ~= "function" then return listed(V, wave) end
  if takes_time(V) then
    fail "V must be a function of x alone: potentials that depend on time are not stepped"
  end
  local nodes = core.wave_nodes(wave.kind, wave.from, wave.to, wave.unknowns)
  return sampled(option.single(V, "V"), nodes)
end

---- psi ----

-- two numbers of what a function of the script gave
local function value_at(psi, x)
  local re, im, more = psi(x)
  if more ~= nil then fail("psi must return two numbers, re and im: psi(%g) gave more", x) end
  if im == nil then im = 0 end
  if not (is_finite(re) and is_finite(im)) then
    fail("psi(%g) must be two finite numbers, re and im (got %s, %s)", x, option.got(re),
      option.got(im))
  end
  return re * 1.0, im * 1.0
end

local function from_function(psi, x)
  local re, im = core.zeros(#x), core.zeros(#x)
  for j = 1, #x do re[j], im[j] = value_at(psi, x[j]) end
  return re, im
end

-- a complex vector, or { re =, im = }
local function from_values(psi, N)
  if type(psi) ~= "table" or psi.re == nil then
    fail("option 'psi' must be a function of x that returns re, im, or a complex vector (got %s)",
      option.got(psi))
  end
  local fine, re = blame.try(core.vector, psi.re)
  local too, im = blame.try(core.vector, psi.im or core.zeros(fine and #re or 0))
  if not (fine and too and #re == N and #im == N) then
    fail("option 'psi': re and im must have N = %d numbers each", N)
  end
  for j = 1, N do
    if not (is_finite(re[j]) and is_finite(im[j])) then fail("psi at point %d is not finite", j) end
  end
  return re, im
end

-- without the walls, at which it must vanish
local function inner(re, im)
  local largest, N = 0, #re
  for j = 1, N do largest = math.max(largest, math.abs(re[j]), math.abs(im[j])) end
  for _, j in ipairs { 1, N } do
    if math.max(math.abs(re[j]), math.abs(im[j])) > 1e-6 * largest then
      fail("psi must be 0 at the walls (it is %g + %g i at wall %d)", re[j], im[j],
        j == 1 and 1 or 2)
    end
  end
  local a, b = core.zeros(N - 2), core.zeros(N - 2)
  for j = 2, N - 1 do a[j - 1], b[j - 1] = re[j], im[j] end
  return a, b
end

--- re, im of the unknowns, of a start.
function M.values(wave, psi)
  local re, im
  if type(psi) == "function" then
    re, im = from_function(psi, wave.x)
  else
    re, im = from_values(psi, wave.N)
  end
  if wave.kind == "walls" then re, im = inner(re, im) end
  local size = math.max(re:norm(), im:norm())
  if size == 0 then fail "psi is 0 at all points: there is no wave" end
  if size < SMALL or size > 1 / SMALL then
    fail("psi of the size %.3g has no |psi|^2 among floating-point numbers: scale it", size)
  end
  return re, im
end

--- The complex vector of unknowns re, im.
function M.wrap(wave, re, im)
  if wave.kind == "walls" then re, im = with_ends(re, 0, 0), with_ends(im, 0, 0) end
  return vector.new(re, im, wave.x, wave.weight)
end

return M
