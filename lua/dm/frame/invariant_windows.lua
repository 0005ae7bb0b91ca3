--- Windows of points of an invariant problem: slopes of L and of its constraint at them, on the
-- section without the frame.
local core = require "dm.core"
local frames = require "dm.frame"
local points = require "dm.frame.points"
local tangent = require "dm.frame.tangent"

local M = {}

---- small tools on lists of points and covectors ----

local function part(list, first, count) return { table.unpack(list, first, first + count - 1) } end

-- list of d-vectors from a flat list or vector
local function blocks(x, count, d) return frames.split(x, count, d) end

local function numbers(list)
  local out = {}
  for _, v in ipairs(list) do
    for i = 1, #v do out[#out + 1] = v[i] end
  end
  return out
end
M.blocks, M.numbers, M.part = blocks, numbers, part

-- the last `count` points of a list and behind them `more`, on the parabola through its last three
-- (so that they have a frame where these have)
function M.padded(list, count, more)
  local out = part(list, 1, #list)
  for _ = 1, more do
    local n = #out
    out[n + 1] = n > 2 and (out[n] - out[n - 1]) * 3 + out[n - 2] or n > 1
      and out[n] * 2 - out[n - 1] or out[n]
  end
  return part(out, #list - count + 1, count + more)
end

--- A list as long as the frame wants, behind what its section looks at.
function M.for_frame(p, list)
  if #list >= p.frame.k then return list end
  return M.padded(list, #list, p.frame.k - #list)
end

---- L and its constraint at windows ----

-- generators at a list of points: rows by point and entry
local function psi_rows(p, list)
  local rows = {}
  for _, z in ipairs(list) do
    local v = p.generator(z)
    for a = 1, p.d do
      local row = {}
      for j = 1, p.r do row[j] = v[a][j] end
      rows[#rows + 1] = row
    end
  end
  return rows
end
M.psi_rows = psi_rows

-- slopes by all points of invariantized functions on the section, from those of the functions
-- themselves: g (1 - psi (J psi)^-1 J), by Bogfjellmo's thm 3, without the frame. `rows` are
-- numbers or symbols, a list for each function.
local function projected(p, window, rows)
  local psi, known = psi_rows(p, window), p.k * p.d
  local J = tangent.section_slope(p.frame, M.for_frame(p, window))
  local A = {}
  for i = 1, p.r do
    A[i] = {}
    for j = 1, p.r do
      A[i][j] = 0
      for l = 1, known do A[i][j] = A[i][j] + J[i][l] * psi[l][j] end
    end
  end
  local turned, out = core.matrix(A):transpose(), {}
  for f, g in ipairs(rows) do
    local along = {}
    for j = 1, p.r do
      along[j] = 0
      for l = 1, p.N * p.d do along[j] = along[j] + g[l] * psi[l][j] end
    end
    local c = turned:solve(core.vector(along))
    out[f] = {}
    for l = 1, p.N * p.d do
      out[f][l] = g[l]
      for i = 1, l <= known and p.r or 0 do out[f][l] = out[f][l] - J[i][l] * c[i] end
    end
  end
  return out
end

-- a covector at the points moved by g, seen at the points themselves: (T Psi_g)^T
local function pulled_back(p, g, window, row)
  local y, out = core.vector(points.entries(p.group:flat(g))), {}
  for j, z in ipairs(window) do
    local D = p.motion(y, z)
    for a = 1, p.d do
      local sum = 0
      for b = 1, p.d do sum = sum + D[b][p.flat_size + a] * row[(j - 1) * p.d + b] end
      out[#out + 1] = sum
    end
  end
  return out
end

-- (D L)(window), and that of every constraint; numbers go by way of the section, symbols through
-- the graph of the frame
local function slopes_apart(p, window, on_section)
  local z, rows = frames.flat(window), {}
  if not on_section and points.symbolic(window) then
    return p.slope(z), p.constraints > 0 and p.phi_slope(z)
  end
  if not on_section then
    local g = p.rho(window)
    local first, others = slopes_apart(p, p.move(g, window), true)
    for c = 1, p.constraints do rows[c] = pulled_back(p, g, window, others[c]) end
    return pulled_back(p, g, window, first), rows
  end
  rows[1] = p.bare_slope(z)
  local phi = p.constraints > 0 and p.bare_phi_slope(z)
  for c = 1, p.constraints do rows[c + 1] = phi[c] end
  rows = projected(p, window, rows)
  return table.remove(rows, 1), rows
end
M.slopes_apart = slopes_apart

-- (D L^c)(window) by blocks, L^c = L - mu . phi; on_section: the window's first points lie there
local function slopes(p, window, mu, on_section)
  local g, phi = slopes_apart(p, window, on_section)
  if p.constraints == 0 or not mu then return blocks(g, p.N, p.d) end
  local out = {}
  for i = 1, p.N * p.d do
    out[i] = g[i]
    for c = 1, p.constraints do out[i] = out[i] - mu[c] * phi[c][i] end
  end
  return blocks(out, p.N, p.d)
end
M.slopes = slopes

--- phi of the window that ends with the list.
function M.constraint_at_end(p, list)
  if p.constraints == 0 then return {} end
  return p.phi(M.padded(list, p.reach, p.N - p.reach))
end

-- where the last points of a list lead
local function ahead(list)
  local last, before = list[#list], list[#list - 1]
  return before and last * 2 - before or last
end
M.ahead = ahead

return M
