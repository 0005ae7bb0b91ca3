-- Friction in the joints of arms, in Cartesian coordinates, from starts at which the joints rest:
-- what is left of the rates there is round-off on either road, and no wrong trace. Wrong ones at
-- such starts are still found.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises
local sin, cos = dm.sin, dm.cos

local number = 0
local function random(a, b)
  number = number + 1
  local x = math.sin(number * 12.9898) * 43758.5453
  return a + (b - a) * (x - math.floor(x))
end

local function rate(x, y, u, w) return (x * w - y * u) / (x ^ 2 + y ^ 2) end

-- arms of so many links; coordinates are those of the links, or of the masses at their ends
local function link_of(of_masses)
  return function(q, j)
    if not of_masses or j == 1 then return q[2 * j - 1], q[2 * j] end
    return q[2 * j - 1] - q[2 * j - 3], q[2 * j] - q[2 * j - 2]
  end
end
local function force_of(links, of_masses)
  local link = link_of(of_masses)
  return function(q, v)
    local F = {}
    for i = 1, 2 * links do F[i] = 0 end
    local function push(j, torque)
      local x, y = link(q, j)
      for k = j, of_masses and math.max(j - 1, 1) or j, -1 do
        local s = (k == j and 1 or -1) * torque / (x ^ 2 + y ^ 2)
        F[2 * k - 1], F[2 * k] = F[2 * k - 1] - s * y, F[2 * k] + s * x
      end
    end
    for j = 2, links do
      local x, y = link(q, j)
      local a, b = link(q, j - 1)
      local u, w = link(v, j)
      local c, d = link(v, j - 1)
      local torque = -0.2 * (rate(x, y, u, w) - rate(a, b, c, d))
      push(j, torque)
      push(j - 1, -torque)
    end
    return F
  end
end

local function model(links, of_masses, length, time)
  local m, link = {}, link_of(of_masses)
  m.system = dm.system { Q = dm.R(2 * links), force = force_of(links, of_masses), L = function(q, v)
    local V = 0
    for j = 1, links do
      local x, y = link(q, j)
      V = V + (x ^ 2 + y ^ 2) / 2 / time ^ 2
    end
    return v:dot(v) / 2 - V
  end }
  function m.turn(t, q)
    local out = {}
    for j = 1, links do
      local x, y = q[2 * j - 1], q[2 * j]
      out[2 * j - 1], out[2 * j] = cos(t) * x - sin(t) * y, sin(t) * x + cos(t) * y
    end
    return out
  end
  local function placed(x, y, out, j, a, b)
    out[2 * j - 1], out[2 * j] = of_masses and x + a or a, of_masses and y + b or b
    return out[2 * j - 1], out[2 * j]
  end
  function m.section(s)
    local out, x, y = { s[1], 0 }, s[1], 0
    for j = 2, links do
      local r, angle = s[2 * j - 2], s[2 * j - 1]
      x, y = placed(x, y, out, j, r * cos(angle), r * sin(angle))
    end
    return out
  end
  -- the whole turns like one body
  function m.start()
    local q, v, x, y, w = {}, {}, 0, 0, random(0.3, 3) / time
    for j = 1, links do
      local r, angle = random(0.3, 1) * length, random(-3, 3)
      x, y = placed(x, y, q, j, r * math.cos(angle), r * math.sin(angle))
    end
    for j = 1, links do v[2 * j - 1], v[2 * j] = -q[2 * j] * w, q[2 * j - 1] * w end
    return q, v
  end
  return m
end

local function refused(m, starts, h)
  local count, why = 0, nil
  for k = 1, starts do
    local q, v = m.start()
    local fine, message = pcall(function()
      local shape = m.system:routh { action = m.turn, section = m.section, q = q, v = v }
      local x, u = shape:start(q, v)
      shape:solver({ rule = k % 2 == 0 and "midpoint" or "gauss(2)", h = h }):run { q = x, v = u, steps = 2 }
    end)
    if not fine then count, why = count + 1, why or tostring(message) end
  end
  return count, why
end
for links = 2, 4 do
  for _, of_masses in ipairs { false, true } do
    local count, why = refused(model(links, of_masses, 1, 1), tap.samples(24), 0.005)
    ok(count == 0, ("%d links by their %s"):format(links, of_masses and "masses" or "own"), why)
  end
end
ok(refused(model(3, true, 1000, 1e-3), tap.samples(24), 5e-6) == 0, "in other units")

-- what sees symbols is found where v = 0, also where it makes little difference
local function planar(force)
  local L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end
  local solver = dm.system({ Q = dm.R(2), L = L, force = force }):solver { rule = "midpoint", h = 0.01 }
  return function() solver:run { q = { 0.6, 0.8 }, v = { 0, 0 }, steps = 2 } end
end
for _, size in ipairs { 1, 1e-3, 1e-6, 1e-9 } do
  raises("is not what its trace says", planar(function(q, v)
    return { v[1] == 0 and size or -v[1], -v[2] }
  end))
  raises("is not what its trace says", planar(function(q, v)
    return { -v[1], type(v[2]) == "number" and size * q[1] or -v[2] }
  end))
end
local calls = 0
raises("gives different values", planar(function(q, v)
  calls = calls + 1
  return { -v[1] + 1e-9 * calls, -v[2] }
end))
tap.done()
