-- avi in space with a step of its own in every cell, against a queue of events written out here: tetrahedra and triangles of bcc meshes, sums of two kinds, data, time, values that are held
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local K = dm.mesh { bcc = 3 }
local random, draw = dm.random(5), 0
local function level(n, size)
  local out = {}
  for i = 1, n do draw = draw + 1 out[i] = size * (2 * random:uniform(draw, 0) - 1) end
  return out
end
local T, BASE = 0.8127, 0.02

-- phi of the numbers x of a cell: a ring of springs, a drive at the first; and its derivative by hand
local function phi(x, weight, t)
  local sum = 0
  for i = 1, #x do
    local s = x[i] - x[i % #x + 1]
    sum = sum + s ^ 2 / 2 + 0.1 * s ^ 4 + 0.3 * x[i] ^ 2
  end
  return weight * (sum + 0.3 * dm.sin(2 * t) * x[1])
end
local function slope(x, weight, t)
  local out = {}
  for i = 1, #x do out[i] = 0 end
  for i = 1, #x do
    local j = i % #x + 1
    local s = x[i] - x[j]
    out[i], out[j] = out[i] + s + 0.4 * s ^ 3 + 0.6 * x[i], out[j] - s - 0.4 * s ^ 3
  end
  out[1] = out[1] + 0.3 * math.sin(2 * t)
  for i = 1, #x do out[i] = weight * out[i] end
  return out
end

-- the cells of degree m as lists of the entries of k-forms of `values` numbers on their faces
local function entries_of(k, m, values)
  local at, out = {}, {}
  for i, s in ipairs(K:simplices(k)) do at[table.concat(s, ",")] = i end
  for i, s in ipairs(K:simplices(m)) do
    local list = {}
    local function faces(from, part)
      if #part == k + 1 then
        for c = 1, values do list[#list + 1] = (at[table.concat(part, ",")] - 1) * values + c end
        return
      end
      for j = from, #s do
        local more = { table.unpack(part) }
        more[#more + 1] = s[j]
        faces(j + 1, more)
      end
    end
    faces(1, {})
    out[i] = list
  end
  return out
end

local function flat(a, values, same)
  local out = {}
  if same then return { a } end
  for i = 1, #a do
    if values == 1 then out[i] = a[i] else for c = 1, values do out[#out + 1] = a[i][c] end end
  end
  return out
end

for _, case in ipairs { { 0, 3, 1, "whole" }, { 1, 3, 1, "half" }, { 1, 2, 1, "half" }, { 0, 3, 3, "half", { 1, 7 } } } do
  local k, m, values, start, fixed = table.unpack(case, 1, 5)
  local name = ("%d-forms of %d values in cells of degree %d, %s start"):format(k, values, m, start)
  local data = K:form(m, level(K:count(m), 0.2))
  local function step(volume) return BASE * (1 + 3 * (volume * 17.3 % 1)) end
  local function own_step(star) return BASE * (1.5 + star * 7.1 % 1) end
  local field = K:field { form = k, values = values, fixed = fixed, data = { w = data }, L = function(A, V, t)
    return V:dot(V) / 2 - A:dot(A) / 3
      - K:sum(m, function(a, cell) return phi(flat(a, values, k == m), cell.volume * (1 + cell.w), t) end, A) end }
  local n, masses, held = field.Q.dimension, field.field.masses, {}
  for _, i in ipairs(fixed or {}) do for c = 1, values do held[(i - 1) * values + c] = true end end
  local q, v = level(n, 1), level(n, 0.5)
  for i in pairs(held) do v[i] = 0 end

  -- the same, event by event
  local cells, volume, star = {}, K:volume(m), K:star_weights(k)
  for i, list in ipairs(entries_of(k, k, values)) do
    cells[i] = { list = list, h = own_step(star[i]), slope = function(x)
      local out = {}
      for c = 1, #x do out[c] = 2 / 3 * star[i] * x[c] end
      return out
    end }
  end
  for i, list in ipairs(entries_of(k, m, values)) do
    cells[#cells + 1] = { list = list, h = step(volume[i]),
      slope = function(x, t) return slope(x, volume[i] * (1 + data[i]), t) end }
  end
  local x, p, last = { table.unpack(q) }, {}, {}
  for i = 1, n do p[i], last[i] = masses[i] * v[i], 0 end
  local function kick(cell, t, h)
    local at = {}
    for j, i in ipairs(cell.list) do
      if not held[i] then x[i], last[i] = x[i] + (t - last[i]) * p[i] / masses[i], t end
      at[j] = x[i]
    end
    local g = cell.slope(at, t)
    for j, i in ipairs(cell.list) do if not held[i] then p[i] = p[i] - h * g[j] end end
  end
  local events = {}
  for i, cell in ipairs(cells) do
    if start == "half" then kick(cell, 0, cell.h / 2) end
    for j = 1, math.floor(T / cell.h) do events[#events + 1] = { j * cell.h, i } end
  end
  table.sort(events, function(a, b)
    if a[1] ~= b[1] then return a[1] < b[1] end
    return a[2] < b[2]
  end)
  for _, e in ipairs(events) do kick(cells[e[2]], e[1], cells[e[2]].h) end
  for i = 1, n do if not held[i] then x[i] = x[i] + (T - last[i]) * p[i] / masses[i] end end

  local solver = field:solver { rule = "avi", start = start, h = function(cell)
    return cell.degree == m and step(cell.volume) or own_step(cell.star) end }
  local run = solver:run { q = q, v = v, t = T }
  local worst = 0
  for i = 1, n do worst = math.max(worst, math.abs(run.q[#run][i] - x[i]), math.abs(run.p[#run][i] - p[i])) end
  ok(worst < 1e-13, name, worst)
  ok(solver:report().events == #events and run.t[#run] == T, "as many events", #events)
end
tap.done()
