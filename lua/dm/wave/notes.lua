--- What is to be known of the accuracy of a run: read off its rows, where each row has, behind its
-- columns, the share of the norm in the last third of the modes and the density at the ends.
local M = {}

local TAIL, EDGE = 7, 8    -- columns of the rows
local ALIASED = 1e-6       -- of the norm
local EMPTY, MET = 1e-6, 1e-3 -- of the largest density, at the ends

-- the first row at which column c is above `level`, and the largest of it
local function first_above(path, c, level)
  local column, row, most = path.rows:column(c), nil, 0
  for i = 1, #column do
    if column[i] > level and not row then row = i end
    most = math.max(most, column[i])
  end
  return row, most
end

local function aliasing(path)
  local row, most = first_above(path, TAIL, ALIASED)
  if not row then return end
  return ("aliasing: from t = %.4g up to %.2g of the norm is in the last third of the modes; "
    .. "take more points"):format(path.t[row], most)
end

-- a packet that was away from the ends and has come to them
local function round_the_ring(path)
  if path.wave.boundary == "walls" or path.rows[1][EDGE] > EMPTY then return end
  local row = first_above(path, EDGE, MET)
  if not row then return end
  return ("the wave meets itself round the ring from t = %.4g on; on a line it would not: take a "
    .. "longer interval"):format(path.t[row])
end

local function resonances(path)
  local wave = path.wave
  if wave.g == 0 or path.solver.choice.kind ~= "split" then return end
  local limit = wave:stability_limit(path.rule)
  if path.h <= limit then return end
  return ("h is beyond pi hbar/T_max = %.3g, where kicks and drifts of the nonlinear equation may "
    .. "resonate"):format(limit)
end

local function parasitic(path)
  local share = path.solver.stepper.parasitic
  if path.solver.choice.kind ~= "two-step" or share < 1e-4 then return end
  return ("the parasitic mode has %.2g of the wave from the start: a smaller h lessens it")
    :format(share)
end

--- A list of sentences.
function M.of(path)
  local out = {}
  for _, find in ipairs { aliasing, round_the_ring, resonances, parasitic } do
    out[#out + 1] = find(path)
  end
  return out
end

return M
