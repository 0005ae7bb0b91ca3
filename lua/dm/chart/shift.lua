--- By how much time a run is ahead of its flow, and how far a group has turned it: the shift of the
-- flow, and the element of the group, that fit a stretch of the run best, followed from the start,
-- where nothing is shifted.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local abs, max, min, floor = math.abs, math.max, math.min, math.floor

-- stretches of the run: longer ones for turns, which a part of an orbit tells badly, none shorter
-- than a swing, where an error of the amplitude looks like a shift; the least and the most rows of
-- each
local WINDOWS, FEWER, FEWEST, ROWS = 32, 8, 8, 64
local NODES = 8               -- rows of the flow that a polynomial goes through
local TRIES = 8               -- of Gauss and Newton,
local FOUND = 1e-9            -- of a window or a turn: increments that change nothing more
local KNOWN = 0.5             -- of the size of a signal: what a shift must explain to be one

-- 1/prod_{j /= i} (i - j) for i = 0 .. nodes - 1: what Lagrange's polynomials of these nodes have
-- in front
local function scales(nodes)
  local out = {}
  for i = 0, nodes - 1 do
    local product = 1
    for j = 0, nodes - 1 do product = j == i and product or product * (i - j) end
    out[i] = 1 / product
  end
  return out
end

-- Lagrange's polynomials of the nodes 0, 1, ... at s and their derivatives, to the lists w, slope:
-- the product of s - j before each node, times that behind it
local function lagrange(s, scale, w, slope)
  local product, rate = 1, 0
  for i = 0, #scale do
    w[i], slope[i] = product, rate
    product, rate = product * (s - i), rate * (s - i) + product
  end
  product, rate = 1, 0
  for i = #scale, 0, -1 do
    w[i], slope[i] = w[i] * product * scale[i],
      (slope[i] * product + w[i] * rate) * scale[i]
    product, rate = product * (s - i), rate * (s - i) + product
  end
end

--- read(time) -> values, rates of columns whose rows lie at even times t; the last of these.
function M.reader(t, columns)
  local count, t0 = #t, t[1]
  local dt, nodes = (t[count] - t0) / (count - 1), min(NODES, count)
  local scale, w, slope = scales(nodes), {}, {}
  return function(time)
    local place = (time - t0) / dt
    local first = floor(max(0, min(count - nodes, floor(place) - nodes // 2 + 1)))
    local y, rate = {}, {}
    lagrange(place - first, scale, w, slope)
    for k, list in ipairs(columns) do
      local value, along = 0, 0
      for i = 0, nodes - 1 do
        local x = list[first + i + 1]
        value, along = value + w[i] * x, along + slope[i] * x
      end
      y[k], rate[k] = value, along / dt
    end
    return y, rate
  end, t[count]
end

-- rows of a run in the times (from, to]
local function window_of(run, from, to)
  local t, w = run.t, { t = {}, y = {}, mean = {}, middle = 0.5 * (from + to) }
  local first, count = run.next or 1, #t
  while first <= count and t[first] <= from do first = first + 1 end
  local final = first
  while final < count and t[final + 1] <= to do final = final + 1 end
  run.next = final
  local stride = max(1, (final - first) // ROWS)
  for i = first, min(final, count), stride do
    local y = {}
    for k, list in ipairs(run.columns) do
      y[k] = list[i]
      w.mean[k] = (w.mean[k] or 0) + y[k]
    end
    w.t[#w.t + 1], w.y[#w.y + 1] = t[i], y
  end
  for k in ipairs(run.columns) do w.mean[k] = w.mean[k] / max(1, #w.t) end
  return w
end

-- adds the row of one observed number to normal equations S x = r, to the lower triangle of S
local function add_row(S, r, slopes, miss)
  for i = 1, #slopes do
    local a, row = slopes[i], S[i]
    r[i] = r[i] + a * miss
    for j = 1, i do row[j] = row[j] + a * slopes[j] end
  end
end

local function equations(size)
  local S, r = {}, {}
  for i = 1, size do
    S[i], r[i] = {}, 0
    for j = 1, size do S[i][j] = 0 end
  end
  return S, r
end

-- The increments of shift, its rate and the turns that make a window fit better; also what is left
-- of the squares, and their sum. at: { a, b, turn }
local function improve(w, flow, at)
  local turns = flow.turns or {}
  local S, r = equations(2 + #turns)
  local left, all, used, slopes = 0, 0, 0, {}
  for i, t in ipairs(w.t) do
    local x = t - w.middle
    local time = t + at.a + at.b * x
    if time <= flow.last and time >= flow.first then
      local y, rate = flow.read(time)
      if at.turn then y, rate = at.turn(y), at.turn(rate, true) end
      local moved = {}
      for g, along in ipairs(turns) do moved[g] = along(y) end
      used = used + 1
      for k = 1, #y do
        local size = flow.range[k]
        local miss = (w.y[i][k] - y[k]) / size
        slopes[1], slopes[2] = rate[k] / size, rate[k] / size * x
        for g = 1, #turns do slopes[2 + g] = moved[g][k] / size end
        add_row(S, r, slopes, miss)
        left, all = left + miss ^ 2, all + ((w.y[i][k] - w.mean[k]) / size) ^ 2
      end
    end
  end
  if used < 4 then return nil end
  for i = 1, #r do
    for j = 1, i - 1 do S[j][i] = S[i][j] end
  end
  local fine, step = blame.try(function() return core.matrix(S):solve(core.vector(r)) end)
  return fine and step[1] == step[1] and step or nil, left, all
end

-- has the fit of a window come to its end?
local function is_found(w, step)
  local span = w.t[#w.t] - w.t[1]
  if abs(step[1]) > FOUND * span or abs(step[2]) > FOUND then return false end
  for g = 3, #step do
    if abs(step[g]) > FOUND then return false end
  end
  return true
end

-- the shift in a window, from the one before; nothing where there is none
local function fit(w, flow, at)
  local left, all
  for _ = 1, TRIES do
    local step, its_left, its_all = improve(w, flow, at)
    if not step or not (abs(at.b + step[2]) < 2) then return nil end
    at.a, at.b, left, all = at.a + step[1], at.b + step[2], its_left, its_all
    if flow.turns then at.turn = flow.turned(step) end
    if is_found(w, step) then break end
  end
  return left <= KNOWN * all
end

-- how often the column of a flow that turns most often swings to and fro up to a time; huge: never
local function swings(flow, horizon)
  local most = 0
  for _, list in ipairs(flow.columns) do
    local turns, way = 0, 0
    for i = 2, #list do
      local now = list[i] - list[i - 1]
      if flow.t[i] > horizon then break end
      if now * way < 0 then turns = turns + 1 end
      if now ~= 0 then way = now end
    end
    most = max(most, turns)
  end
  return most > 0 and most / 2 or math.huge
end

-- times and columns as tables, which are read faster than vectors and columns of paths
local function read_often(run)
  for k, list in ipairs { run.t, table.unpack(run.columns) } do
    local copy = {}
    for i = 1, #list do copy[i] = list[i] end
    if k == 1 then run.t = copy else run.columns[k - 1] = copy end
  end
end

--- How run = { t, columns } is shifted against flow = { t, columns (at even times), range of each,
-- turns, turned (groups.lua; nil: by no group) } up to the time `horizon`: { shift (by which it is
-- ahead at the end), largest, turn, largest_turn }, or nothing where no shift explains the run.
function M.follow(run, flow, horizon)
  read_often(run)
  read_often(flow)
  flow.read, flow.last = M.reader(flow.t, flow.columns)
  flow.first = run.t[1]
  local t0, known, at = run.t[1], false, { a = 0, b = 0 }
  local windows = min(flow.turns and FEWER or WINDOWS, #run.t // FEWEST, swings(flow, horizon))
  windows = max(1, floor(windows))
  local length, middle, out = (horizon - t0) / windows, t0, { largest = 0, largest_turn = 0 }
  local turned = 0
  for k = 1, windows do
    local w = window_of(run, t0 + (k - 1) * length, t0 + k * length)
    if #w.t >= 4 then
      local trial = { a = at.a + at.b * (w.middle - middle), b = at.b, turn = at.turn }
      local fine = fit(w, flow, trial)
      if fine ~= nil then
        at, middle, known = trial, w.middle, fine
        if fine then
          out.largest = max(out.largest, abs(at.a))
          local before = turned
          turned = flow.turns and flow.angle() or 0
          out.turn = turned + 0.5 * (turned - before)
          out.largest_turn = max(out.largest_turn, abs(turned), abs(out.turn))
        end
      end
    end
  end
  if not known then return nil end
  out.shift = at.a + at.b * (horizon - middle)
  out.largest = max(out.largest, abs(out.shift))
  return out
end

return M
