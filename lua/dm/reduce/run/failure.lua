--- Where a reduced run fails, or has jumped over what it could not cross: named by what happens to
-- the locked inertia and to the mass of the shape. A shape at which the group does not act freely
-- (r = 0, all rods vertical) has a singular locked inertia: with mu it is behind a wall of V_mu,
-- which a step that is too long may jump; a pole or an edge of the coordinates makes the mass
-- d2R/dx'2 singular or infinite.
local core = require "dm.core"
local jumps = require "dm.reduce.run.jump"
local routh = require "dm.reduce.routh"

local M = {}

local abs, min, max = math.abs, math.min, math.max

-- least and largest characteristic value of the locked inertia at x, or nothing outside of the
-- domain
local function inertia(shape, x, t)
  local fine, re = pcall(function() return (shape:locked_inertia(x, t):eigenvalues()) end)
  if not fine then return nil end
  local least = math.huge
  for i = 1, #re do least = min(least, re[i]) end
  return least
end

local WAY = "; with constraint = in coordinates without such a place, "
  .. "system:routh { action = ... } reduces it too"
local SECTION = "; take another section there, or leave 'section' out for one that is regular "
  .. "wherever the group acts freely"

-- what to do at a pole or an edge
local function way(info) return info.ambient and info.ambient.given and SECTION or WAY end

local LOW, FAR = 0.02, 50  -- of the value at the start

-- code and sentence for the state (x, t), next to the start; nothing where all looks regular
local function reason(path, info, x, t, x0, t0)
  local shape = path.system
  local least, before = inertia(shape, x, t), inertia(shape, x0, t0)
  if least and before and least < LOW * before then
    return "collapse", ("the locked inertia has fallen from %.3g to %.3g: the shape comes near "
      .. "one at which the group does not act freely (r = 0), behind a centrifugal wall as narrow "
      .. "as the momentum is small; take smaller steps there, or no reduction")
      :format(before, least)
  end
  local G, G0 = jumps.mass(path, x, t), jumps.mass(path, x0, t0)
  for i = 1, G and G0 and info.d or 0 do
    local name, ratio = info.own[i], abs(G[i][i] / G0[i][i])
    if not (ratio <= FAR) then
      return "edge", ("the inertia of '%s' has grown %.0f-fold at %s = %.6g: an edge of these "
        .. "coordinates%s"):format(name, ratio, name, x[i], way(info))
    elseif ratio < LOW then
      return "pole", ("the inertia of '%s' has fallen %.0f-fold: a pole of these coordinates, "
        .. "where it has no meaning%s"):format(name, 1 / ratio, way(info))
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
        if not pcall(shape.lagrangian, shape, z, v, t) and abs(v[j]) > worst then
          worst, name = abs(v[j]), info.own[j]
        end
      end
      return "edge", ("the next step would leave the domain of L%s%s")
        :format(name and (" by '%s'"):format(name) or "", way(info)), value
    end
  end
end

local POLE = "the mass of the shape vanishes along '%s' at %s: a pole of these coordinates, "
  .. "behind which they have no points%s"

-- a shape where the mass is singular, with the coordinate whose inertia is the least there beside
-- what it is at x
local function vanishing(path, info, where, x, t)
  local G, G0, least, best = jumps.mass(path, where, t), jumps.mass(path, x, t), math.huge, 1
  for i = 1, G and G0 and info.d or 0 do
    local ratio = abs(G[i][i] / G0[i][i])
    if ratio < least then least, best = ratio, i end
  end
  local place = {}
  for i, name in ipairs(info.own) do place[i] = ("%s = %.3g"):format(name, where[i]) end
  return POLE:format(info.own[best], table.concat(place, ", "), way(info))
end

-- what is wrong in the last rows
local function behind(info, path)
  local n = #path
  for i = n, max(2, n - 3), -1 do
    local where = #path >= path.steps + 1 and jumps.over(path, i, math.huge)
    if where then
      return "pole", vanishing(path, info, where, path.q[i - 1], path.t[i])
    end
  end
end

local AHEAD, PARTS = 2, 32  -- steps that the line ahead is followed

-- what the last row heads for
local function ahead(info, path, v)
  local n = #path
  local x, t = path.q[n], path.t[n]
  for k = 1, PARTS do
    local code, why = reason(path, info, x + AHEAD * path.h * k / PARTS * v, t, path.q[1],
      path.t[1])
    if code then return code, "the last row heads for such a place: " .. why end
  end
  local where = jumps.singular(path, x, x + AHEAD * path.h * v, t)
  if where then
    return "pole", "the last row heads for such a place: " .. vanishing(path, info, where, x, t)
  end
end

local function reason_of(shape, info, path)
  local n = #path
  local x, t = path.q[n], path.t[n]
  local code, why = reason(path, info, x, t, path.q[1], path.t[1])
  local known, v = pcall(path.velocity, path, n)
  if not code and known then code, why = leaves(shape, info, x, v, t, path.h) end
  if not code and known then code, why = ahead(info, path, v) end
  if not code then code, why = behind(info, path) end
  return code, why
end

-- adds reason and a sentence to a failure whose path has rows
local function explain(shape, info, failure)
  local path = failure.path
  if not path or path.watched or #path < 1 or failure.code == "stopped" then return end
  local fine, code, why = pcall(reason_of, shape, info, path)
  if fine and code then
    failure.reason = code
    failure.message = ("%s (%s)"):format(failure.message, why)
  end
end

---- jumps ----

local SUSPECT, DEEP = 0.02, 0.25

-- has the energy of an autonomous, free run been left? Only where every step was kept: between rows
-- that are further apart a deep dip is no jump.
local function is_suspect(path, info)
  local pushed = 0
  for a = 1, info.m do pushed = max(pushed, abs(info.mu[a])) end
  if pushed == 0 then return false end  -- without momentum there is no wall
  if path.watched or #path < 2 or #path < path.steps + 1 or info.full.given.force then
    return false
  end
  if not routh.is_autonomous(info) then return false end
  local fine, E = pcall(path.energy, path)
  if not fine then return false end
  local scale = abs(E[1])
  for i = 1, #E do
    if not (abs(E[i] - E[1]) <= SUSPECT * max(scale, 1e-300)) then return true end
  end
  return false
end

-- the first row to which a step jumped through a shape with a much smaller locked inertia than
-- either end has
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
  return core.path { system = path.system, h = path.h, rule = path.rule, steps = rows - 1,
    columns = columns }
end

local function raise(path, row, code, why)
  local step = math.floor((path.t[row] - path.t[1]) / path.h + 0.5)
  local first = math.floor((path.t[row - 1] - path.t[1]) / path.h + 0.5) + 1
  local which = step > first and ("one of the steps %d to %d (from t = %.6g on)")
    :format(first, step, path.t[row - 1])
    or ("step %d (t = %.6g)"):format(step, path.t[row - 1])
  local failure = { code = code, reason = code, step = step, time = path.t[row - 1],
    rule = path.rule, path = head(path, row - 1),
    message = ("%s: %s %s; the path up to there is in failure.path"):format(path.rule, which, why) }
  error(setmetatable(failure, debug.getregistry()["dm.failure"]), 0)
end

local FORBIDDEN = "jumped through a shape at which the locked inertia vanishes (r = 0), which "
  .. "the momentum forbids: take smaller steps near it"

local LOST = 1  -- of the energy's size: no more than the sign of it is left
-- the size is looked at again that much later; rows that are looked at in any case
local AGAIN, FEW = 1.2, 9

-- the first row at which the energy is off by more than its size, at a place that says why: its
-- row, code and sentence; `whole` is the path that begins with the start
local function lost(path, shape, info, whole)
  if path.watched or info.full.given.force or not routh.is_autonomous(info) then return nil end
  local E = path:energy()
  local q, t = whole.q[1], whole.t[1]
  local first = (whole == path and E or whole:energy())[1]
  local size, known = abs(first), 0
  for i = 2, #E do
    local off = abs(E[i] - first)
    -- from rows before this one: behind a wall all energies are large. Not for every row of a start
    -- at rest
    if not (off <= LOST * size) and i > AGAIN * known then
      size, known = max(size, jumps.energy_size(path, first, max(i - 1, min(#E, FEW)))), i
    end
    if not (off <= LOST * size) then
      for row = i, i - 1, -1 do
        local code, why = reason(path, info, path.q[row], path.t[row], q, t)
        if code then return i, code, why end
      end
      local code, why = reason_of(shape, info, head(path, i - 1))
      return code and i, code, why
    end
  end
end

local OVER, LEFT = "jumped over a pole: ", "left its energy: "

-- the first row behind a place that no motion crosses, the code and a sentence; run(options) steps
-- again
local function wrong(path, shape, info, run)
  local row = is_suspect(path, info) and jump(path, shape)
  if row then return row, "collapse", FORBIDDEN end
  local where, code, why
  row, where, code, why = jumps.find(path, info, run, function(dense)
    if is_suspect(dense, info) and jump(dense, shape) then return "collapse", FORBIDDEN end
    local there, what, sentence = lost(dense, shape, info, path)
    return there and what, there and LEFT .. sentence
  end)
  if where then
    return row, "pole", OVER .. vanishing(path, info, where, path.q[row - 1], path.t[row - 1])
  end
  if row then return row, code, why end
  row, code, why = lost(path, shape, info, path)
  return row, code, row and LEFT .. why
end

-- raises for such a path; a run that failed at an edge keeps that reason, with what was wrong
-- before
local function look(path, shape, info, run, failure)
  local fine, row, code, why = pcall(wrong, path, shape, info, run)
  if failure then explain(shape, info, failure) end
  if not fine or not row then return end
  if not failure or failure.reason ~= "edge" then raise(path, row, code, why) end
  failure.message = ("%s; before that step %d %s")
    :format(failure.message, math.floor((path.t[row] - path.t[1]) / path.h + 0.5), why)
end

--- solver:run of a reduced system; plain is the method without this. Positions are put in front by
-- blame.
function M.run(plain, solver, options)
  local shape = solver.system
  local info = routh.info(shape)
  local fine, path = pcall(plain, solver, options)
  if not fine and type(path) == "string" then
    local unreduced = path:find(("must have %d entries (got %d)"):format(info.d, info.n), 1, true)
    error(unreduced and path
      .. ": this system is reduced, and shape:start(q, v) gives the start below an unreduced one"
      or path, 0)
  end
  local failure = not fine and type(path) == "table" and path.message and path
  if not fine and not failure then error(path, 0) end
  if failure then path = failure.path end
  if path then
    look(path, shape, info, function(again)
      again.project = options.project
      return plain(solver, again)
    end, failure)
  end
  if failure then error(failure, 0) end
  return path
end

return M
