--- Starts of invariant problems: the first state y from given points, or from a frame and a
-- momentum.
local blame = require "dm.base.blame"
local core = require "dm.core"
local linear = require "dm.base.linear"
local equations = require "dm.frame.invariant_equations"
local frames = require "dm.frame"
local points = require "dm.frame.points"
local windows = require "dm.frame.invariant_windows"

local M = {}


local part = windows.part

---- multipliers that the given points imply ----

-- the shortest x with the least |A x - b|, by singular values
local function least_squares(A, b)
  local m, x = core.matrix(A), core.zeros(#A[1])
  local values, vectors = linear.singular_values(m)
  local most = math.max(table.unpack(values))
  for k, v in ipairs(vectors) do
    if values[k] > 1e-9 * most then x = x + v * ((m * v):dot(core.vector(b)) / values[k] ^ 2) end
  end
  return x
end

-- sites whose multipliers reach the middle e of 2 N - 1 points (in points of the list, from 1)
local function reaching(p, e) return e - p.reach + 1, e end

-- each point more brings d equations and the multipliers of one site
local function too_few(p, equations_there, unknowns, count)
  local N, gain = p.N, p.d - p.constraints
  local more = gain > 0 and ("starts from %d points, or "):format(
    math.max(count, 2 * N - 2) + math.ceil((unknowns - equations_there) / gain)) or "starts "
  error(("a constrained problem of %d points %sfrom %d with their `multiplier`s (%d points give "
    .. "%d equations for %d multipliers)")
    :format(N, more, 2 * N - 2, count, equations_there, unknowns), 0)
end

-- multipliers by site, from E = 0 at every site that has all its points
local function multipliers(p, list, given)
  local out, N, c = {}, p.N, p.constraints
  if c == 0 then return out end
  local last = #list - N + 1 -- the last site with a window of L
  if given then
    for k, mu in ipairs(given) do
      out[last - #given + k] = type(mu) == "number" and { mu } or points.entries(mu)
    end
    return out
  end
  local first_site = N - p.reach + 1
  local rows, right = {}, {}
  for e = N, #list - N + 1 do
    local window = part(list, e - N + 1, 2 * N - 1)
    local E = equations.middle(p, window, {})
    for a = 1, p.d do
      local row = {}
      for j = 1, (last - first_site + 1) * c do row[j] = 0 end
      for s = reaching(p, e), e do
        local _, phi = windows.slopes_apart(p, part(list, s, N))
        for i = 1, c do row[(s - first_site) * c + i] = phi[i][(e - s) * p.d + a] end
      end
      rows[#rows + 1], right[#right + 1] = row, E[a]
    end
  end
  if #rows < (last - first_site + 1) * c then
    too_few(p, #rows, (last - first_site + 1) * c, #list)
  end
  local mu = least_squares(rows, right)
  for s = first_site, last do
    out[s] = {}
    for i = 1, c do out[s][i] = mu[(s - first_site) * c + i] end
  end
  return out
end

---- what the sites before leave at the last N - 1 points ----

-- covectors at the points first .. first + N - 2 of the list, from the sites before `first`
local function left_over(p, list, first, mu)
  local m = {}
  for j = 1, p.N - 1 do
    local sum = {}
    for a = 1, p.d do sum[a] = 0 end
    for s = first + j - p.N, first - 1 do
      local g = windows.slopes(p, part(list, s, p.N), mu[s])[first + j - s]
      for a = 1, p.d do sum[a] = sum[a] + g[a] end
    end
    m[j] = core.vector(sum)
  end
  return m
end
M.left_over = left_over

--- J of the momenta at points as they are given: <J, e_j> = sum m . v_j(u).
function M.spatial(p, list, multiplier)
  local mu = multipliers(p, list, multiplier)
  local first = #list - p.N + 2
  local m, psi, out = windows.numbers(left_over(p, list, first, mu)),
    windows.psi_rows(p, part(list, first, p.N - 1)), {}
  for j = 1, p.r do
    out[j] = 0
    for i = 1, #m do out[j] = out[j] + psi[i][j] * m[i] end
  end
  return core.vector(out)
end

---- the first state ----

-- values that every form begins with: the window at its frame
local function begin(p, window, g)
  local x, n = {}, #window
  for i = 1, p.d + p.constraints do
    -- on the parabola of the last three: on a line frames and slopes may be singular
    x[i] = n > 2 and i <= p.d and window[n][i] - 2 * window[n - 1][i] + window[n - 2][i] or 0
  end
  local named = {}
  for i = 1, #p.names do named[i] = 0 end
  return { U = windows.numbers(window), g = points.entries(p.group:flat(g)), x1 = x,
    x2 = x, I = named,
    u = points.entries(p.act(p.group:inverse(g), window[1])) }
end

-- a guess of the next normalized point by what the last site found
local function better_guess(p, values, list, mu)
  local fine, seen = blame.try(function()
    local before = part(list, #list - p.window, p.window + 1)
    return p.move(p.rho(before), before)
  end)
  if not fine or #list <= p.window then return end
  local found = table.remove(seen)
  local x = points.entries(found - windows.ahead(seen))
  local known = mu[#list - p.N + 1]
  for i = 1, p.constraints do x[p.d + i] = known and known[i] or 0 end
  values.x1, values.x2 = x, x
end

-- the choice of entries kept beside J needs a window
local function choose(p, window)
  if not p.may_reduce then return end
  p.pivots, p.others = linear.choose_rows(windows.psi_rows(p, window), p.r)
  p.reduced = p.pivots ~= nil
end
M.choose = choose

--- State after the given points; the points that lie before it.
function M.from_points(p, form, list, multiplier)
  local N = p.N
  if #list < 2 * N - 2 then
    error(("this problem of %d points starts from %d points (got %d)")
      :format(N, 2 * N - 2, #list), 0)
  end
  local mu = multipliers(p, list, multiplier)
  local first = #list - p.window + 1
  if first < 1 then
    error(("the frame needs %d points to start from (got %d)"):format(p.window, #list), 0)
  end
  local window = part(list, first, p.window)
  local g = p.rho(window)
  local there = p.move(g, window)
  choose(p, part(there, p.window - N + 2, N - 1))
  local values = begin(p, there, g)
  better_guess(p, values, list, mu)
  if form == "points" then
    values.history = {}
    for s = #list - N + 3 - p.reach, #list - N + 1 do
      for i = 1, p.reach > 1 and p.constraints or 0 do
        values.history[#values.history + 1] = mu[s][i]
      end
    end
  else
    local m = left_over(p, list, #list - N + 2, mu)
    values.momentum = equations.kept_momentum(p, part(there, p.window - N + 2, N - 1),
      equations.carried(p, g, part(there, p.window - N + 2, N - 1), m))
  end
  return values, part(list, 1, first - 1)
end

--- State from the momentum J (as seen from where the points are) and either the window's points or
-- its frame and normalized points.
function M.from_momentum(p, o)
  if not p.may_reduce or (p.N - 1) * p.d ~= p.r then
    error(("a start from `momentum` needs a window of %d numbers that the section fixes: dim G = "
      .. "%d here; give %d points")
      :format((p.N - 1) * p.d, p.r, 2 * p.N - 2), 0)
  end
  local g, there = o.frame, nil
  if g then
    there = p.section_points()
  else
    local window = frames.list(o.points, p.d, "with `momentum`, give the first points or a `frame`")
    if #window ~= p.N - 1 then
      error(("with `momentum`, give %d points (got %d)"):format(p.N - 1, #window), 0)
    end
    g = p.rho(window)
    there = p.move(g, window)
  end
  choose(p, there)
  if not p.reduced then
    error("the generators are dependent at the section: this problem starts from points", 0)
  end
  local values = begin(p, there, g)
  local J = points.entries(o.momentum or o.body_momentum)
  if #J ~= p.r then error(("a momentum has dim G = %d entries (got %d)"):format(p.r, #J), 0) end
  values.momentum = o.momentum and equations.coadjoint(p, g, J) or J
  return values, {}
end

return M
