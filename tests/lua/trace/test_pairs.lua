-- dm.sum_over over pairs of bodies: all of them, and those within a distance, in boxes and open space
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises
local random = dm.random(7)
local function uniform(i, k) return random:uniform(i, k) end

-- forces and energy by plain loops; image(d, axis) is the nearest one
local function by_hand(q, d, term, within, box)
  local n, energy, force = #q // d, 0, {}
  for i = 1, #q do force[i] = 0 end
  for i = 1, n do
    for j = i + 1, n do
      local x, r2 = {}, 0
      for c = 1, d do
        x[c] = q[d * (i - 1) + c] - q[d * (j - 1) + c]
        local L = box and box[c] or math.huge
        if L < math.huge then x[c] = x[c] - L * math.floor(x[c] / L + 0.5) end
        r2 = r2 + x[c] ^ 2
      end
      if not within or r2 < within ^ 2 then
        local u, slope = term(r2, i, j) -- u(r2), du/d(r2)
        energy = energy + u
        for c = 1, d do
          force[d * (i - 1) + c] = force[d * (i - 1) + c] - 2 * slope * x[c]
          force[d * (j - 1) + c] = force[d * (j - 1) + c] + 2 * slope * x[c]
        end
      end
    end
  end
  return energy, force
end

-- the force of a system at q, by two steps of Verlet backwards and forwards: q(h) + q(-h) - 2 q = h^2 F for masses 1
local function force_of(system, q)
  local h, zero = 1e-3, {}
  for i = 1, #q do zero[i] = 0 end
  local run = system:solver { rule = "verlet", h = h }:run { q = q, v = zero, steps = 1 }
  return (run.q[2] - run.q[1]) * (2 / h ^ 2), run:column "energy"[1]
end

local function compare(name, q, d, term, U, options, within, box, data)
  options.pairs, options.block = true, d
  local system = dm.system { Q = dm.R(#q), L = function(x, v)
    local kinetic = dm.sum_over(v, function(u) return u ^ 2 / 2 end)
    if data then return kinetic - dm.sum_over(x, data, U, options) end
    return kinetic - dm.sum_over(x, U, options)
  end }
  local F, E = force_of(system, q)
  local energy, force = by_hand(q, d, term, within, box)
  local off, size = 0, 1
  for i = 1, #q do off, size = math.max(off, math.abs(F[i] - force[i])), math.max(size, math.abs(force[i])) end
  ok(off < 1e-8 * size, name .. ": forces", off / size)
  near(E, energy, 1e-12 * math.max(1, math.abs(energy)), name .. ": energy")
  local direct = data and dm.sum_over(q, data, U, options) or dm.sum_over(q, U, options)
  near(direct, energy, 1e-12 * math.max(1, math.abs(energy)), name .. ": on numbers")
  return system
end

-- all pairs: softened gravity with masses, in 1 to 3 dimensions, numbers of bodies around whole groups and strips
for _, case in ipairs { { 3, 7 }, { 3, 8 }, { 3, 9 }, { 3, 17 }, { 2, 63 }, { 3, 64 }, { 3, 65 }, { 1, 40 }, { 3, 150 } } do
  local d, n = case[1], case[2]
  local q, m = {}, {}
  for i = 1, d * n do q[i] = 2 * uniform(i, d) end
  for i = 1, n do m[i] = 0.5 + uniform(i, 9) end
  local function U(a, ma, b, mb) local x = a - b return -ma * mb / ((d == 1 and x ^ 2 or x:dot(x)) + 0.01) ^ 0.5 end
  local function term(r2, i, j) local w = m[i] * m[j] / (r2 + 0.01) ^ 0.5 return -w, w / 2 / (r2 + 0.01) end
  compare(("gravity, %d bodies in %d dimensions"):format(n, d), q, d, term, U, {}, nil, nil, m)
end

-- pairs within a distance: lists and cells against plain loops, in boxes, open along some axes, or open
local function soft(a, b) local x = a - b local s = 1 - (type(x) == "userdata" and x:dot(x) or x ^ 2) return s ^ 3 end
local function soft_line(a, b) return (1 - (a - b) ^ 2) ^ 3 end
local function soft_term(r2) return (1 - r2) ^ 3, -3 * (1 - r2) ^ 2 end
for _, case in ipairs { { 3, 200, 4 }, { 3, 200, { 4, 5.5, 3 } }, { 3, 150, { 4, math.huge, 3 } }, { 3, 150 }, { 2, 120, 6 }, { 2, 90 }, { 1, 60, 10 }, { 3, 5, 3 }, { 3, 2, 3 }, { 2, 400, 20 }, { 3, 300, 2.5 } } do
  local d, n, box = case[1], case[2], case[3]
  local list = box and (type(box) == "table" and box or { box, box, box })
  local q = {}
  for i = 1, n do
    for c = 1, d do -- some bodies many boxes away: positions are not wrapped
      local L = list and list[c] < math.huge and list[c] or 3
      q[d * (i - 1) + c] = L * uniform(i, c) + (i % 5 == 0 and list and list[c] < math.huge and (i % 3 - 1) * 4 * L or 0)
    end
  end
  local system = compare(("%d bodies, %d dimensions, box %s"):format(n, d, type(box) == "table" and table.concat(box, " ") or tostring(box)), q, d, soft_term,
    d == 1 and soft_line or soft, { within = 1, margin = 0.2, box = box }, 1, list)
  ok(tostring(system):find "separable" ~= nil, "a loop")
end

-- bits do not depend on the margin, on when lists were made, or on where a run is cut; the energy is kept and momentum too
local n, L = 108, (108 / 0.8) ^ (1 / 3)
local q, v, cell = {}, {}, L / 3
for i = 0, 2 do for j = 0, 2 do for k = 0, 2 do for _, b in ipairs { { 0, 0, 0 }, { 0.5, 0.5, 0 }, { 0.5, 0, 0.5 }, { 0, 0.5, 0.5 } } do
  for c, x in ipairs { i, j, k } do q[#q + 1], v[#v + 1] = (x + b[c]) * cell, 2 * uniform(#q, 5) - 1 end
end end end end
local cut = 2
local function lennard_jones(a, b) -- and its slope are 0 at the cut
  local x = a - b
  local s, s0 = 1 / x:dot(x) ^ 3, 1 / cut ^ 6
  return 4 * (s * s - s) - 4 * (s0 * s0 - s0) + (x:dot(x) - cut ^ 2) * 12 * (2 * s0 * s0 - s0) / cut ^ 2
end
local function argon(margin)
  return dm.system { Q = dm.R(3 * n), L = function(x, u) return dm.sum_over(u, function(w) return w ^ 2 / 2 end)
    - dm.sum_over(x, lennard_jones, { pairs = true, block = 3, within = cut, margin = margin, box = L }) end }
end
local one = argon(0.3):solver { rule = "verlet", h = 0.002 }:run { q = q, v = v, steps = 400, every = 100 }
for _, margin in ipairs { 0, 0.05, 0.5 } do
  local other = argon(margin):solver { rule = "verlet", h = 0.002 }:run { q = q, v = v, steps = 400, every = 100 }
  ok(other.q[5] == one.q[5] and other.p[5] == one.p[5], "the same bits with margin " .. margin)
end
ok(one:drift "energy".largest < 2e-2, "energy of a liquid", one:drift "energy".largest)
for c = 1, 3 do
  local first, last = 0, 0
  for i = c, 3 * n, 3 do first, last = first + one.p[1][i], last + one.p[5][i] end
  near(last, first, 1e-11, "momentum " .. c)
end
local solver = argon(0.3):solver { rule = "verlet", h = 0.002 }
local first = solver:run { q = q, v = v, steps = 150, every = 150 }
local file = first:checkpoint(os.tmpname())
local rest = dm.resume(file, argon(0.3)):run { steps = 250, every = 250 }
os.remove(file)
ok(rest.q[#rest] == one.q[5], "a run that was cut has the same bits")
-- threads share out the rows of pairs, never an entry: the same bits for every number of them
for _, threads in ipairs { 1, 2, 3, 8, 20 } do
  local other = argon(0.3):solver { rule = "verlet", h = 0.002, threads = threads }:run { q = q, v = v, steps = 400, every = 100 }
  ok(other.q[5] == one.q[5] and other.p[5] == one.p[5], "the same bits with " .. threads .. " threads")
end
for _, bodies in ipairs { 10, 63, 64, 65, 150 } do
  local x, still, runs = {}, {}, {}
  for i = 1, 3 * bodies do x[i], still[i] = 2 * uniform(i, 4), 0 end
  local cluster = dm.system { Q = dm.R(3 * bodies), L = function(y, u)
    return dm.sum_over(u, function(w) return w ^ 2 / 2 end)
      + dm.sum_over(y, function(a, b) local d = a - b return 1 / (d:dot(d) + 0.01) ^ 0.5 end, { pairs = true, block = 3 })
  end }
  for _, rule in ipairs { "verlet", "kahan-li(6)", "yoshida(4)" } do
    for k, threads in ipairs { 1, 2, 5 } do
      runs[k] = cluster:solver { rule = rule, h = 0.002, threads = threads }:run { q = x, v = still, steps = 20, every = 7 }
    end
    local same = true
    for i = 1, #runs[1] do same = same and runs[1].q[i] == runs[2].q[i] and runs[1].p[i] == runs[3].p[i] end
    ok(same, ("%s, %d bodies: the same bits with 1, 2 and 5 threads"):format(rule, bodies))
  end
end
-- moved by whole boxes nothing changes but rounding
local moved = {}
for i = 1, 3 * n do moved[i] = q[i] + (i % 4 - 1) * 3 * L end
local far = argon(0.3):solver { rule = "verlet", h = 0.002 }:run { q = moved, v = v, steps = 20, every = 20 }
local near_ = argon(0.3):solver { rule = "verlet", h = 0.002 }:run { q = q, v = v, steps = 20, every = 20 }
ok((far.p[2] - near_.p[2]):norm() < 1e-9, "positions need not be in the box", (far.p[2] - near_.p[2]):norm())
-- where there are too many neighbours for lists, rows come from the cells: threads share nothing there either
do
  local many, x, u = 400, {}, {}
  for i = 1, 3 * many do x[i], u[i] = uniform(i, 11), uniform(i, 12) - 0.5 end
  local dense = dm.system { Q = dm.R(3 * many), L = function(y, w) return dm.sum_over(w, function(a) return a ^ 2 / 2 end)
    - dm.sum_over(y, soft, { pairs = true, block = 3, within = 1 }) / many end }
  local single = dense:solver { rule = "verlet", h = 0.05 }:run { q = x, v = u, steps = 4 }
  for _, threads in ipairs { 2, 3, 2, 5 } do
    local other = dense:solver { rule = "verlet", h = 0.05, threads = threads }:run { q = x, v = u, steps = 4 }
    ok(other.q[5] == single.q[5] and other.p[5] == single.p[5], "dense: the same bits with " .. threads .. " threads")
  end
end

-- ensembles are made of the same members
local cloud = solver:ensemble { members = 3, q = function() return q end, v = function(i) local w = {} for k = 1, 3 * n do w[k] = v[k] * i / 3 end return w end, steps = 20, every = 20 }
ok((cloud:path(3).p[#cloud:path(3)] - near_.p[2]):norm() < 1e-9 * near_.p[2]:norm() + 1e-9, "a member is a run")

-- one body has no pairs; 2 (within + margin) is large enough as it is rounded; NaN is not left out
for _, options in ipairs { { pairs = true, block = 3 }, { pairs = true, block = 3, within = 1 } } do
  near(dm.sum_over({ 1, 2, 3 }, soft, options), 0, 0, "one body")
  local alone = dm.system { Q = dm.R(3), L = function(x, u) return u:dot(u) / 2 - x:dot(x) / 2 - dm.sum_over(x, soft, options) end }
  local run = alone:solver { rule = "verlet", h = 0.1 }:run { q = { 1, 0, 0 }, v = { 0, 0, 0 }, steps = 1 }
  near(run.q[2][1], 1 - 0.005, 1e-15, "one body is stepped")
end
for within = 1, 40 do
  near(dm.sum_over({ 0, 0, 0, within, 0, 0 }, soft, { pairs = true, block = 3, within = within, margin = within / 7, box = within * 16 / 7 }), 0, 0, "a box of just that side")
end
local unknown = dm.sum_over({ 0, 0, 0, 0 / 0, 0, 0 }, soft, { pairs = true, block = 3, within = 1 })
ok(unknown ~= unknown, "NaN stays NaN", unknown)

-- refusals
local function refused(words, options) raises(words, function() return dm.sum_over({ 0, 0, 0, 1, 0, 0 }, soft, options) end) end
refused("at least 2 (within + margin)", { pairs = true, block = 3, within = 1, margin = 0.5, box = 2.9 })
refused("at least 2 (within + margin)", { pairs = true, block = 3, within = 1, box = { 9, 9, 2 } })
refused("goes with pairs = true", { block = 3, within = 1 })
refused("goes with 'within'", { pairs = true, block = 3, margin = 1 })
refused("goes with 'within'", { pairs = true, block = 3, box = 1 })
refused("'margin' must be >= 0", { pairs = true, block = 3, within = 1, margin = -1 })
refused("'within' must be", { pairs = true, block = 3, within = 0 })
refused("'within' must be", { pairs = true, block = 3, within = "near" })
refused("'box' must be a side", { pairs = true, block = 3, within = 1, box = { 4, 4 } })
refused("'box' must be a side", { pairs = true, block = 3, within = 1, box = -4 })
refused("'box' must be a side", { pairs = true, block = 3, within = 1, box = 0 })
raises("1 to 3 coordinates", function() return dm.sum_over({ 0, 0, 0, 0, 1, 0, 0, 0 }, soft, { pairs = true, block = 4, within = 1 }) end)
raises("second derivatives", function() argon(0.3):solver { rule = "midpoint", h = 0.01 }:run { q = q, v = v, steps = 1 } end)
raises("asked of numbers", function() dm.trace(function(x) return dm.sum_over(x, soft_line, { pairs = true, within = 1 }) end, 20) end)
tap.done()
