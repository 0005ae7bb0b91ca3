--- The lines in the spectrum of an orbit: the frequencies that a resolved run has, at the amplitude
-- that it has, where coordinates turn with several oscillations at once.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local cos, log, max, pi = math.cos, math.log, math.max, math.pi

local RULES, TOLERANCE = { "rk8", "gauss(4)" }, 1e-9
local FINE = 6                    -- rows in a turn of the fastest oscillation
local FEWEST, MOST = 512, 4096    -- rows, powers of 2: what is faster is not resolved
local STRONG = 0.1                -- of the largest amplitude of a coordinate: less is none
local LEAST = 3                   -- turns that a line must have

-- q at times evenly far apart, as columns; nil where no rule makes them
local function columns_of(system, start, T, count, project)
  local at, out = {}, {}
  for i = 1, count do at[i] = start.t + T * i / count end
  for _, rule in ipairs(RULES) do
    local fine, path = blame.try(function()
      return system:solver({ rule = rule, h = T / count }):run { q = start.q, v = start.v,
        p = start.p, t0 = start.t, at = at, project = project,
        control = { tolerance = TOLERANCE } }
    end)
    if fine then
      for i = 1, system.Q.dimension do out[i] = {} end
      for k = 1, count do
        local q = path.q[k]
        for i = 1, #out do out[i][k] = q[i] end
      end
      return out
    end
  end
end

-- |X_k|, k = 0 ... of a column less its mean, under Hann's window
local function amplitudes(x)
  local n, mean, out = #x, 0, {}
  for i = 1, n do mean = mean + x[i] / n end
  for i = 1, n do out[i] = (x[i] - mean) * (1 - cos(2 * pi * (i - 0.5) / n)) / 2 end
  local re, im = core.fft(out)
  for k = 1, n // 2 do out[k] = (re[k] ^ 2 + im[k] ^ 2) ^ 0.5 end
  return table.move(out, 1, n // 2, 1, {})
end

-- where between k - 1 and k + 1 the parabola through three logarithms is largest
local function summit(A, k)
  local a, b, c = log(A[k - 1]), log(A[k]), log(A[k + 1])
  local bend = a - 2 * b + c
  return bend < 0 and k + 0.5 * (a - c) / bend or k
end

-- the strong lines of a column, in turns of the whole time, the slowest first
local function lines_of(x)
  local A, most, out = amplitudes(x), 0, {}
  for k = LEAST + 1, #A do most = max(most, A[k]) end
  for k = LEAST + 1, #A - 1 do
    if A[k] >= STRONG * most and A[k] > A[k - 1] and A[k] >= A[k + 1] and A[k - 1] > 0
      and A[k + 1] > 0 then
      out[#out + 1] = summit(A, k) - 1
    end
  end
  return out
end

--- For each coordinate of R^n the frequencies of its strong lines over a time T from a start { q,
-- v, p, t }, the slowest first; `fastest` is the largest frequency anywhere. Nil where it takes
-- too many rows.
function M.lines(system, start, T, fastest, project)
  local count = FEWEST
  while count < FINE * fastest * T / (2 * pi) do count = 2 * count end
  local columns = count <= MOST and columns_of(system, start, T, count, project)
  if not columns then return nil end
  local out = {}
  for i, x in ipairs(columns) do
    out[i] = {}
    for k, turns in ipairs(lines_of(x)) do out[i][k] = 2 * pi * turns / T end
  end
  return out
end

return M
