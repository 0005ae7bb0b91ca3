--- path:frequency: the strongest frequency of a column of a resolved run, for dm.multiscale.
local class = require "dm.base.class"
local core = require "dm.core"
local options = require "dm.base.options"

local abs, cos, sin, max, pi, sqrt = math.abs, math.cos, math.sin, math.max, math.pi, math.sqrt

local WHERE = "path:frequency"
local FEWEST, EVEN = 16, 1e-6   -- rows; of the distance of rows
local PERIODS, SAMPLES = 3, 3   -- that must be seen; in a period
local SECTIONS = 60

-- the distance of rows in time, which must be the same everywhere
local function distance(path)
  local t, n = path.t, #path
  if n < FEWEST then options.fail(WHERE, "%d rows are too few: %d at least", n, FEWEST) end
  local dt = (t[n] - t[1]) / (n - 1)
  for i = 2, n do
    if abs(t[i] - t[i - 1] - dt) > EVEN * dt then
      options.fail(WHERE, "rows must be equally far apart in time (they are not at row %d): take a "
        .. "rule with steps of one length, or times with at =", i)
    end
  end
  return dt
end

-- the column less its mean, under Hann's window
local function windowed(path, name)
  local x, n, mean, size = path:column(name), #path, 0, 0
  for i = 1, n do mean, size = mean + x[i] / n, max(size, abs(x[i])) end
  local out, change = {}, 0
  for i = 1, n do
    change = max(change, abs(x[i] - mean))
    out[i] = (x[i] - mean) * (1 - cos(2 * pi * (i - 0.5) / n)) / 2
  end
  if change <= 1e-13 * size or change == 0 then
    options.fail(WHERE, "column '%s' is constant", name)
  end
  return out
end

-- |sum_i x_i exp(-i w t_i)|
local function amplitude(x, dt)
  return function(w)
    local a, b = 0, 0
    for i = 1, #x do
      local phase = w * dt * i
      a, b = a + x[i] * cos(phase), b + x[i] * sin(phase)
    end
    return sqrt(a * a + b * b)
  end
end

-- where f is largest between a and b, by golden sections
local function largest(f, a, b)
  local golden = (3 - sqrt(5)) / 2
  local x, y = a + golden * (b - a), b - golden * (b - a)
  local fx, fy = f(x), f(y)
  for _ = 1, SECTIONS do
    if b - a <= 1e-12 * b then break end
    if fx > fy then
      b, y, fy = y, x, fx
      x = a + golden * (b - a)
      fx = f(x)
    else
      a, x, fx = x, y, fy
      y = b - golden * (b - a)
      fy = f(y)
    end
  end
  return 0.5 * (a + b)
end

-- number of the strongest of the frequencies k 2 pi/(n dt), k from `first` on
local function strongest(x, first)
  local re, im = core.fft(x)
  local best, k = -1, nil
  for i = first, #x // 2 do
    local size = re[i + 1] ^ 2 + im[i + 1] ^ 2
    if size > best then best, k = size, i end
  end
  return k
end

-- raises where the run is too short or too coarse for the frequency found
local function check(w, T, dt)
  if w * T < 2 * pi * PERIODS then
    options.fail(WHERE, "the strongest frequency is %.4g, of which the run has %.2g periods: run "
      .. "%d at least, or look above it, { above = }", w, w * T / (2 * pi), PERIODS)
  end
  if w * dt * SAMPLES > 2 * pi then
    options.fail(WHERE, "the strongest frequency is %.4g, of which a period has %.2g rows: the run "
      .. "does not resolve it, take a smaller h, or every = 1", w, 2 * pi / (w * dt))
  end
  return w
end

class.method("dm.path", "frequency", function(path, name, more)
  if type(name) ~= "string" then
    options.fail(WHERE, "takes the name of a column, as \"q1\" (got %s)", options.got(name))
  end
  more = options.check(more or {}, { "above" }, WHERE, "{ above = }")
  local above = options.positive(more, "above", WHERE, "a frequency", 0)
  local dt = distance(path)
  local x = windowed(path, name)
  local step = 2 * pi / (#x * dt)
  local first = max(2, math.ceil(above / step))
  if first > #x // 2 then options.fail(WHERE, "no frequency above %g is resolved", above) end
  local k = strongest(x, first)
  local w = largest(amplitude(x, dt), max((k - 1) * step, above), (k + 1) * step)
  return check(w, #x * dt, dt)
end, [[
path:frequency(name [, {above=}]) -> omega
The strongest frequency (radians per unit of time) of a column of a run that resolves it, by its
spectrum under Hann's window: the fast one for dm.multiscale (Leok 5.7.3: ten periods of 200 steps
give four digits). above: only frequencies above this one. Rows must be equally far apart. Raises
where there are fewer than 3 periods, or fewer than 3 rows in a period.]])

return {}
