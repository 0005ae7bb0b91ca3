--- Where a reduced run fails, or has jumped over what it could not cross: named by what happens to the locked inertia and to the mass of the shape.
-- A shape at which the group does not act freely (r = 0, all rods vertical) has a singular locked inertia: with mu it is behind a wall of
-- V_mu, which a step that is too long may jump; a pole or an edge of the coordinates makes the mass d2R/dx'2 singular or infinite.
local core = require "dm.core"
local routh = require "dm.routh"

local M = {}

local abs, min, max = math.abs, math.min, math.max

local function zeros(n)
  local out = {}
  for i = 1, n do out[i] = 0 end
  return core.vector(out)
end

-- least and largest characteristic value of the locked inertia at x, or nothing outside of the domain
local function inertia(shape, x, t)
  local fine, re = pcall(function() return (shape:locked_inertia(x, t):eigenvalues()) end)
  if not fine then return nil end
  local least = math.huge
  for i = 1, #re do least = min(least, re[i]) end
  return least
end

-- the diagonal of the mass of the shape
local function masses(shape, x, t)
  local fine, G = pcall(function() return shape:mass(x, zeros(#x), t) end)
  return fine and G or nil
end

local WAY = "; with constraint = in coordinates without such a place, system:routh { action = ... } reduces it too"

local LOW, FAR = 0.02, 50  -- of the value at the start

-- code and sentence for the state (x, t), next to the start; nothing where all looks regular
local function reason(shape, info, x, t, x0, t0)
  local least, before = inertia(shape, x, t), inertia(shape, x0, t0)
  if least and before and least < LOW * before then
    return "collapse", ("the locked inertia has fallen from %.3g to %.3g: the shape comes near one at which the group does not act freely (r = 0), behind a "
      .. "centrifugal wall as narrow as the momentum is small; take smaller steps there, or no reduction"):format(before, least)
  end
  local G, G0 = masses(shape, x, t), masses(shape, x0, t0)
  for i = 1, G and G0 and info.d or 0 do
    local name, ratio = info.names[info.shape[i]], abs(G[i][i] / G0[i][i])
    if not (ratio <= FAR) then
      return "edge", ("the inertia of '%s' has grown %.0f-fold at %s = %.6g: an edge of these coordinates%s"):format(name, ratio, name, x[i], WAY)
    elseif ratio < LOW then
      return "pole", ("the inertia of '%s' has fallen %.0f-fold: a pole of these coordinates, where it has no meaning%s"):format(name, 1 / ratio, WAY)
    end
  end
end

-- does the straight line from x leave the domain of L within a step?
local function leaves(shape, info, x, v, t, h)
  for _, part in ipairs { 0.5, 1 } do
    local y, fine, value = {}, nil, nil
    for j = 1, info.d do y[j] = x[j] + part * h * v[j] end
    fine, value = pcall(shape.lagrangian, shape, y, v, t)
    if not fine then
      local worst, name = 0, nil
      for j = 1, info.d do
        local z = { table.unpack(core.vector(x):totable()) }
        z[j] = y[j]
        if not pcall(shape.lagrangian, shape, z, v, t) and abs(v[j]) > worst then worst, name = abs(v[j]), info.names[info.shape[j]] end
      end
      return "edge", ("the next step would leave the domain of L%s%s"):format(name and (" by '%s'"):format(name) or "", WAY), value
    end
  end
end

-- adds reason and a sentence to a failure whose path has rows
local function explain(shape, info, failure)
  local path = failure.path
  if not path or path.watched or #path < 1 or failure.code == "stopped" then return end
  local n = #path
  local x, t = path.q[n], path.t[n]
  local fine, code, why = pcall(reason, shape, info, x, t, path.q[1], path.t[1])
  if not fine or not code then
    local known, v = pcall(function() return shape:velocity(x, path.p[n], t) end)
    if known then code, why = leaves(shape, info, x, v, t, path.h) end
  end
  if fine and code then
    failure.reason = code
    failure.message = ("%s (%s)"):format(failure.message, why)
  end
end

---- jumps ----

local SUSPECT, DEEP = 0.02, 0.25

-- has the energy of an autonomous, free run been left? Only where every step was kept: between rows that are further apart a deep dip is no jump.
local function is_suspect(path, info)
  local pushed = 0
  for a = 1, info.m do pushed = max(pushed, abs(info.mu[a])) end
  if pushed == 0 then return false end  -- without momentum there is no wall
  if path.watched or #path < 2 or #path < path.steps + 1 or info.full.given.force then return false end
  if not pcall(routh.steady, info, "energy") then return false end
  local fine, E = pcall(path.energy, path)
  if not fine then return false end
  local scale = abs(E[1])
  for i = 1, #E do
    if not (abs(E[i] - E[1]) <= SUSPECT * max(scale, 1e-300)) then return true end
  end
  return false
end

-- the first row to which a step jumped through a shape with a much smaller locked inertia than either end has
local function jump(path, shape)
  local before = inertia(shape, path.q[1], path.t[1])
  for i = 2, #path do
    local a, b, t = path.q[i - 1], path.q[i], path.t[i]
    local now = inertia(shape, b, t)
    if before and now then
      for _, part in ipairs { 0.25, 0.5, 0.75 } do
        local between = inertia(shape, (1 - part) * a + part * b, t)
        if between and between < DEEP * min(before, now) then return i end
      end
    end
    before = now
  end
end

-- the first rows of a path
local function head(path, rows)
  local columns = {}
  for c, name in ipairs(path.columns) do
    local all = path:column(name)
    columns[c] = {}
    for i = 1, rows do columns[c][i] = all[i] end
  end
  return core.path { system = path.system, h = path.h, rule = path.rule, steps = rows - 1, columns = columns }
end

local function raise_jump(path, row)
  local step = math.floor((path.t[row] - path.t[1]) / path.h + 0.5)
  local failure = { code = "collapse", reason = "collapse", step = step, time = path.t[row - 1], rule = path.rule, path = head(path, row - 1),
    message = ("%s: step %d (t = %.6g) jumped through a shape at which the locked inertia vanishes (r = 0), which the momentum forbids: "
      .. "take smaller steps near it; the path up to there is in failure.path"):format(path.rule, step, path.t[row - 1]) }
  error(setmetatable(failure, debug.getregistry()["dm.failure"]), 0)
end

--- solver:run of a reduced system; plain is the method without this. Positions are put in front by blame.
function M.run(plain, solver, options)
  local shape = solver.system
  local info = routh.info(shape)
  local fine, path = pcall(plain, solver, options)
  if not fine and type(path) == "string" then
    local unreduced = path:find(("must have %d entries (got %d)"):format(info.d, info.n), 1, true)
    error(unreduced and path .. ": this system is reduced, and shape:start(q, v) gives the start below an unreduced one" or path, 0)
  end
  local failure = not fine and type(path) == "table" and path.message and path
  if not fine and not failure then error(path, 0) end
  if failure then path = failure.path end
  local row = path and is_suspect(path, info) and jump(path, shape)
  if row then raise_jump(path, row) end
  if failure then
    explain(shape, info, failure)
    error(failure, 0)
  end
  return path
end

return M
