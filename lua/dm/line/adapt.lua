--- dm.adapt: the least integral of W(u') - f u over the values and the knots of a broken line (Leok
-- 5.6): free knots go where they are needed.
local blame = require "dm.base.blame"
local blocks = require "dm.line.blocks"
local core = require "dm.core"
local loads = require "dm.line.load"
local option = require "dm.base.options"
local units = require "dm.line.adapt_units"

local M = {}

local fail = option.failing "dm.adapt"
local KNOWN = { "W", "f", "x", "ends" }
local MOST = 400          -- iterations
local SMALL = 1e-7        -- beside the energy: a gradient that rounding may leave
local NEAR = 1e-9         -- of the knots and values: a step as short is near the end
local ROUNDING = 1e-15    -- of an energy
local IDLE = 10           -- iterations that change the energy by rounding alone, and then no more
local LEAST = 0.2         -- of its length an element keeps in one iteration

---- the energy of an element ----

-- e(X0, v0, X1, v1) of W; u = v + the line: knots that go along a steep line then change X alone,
-- and the Hessian does not hide their own equation behind that of the line
local function element(W, line)
  return function(w)
    local length = w[3] - w[1]
    return length * W(line.slope + (w[4] - w[2]) / length)
  end
end

-- { value, slope, hessian } of it
local function derivatives(W, line)
  local e = element(W, line)
  local slope = core.derivative(e, 4)
  return { value = core.trace(e, 4), slope = slope,
    hessian = core.derivative(function(w) return slope(w) end, 4) }
end

---- sums over elements: z = X_1, v_1, X_2, v_2, ... ----

local function part(z, e)
  local k = 2 * e - 2
  return { z[k + 1], z[k + 2], z[k + 3], z[k + 4] }
end

local function energy_of(p, z)
  local sum = 0
  for e = 1, p.elements do
    local w = part(z, e)
    sum = sum + p.of.value(w) - (p.load and loads.value(p.load, p.line, w) or 0)
  end
  return sum
end

-- NaN where W or f is no number
local function tried(p, z)
  local fine, energy = blame.try(energy_of, p, z)
  return fine and energy or 0 / 0
end

local NONE = { 0, 0, 0, 0 }
local ZEROS = { NONE, NONE, NONE, NONE }

-- the gradient, and the blocks of the Hessian
local function derivatives_of(p, z)
  local out, H = {}, blocks.zeros(p.elements + 1)
  for k = 1, 2 * p.elements + 2 do out[k] = 0 end
  for e = 1, p.elements do
    local w, pull, bend = part(z, e), NONE, ZEROS
    if p.load then pull, bend = loads.derivatives(p.load, p.line, w) end
    local slope, own = p.of.slope(w), p.of.hessian(w)
    local h = { {}, {}, {}, {} }
    for k = 1, 4 do
      local at = 2 * e - 2 + k
      out[at] = out[at] + slope[k] - pull[k]
      for l = 1, 4 do h[k][l] = own[k][l] - bend[k][l] end
    end
    blocks.add(H, e, h)
  end
  return out, H
end

-- the gradient without what is held, and the blocks of the Hessian, the rows of 1 there
local function system_of(p, z, held)
  local slope, H = derivatives_of(p, z)
  for k = 1, #slope do
    if held[k] then
      slope[k] = 0
      blocks.hold(H, k)
    end
  end
  return slope, H
end

---- Newton's method with a shift, downhill ----

local function norm(x)
  local largest = 0
  for k = 1, #x do largest = math.max(largest, math.abs(x[k])) end
  return largest
end

-- the part of dz that keeps every element LEAST of its length
local function in_order(p, z, dz)
  local t = 1
  for e = 1, p.elements do
    local length, change = z[2 * e + 1] - z[2 * e - 1], dz[2 * e + 1] - dz[2 * e - 1]
    if length + t * change < LEAST * length then t = (LEAST - 1) * length / change end
  end
  return t
end

local function moved(z, dz, t)
  local out = {}
  for k = 1, #z do out[k] = z[k] + t * dz[k] end
  return out
end

-- a shift of the Hessian that makes it positive definite, and the step; scale: of its entries
local function downhill(slope, H, shift, scale)
  for _ = 1, 60 do
    local dz = blocks.solve(H, slope, shift)
    if dz then return dz, shift end
    shift = math.max(10 * shift, 1e-10 * scale)
  end
  fail("the second derivative of the energy is not finite")
end

-- positive definite, but for rounding
local function is_least(slope, H)
  return blocks.solve(H, slope, 1e-9 * blocks.largest(H)) ~= nil
end

-- the step of the values where knots stay
local function values_alone(p, z, held)
  local still = {}
  for k = 1, #z do still[k] = k % 2 == 1 or held[k] end
  local slope, H = system_of(p, z, still)
  return (downhill(slope, H, 0, blocks.largest(H)))
end

-- z moves until the gradient is round-off; held: marks of what stays
local function minimize(p, z, held)
  local shift, energy, last = 0, tried(p, z), math.huge
  local best, least, idle = z, math.huge, 0 -- where rounding alone moves the energy
  if energy - energy ~= 0 then fail("W or f is not finite on the first knots") end
  local waits = false -- knots for the values, where an element would lose half of its length
  for k = 1, MOST do
    local slope, H = system_of(p, z, held)
    local size, scale = norm(slope), blocks.largest(H)
    if size < 0.5 * least then idle = 0 end
    if size < least then best, least = z, size end
    if idle >= IDLE and is_least(slope, H) then return best, k, least end
    local dz
    dz, shift = downhill(slope, H, shift, scale)
    local step, t = norm(dz), in_order(p, z, dz)
    if shift <= 1e-9 * scale and step <= NEAR * norm(z) and size >= 0.5 * last then
      return z, k, size
    end
    waits = t < 0.5 and not waits
    if waits then dz, t = values_alone(p, z, held), 1 end
    local trial, now, accepted = nil, nil, false
    for _ = 1, 40 do
      trial = moved(z, dz, t)
      now = tried(p, trial)
      accepted = now <= energy + ROUNDING * math.abs(energy)
        or step <= NEAR * norm(z) and now < math.huge -- energies differ by rounding alone
      if accepted then break end
      t = t / 2
    end
    if not accepted then
      if size <= SMALL * (1 + math.abs(energy)) then return z, k, size end
      shift = math.max(10 * shift, 1e-8 * scale)
    else
      idle = now > energy - ROUNDING * math.abs(energy) and idle + 1 or 0
      if idle == 0 then least = math.huge end
      z, energy, last = trial, now, size
      shift = t == 1 and shift / 10 or shift
      if shift < 1e-14 * scale then shift = 0 end
    end
  end
  local slope, H = system_of(p, z, held)
  if is_least(slope, H) and last <= SMALL * (1 + math.abs(energy)) then return z, MOST, last end
  fail("the energy has no least value that %d iterations find: is W convex and f finite? (largest "
    .. "derivative left %.2g)", MOST, last)
end

---- knots ----

local FLAT = 1e-7 -- of what pulls at the ends, and of the energy over the length: forces inside

-- Raises where elements have shrunk to nothing, or what is found is no least value.
local function check(p, z, held)
  local length = z[#z - 1] - z[1]
  for e = 1, p.elements do
    if not (z[2 * e + 1] - z[2 * e - 1] > 1e-9 * length) then
      fail("the knots %d and %d meet at x = %.6g: with both the energy has no least value; is W "
        .. "convex? Fewer elements may have one", e, e + 1, z[2 * e - 1])
    end
  end
  local all, inside, energy = derivatives_of(p, z), system_of(p, z, held), energy_of(p, z)
  if not (norm(inside) <= FLAT * (norm(all) + math.abs(energy) / length)) then
    fail("the energy has no least value that is found: is W convex and f finite? (largest "
      .. "derivative left %.2g)", norm(inside))
  end
end

-- Raises where u twice as far from the line between its ends has less energy: then there is no end.
local function check_bounded(p, z)
  local further, energy = {}, energy_of(p, z)
  for k = 1, #z do further[k] = k % 2 == 0 and 2 * z[k] or z[k] end
  if tried(p, further) < energy - 1e-9 * math.abs(energy) then
    fail "the energy has no least value: it falls the more u grows; does W grow faster than f u?"
  end
end

-- knots that nothing moves: both slopes beside them are equal
local function affine(p, z)
  local out, slopes, largest, elements = {}, {}, 0, p.elements
  for e = 1, elements do
    slopes[e] = p.line.slope + (z[2 * e + 2] - z[2 * e]) / (z[2 * e + 1] - z[2 * e - 1])
    largest = math.max(largest, math.abs(slopes[e]))
  end
  for i = 2, elements do
    if math.abs(slopes[i] - slopes[i - 1]) <= 1e-9 * largest then out[#out + 1] = i end
  end
  return out
end

-- marks of X alone, of the ends, or of both
local function marks(p, ends, also_x)
  local held = {}
  for i = 0, p.elements do held[2 * i + 1] = also_x or i == 0 or i == p.elements end
  held[2], held[2 * p.elements + 2] = ends[1] ~= "free", ends[2] ~= "free"
  return held
end

-- numbers that both lists have
local function common(a, b)
  local has, out = {}, {}
  for _, i in ipairs(b) do has[i] = true end
  for _, i in ipairs(a) do if has[i] then out[#out + 1] = i end end
  return out
end

-- values and knots; affine knots are frozen where they are, until others bend u there
local function move_knots(p, z, ends)
  local count, frozen = 0, affine(p, z)
  repeat
    local held, before, now = marks(p, ends, false), #frozen, nil
    for _, i in ipairs(frozen) do held[2 * i - 1] = true end
    z, now = minimize(p, z, held)
    count, frozen = count + now, common(frozen, affine(p, z))
    if #frozen == before then
      check_bounded(p, z)
      check(p, z, held)
      return z, count
    end
  until false
end

-- values first, then knots with them
local function solve(p, z, ends)
  return move_knots(p, (minimize(p, z, marks(p, ends, true))), ends)
end

local function read_ends(ends)
  local list = type(ends) == "table"
  for side = 1, 2 do
    local u = list and ends[side]
    if not (u == "free" or type(u) == "number" and u - u == 0) then
      fail("option 'ends' must be { u(from), u(to) }, numbers or \"free\" (got %s)",
        option.got(list and u or ends))
    end
  end
  for key in pairs(ends) do
    if key ~= 1 and key ~= 2 then
      fail("option 'ends' must be { u(from), u(to) }, and has '%s' beside", tostring(key))
    end
  end
  return ends
end

local function read(options)
  option.check(options, KNOWN, "dm.adapt")
  for _, key in ipairs { "W", "x", "ends" } do
    option.need(options, key, "dm.adapt", "W(u'), x = { from, to, elements }, ends = { u(from), "
      .. "u(to) }")
  end
  option.callable(options, "W", "dm.adapt", "s, the slope of u")
  option.callable(options, "f", "dm.adapt", "x")
  local grid = require "dm.line.grid".read(options.x, "dm.adapt", "elements")
  if grid.periodic then fail("option 'x': knots of a ring have no ends") end
  local ends = read_ends(options.ends)
  if ends[1] == "free" and ends[2] == "free" then
    fail("option 'ends': u is determined at one end at least")
  end
  return grid, ends
end

local function first_guess(grid)
  local z = {}
  for i = 0, grid.cells do
    z[2 * i + 1] = i == grid.cells and grid.to or grid.from + i * grid.dx
    z[2 * i + 2] = 0
  end
  return z
end

-- what is found, of u: a knot that moves while u stays moves v by the slope of the line
local function result_of(p, z, iterations, exact)
  local n, line = p.elements + 1, p.line
  local x, u, force = core.zeros(n), core.zeros(n), core.zeros(n)
  local slope = derivatives_of(p, z)
  for i = 1, n do
    x[i] = z[2 * i - 1]
    u[i] = z[2 * i] + line.value + line.slope * (x[i] - line.from)
    force[i] = slope[2 * i - 1] - line.slope * slope[2 * i]
  end
  return core.result { x = x, u = u, force = force, energy = energy_of(p, z),
    frozen = core.result(affine(p, z)), iterations = iterations, exact = exact }
end

M.adapt = blame.caller(function(options)
  local own, own_ends = read(options)
  local unit, W, f, grid, ends = units.of(option.numeric(options.W, "dm.adapt: W"),
    options.f and option.numeric(options.f, "dm.adapt: f"), own, own_ends)
  local p = { elements = grid.cells, line = units.line(grid, ends) }
  p.of = derivatives(W, p.line)
  p.load = f and loads.new(f, grid.from, grid.to, grid.cells)
  local z, iterations = solve(p, first_guess(grid), ends)
  return units.back(result_of(p, z, iterations, not f or p.load.exact), unit, own, own_ends)
end)

core.docs[M.adapt] = [[
dm.adapt{W=, f=, x = {from, to, elements}, ends = {a, b}} -> {x, u, energy, force, frozen, ...}
The least integral of W(u') - f u over broken lines u with that many elements, over values and knots
alike (Leok 5.6). W(s), f(x): functions; ends: u at both ends, a number or "free". x, u: knots and
values; force: the derivative of the energy by each knot, 0 inside to round-off of those at the
ends, so that without f W - s W_s is equal on all elements; frozen: numbers of the knots beside
which u is affine, which nothing moves; exact: f is integrated to round-off (over up to 8192
panels); iterations. Knots stay where all that they could gain is below rounding of the energy, as
along very steep lines. A minimum near the one on equal elements: energies with several are not
searched. Raises where none is found.]]

return M
