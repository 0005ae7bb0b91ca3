--- The invariant discrete Euler-Lagrange equations as one step y -> y', for dm.sequence.
--
-- For L of N points, E_i = sum_j (D_j L)(u_i-j+1 ... u_i-j+N) = 0 at every site i. It is a covector
-- at u_i, so it may be taken in any coordinates: here those in which the first points of the window
-- lie on the cross-section, U_j = rho_i . u_i+j-1. Its entries are then functions of the invariants
-- alone (H* E(L) of Bogfjellmo ch. 5, without the algebra). After each step the window is moved by
-- P = rho(U_2, U_3, ...), and rho_i+1 = P rho_i is multiplied up.
--
-- Two forms of the same equations:
--   points     the window has the 2 N - 2 points that E_i needs. What is printed in the thesis.
--   momentum   N - 1 points U_j and covectors m_j, what earlier sites have left at them:
--              m_1 + D_1 L = 0 gives the next point, m_j+1 + D_j+1 L are the new covectors. They
--              are kept as J = sum_j m_j . v(U_j) and the entries that J does not give: Noether's
--              law says that J changes by the coadjoint action of P alone, so no difference of
--              large numbers is ever taken (docs/theory/frames.md).
--
-- The unknown is not the next point but how far it lies from where the last two lead, and what the
-- section fixes stands as a number in the graph: with points h apart, differences of order h^3 keep
-- all their digits.
local core = require "dm.core"
local points = require "dm.frame.points"
local windows = require "dm.frame.invariant_windows"

local M = {}

local part, blocks, numbers, ahead = windows.part, windows.blocks, windows.numbers, windows.ahead
local psi_rows, slopes = windows.psi_rows, windows.slopes
local constraint_at_end = windows.constraint_at_end

---- state vectors with named parts ----

local Layout = {}
Layout.__index = Layout

function Layout.new(parts)
  local self, first = setmetatable({ parts = {}, size = 0 }, Layout), 0
  for _, part in ipairs(parts) do
    self.parts[part[1]] = { first, part[2] }
    first = first + part[2]
  end
  self.order, self.size = parts, first
  return self
end

function Layout:get(y, name)
  local part, out = self.parts[name], {}
  for i = 1, part[2] do out[i] = y[part[1] + i] end
  return out
end

function Layout:pack(values)
  local out = {}
  for _, part in ipairs(self.order) do
    local list = values[part[1]]
    for i = 1, part[2] do out[#out + 1] = list[i] end
  end
  return core.vector(out)
end
M.Layout = Layout

-- X and mu of the unknowns x = (X - ahead(list), mu)
local function unknowns(p, list, x)
  local X, mu = {}, {}
  local base = ahead(list)
  for i = 1, p.d do X[i] = base[i] + x[i] end
  for c = 1, p.constraints do mu[c] = x[p.d + c] end
  return core.vector(X), mu
end

-- the window of a state; entries that the section fixes are numbers
local function window_of(p, layout, y)
  local U = blocks(layout:get(y, "U"), p.window, p.d)
  for j, z in ipairs(U) do
    local out = {}
    for a = 1, p.d do out[a] = p.fixed[j] and p.fixed[j][a] or z[a] end
    U[j] = core.vector(out)
  end
  return U
end

---- after the step, in both forms: move the window, multiply the frame up, recover a point ----

local function renewed(p, step, values, list)
  local layout, y, x = step.layout, step.y, step.x
  local P = p.rho(list)
  local U = window_of(p, layout, y)
  local window = p.move(P, list)
  local g = p.group:compose(P, p.group:unflat(layout:get(y, "g")))
  values.U, values.g = numbers(window), points.entries(p.group:flat(g))
  values.u = points.entries(p.act(p.group:inverse(g), window[1]))
  values.x1, values.x2 = points.entries(x), layout:get(y, "x1")
  local all = part(U, p.window - p.N + 2, p.N - 1)
  all[p.N] = unknowns(p, U, x)
  values.I = p.named(all)
  return P, window
end

-- where Newton's method begins: what the last two sites found, seen each from its own window
local function guess(p, layout)
  return function(y)
    local a, b, out = layout:get(y, "x1"), layout:get(y, "x2"), {}
    for i = 1, p.d + p.constraints do out[i] = 2 * a[i] - b[i] end
    return out
  end
end

-- sizes of what the unknowns are added to
local function scale(p, layout)
  return function(y)
    local base, out = ahead(window_of(p, layout, y)), {}
    for a = 1, p.d do out[a] = base[a] end
    for c = 1, p.constraints do out[p.d + c] = 0 end
    return out
  end
end

local function inside_of(p, layout)
  if not p.inside then return nil end
  return function(y, x)
    local U = window_of(p, layout, y)
    local list = part(U, p.window - p.N + 2, p.N - 1)
    list[p.N] = unknowns(p, U, x)
    return points.entries(p.inside(p.invariants_of(list)))
  end
end

local function common_parts(p)
  return { { "x1", p.d + p.constraints }, { "x2", p.d + p.constraints },
    { "g", p.flat_size }, { "u", p.d },
    { "I", #p.names } }
end

---- the form of points ----

-- E at the middle of 2 N - 1 points; mu[k] of the site k, for the sites that reach the middle
local function middle(p, list, mu)
  local N, d, out = p.N, p.d, {}
  for a = 1, d do out[a] = 0 end
  for site = 1, N do
    local g = slopes(p, part(list, site, N), mu[site])[N - site + 1]
    for a = 1, d do out[a] = out[a] + g[a] end
  end
  return out
end
M.middle = middle

function M.points_form(p)
  p.window = math.max(2 * p.N - 2, p.k)
  local kept = math.max(p.reach - 1, 0) * p.constraints
  local parts = { { "U", p.window * p.d }, { "history", kept } }
  for _, row in ipairs(common_parts(p)) do parts[#parts + 1] = row end
  local layout, N, c = Layout.new(parts), p.N, p.constraints
  local function read(y, x)
    local U = window_of(p, layout, y)
    local X, last = unknowns(p, U, x)
    local list, history, mu = part(U, p.window - 2 * N + 3, 2 * N - 2), layout:get(y, "history"), {}
    list[2 * N - 1] = X
    for j = 1, c > 0 and p.reach - 1 or 0 do
      mu[N - p.reach + j] = part(history, (j - 1) * c + 1, c)
    end
    if c > 0 then mu[N] = last end
    return list, mu, U, X
  end
  local function equation(y, x)
    local list, mu = read(y, x)
    local out = middle(p, list, mu)
    for _, value in ipairs(constraint_at_end(p, list)) do out[#out + 1] = value end
    return out
  end
  local function next_state(y, x)
    local _, mu, U, X = read(y, x)
    local values, list = { history = {} }, part(U, 2, p.window - 1)
    list[p.window] = X
    for j = 2, c > 0 and p.reach or 0 do
      for i = 1, c do values.history[#values.history + 1] = mu[N - p.reach + j][i] end
    end
    renewed(p, { layout = layout, y = y, x = x }, values, list)
    return layout:pack(values)
  end
  return { layout = layout, equation = equation, next = next_state, start = guess(p, layout),
    scale = scale(p, layout),
    inside = inside_of(p, layout), core = { "U", "history" } }
end

---- the form of momenta ----

-- the covectors from J and the entries kept beside it: psi_P^T m_P = J - psi_S^T m_S
local function covectors(p, window, J, kept)
  local psi, m, right, A = psi_rows(p, window), {}, {}, {}
  for k, i in ipairs(p.others) do m[i] = kept[k] end
  for j = 1, p.r do
    right[j], A[j] = J[j], {}
    for _, i in ipairs(p.others) do right[j] = right[j] - psi[i][j] * m[i] end
    for k, i in ipairs(p.pivots) do A[j][k] = psi[i][j] end
  end
  local solved = core.matrix(A):solve(core.vector(right))
  for k, i in ipairs(p.pivots) do m[i] = solved[k] end
  return blocks(m, #window, p.d)
end

-- covectors seen after the points moved by P: (T Psi_P)^-T m = (T Psi_{P^-1} at the new points)^T m
local function carried(p, P, window, m)
  local inverse, out = points.entries(p.group:flat(p.group:inverse(P))), {}
  for j, z in ipairs(window) do
    if m[j] then
      local D, v = p.motion(core.vector(inverse), z), {}
      for a = 1, p.d do
        v[a] = 0
        for b = 1, p.d do v[a] = v[a] + D[b][p.flat_size + a] * m[j][b] end
      end
      out[j] = core.vector(v)
    end
  end
  return out
end
M.carried = carried

-- J after a motion by P: J(Ad_{P^-1} xi)
local function coadjoint(p, P, J)
  local inverse, out = p.group:inverse(P), {}
  for j = 1, p.r do
    local xi = {}
    for i = 1, p.r do xi[i] = i == j and 1 or 0 end
    local eta = points.entries(p.group:Ad(inverse, core.vector(xi)))
    out[j] = 0
    for i = 1, p.r do out[j] = out[j] + J[i] * eta[i] end
  end
  return out
end
M.coadjoint = coadjoint

--- What the covectors m of a normalized window are kept as.
function M.kept_momentum(p, window, m)
  local flat = numbers(m)
  if not p.reduced then return flat end
  local psi, out = psi_rows(p, window), {}
  for j = 1, p.r do
    out[j] = 0
    for i = 1, #flat do out[j] = out[j] + psi[i][j] * flat[i] end
  end
  for _, i in ipairs(p.others) do out[#out + 1] = flat[i] end
  return out
end

-- the points of L's window that are known, and the covectors at them
local function known(p, layout, y)
  local U = window_of(p, layout, y)
  local list, mom = part(U, p.window - p.N + 2, p.N - 1), layout:get(y, "momentum")
  if not p.reduced then return U, list, blocks(mom, p.N - 1, p.d) end
  return U, list, covectors(p, list, mom, part(mom, p.r + 1, #mom - p.r))
end

function M.momentum_form(p)
  p.window = math.max(p.N - 1, p.k)
  local D = (p.N - 1) * p.d
  local parts = { { "U", p.window * p.d }, { "momentum", D } }
  for _, row in ipairs(common_parts(p)) do parts[#parts + 1] = row end
  local layout = Layout.new(parts)
  local function equation(y, x)
    local U, list, m = known(p, layout, y)
    local X, mu = unknowns(p, U, x)
    list[p.N] = X
    local g, out = slopes(p, list, mu, p.window == p.N - 1)[1], {}
    for a = 1, p.d do out[a] = m[1][a] + g[a] end
    U[#U + 1] = X
    for _, value in ipairs(constraint_at_end(p, U)) do out[#out + 1] = value end
    return out
  end
  local function next_state(y, x)
    local U, list, m = known(p, layout, y)
    local X, mu = unknowns(p, U, x)
    list[p.N] = X
    local g, left, all = slopes(p, list, mu, p.window == p.N - 1), {}, part(U, 2, p.window - 1)
    for j = 1, p.N - 1 do left[j] = m[j + 1] and m[j + 1] + g[j + 1] or g[j + 1] end
    all[p.window] = X
    local values = {}
    local P, window = renewed(p, { layout = layout, y = y, x = x }, values, all)
    local there = part(window, p.window - p.N + 2, p.N - 1)
    left = carried(p, P, there, left)
    values.momentum = numbers(left)
    if p.reduced then
      local flat = values.momentum
      values.momentum = coadjoint(p, P, layout:get(y, "momentum"))
      for _, i in ipairs(p.others) do values.momentum[#values.momentum + 1] = flat[i] end
    end
    return layout:pack(values)
  end
  return { layout = layout, equation = equation, next = next_state, start = guess(p, layout),
    scale = scale(p, layout),
    inside = inside_of(p, layout), core = { "U", "momentum" } }
end

return M
