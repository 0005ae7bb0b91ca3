-- random models whose mass touches zero, passes it or comes near to it: members end where runs of
-- their own do, by the same name, and have their states to the last bit
local tap = require "tap"
local dm = require "dm"

local stream, drawn = dm.random(304), 0
local function uniform(a, b)
  drawn = drawn + 1
  return a + (b - a) * stream:uniform(drawn, 0)
end
local function any(...) return (select(math.floor(uniform(0, select("#", ...))) + 1, ...)) end

local RULES = { "symplectic-euler", "trapezoidal", "lobatto(3)", "galerkin(2, gauss(3))" }
local ROLLING = { "midpoint", "lobatto(3)", "curve(rk4)" }

-- w = 0 on a line, a circle, a curve, in rows; small in a dip; at a pole of coordinates. w^k along
-- q1, other masses beside it
local function model(rolls)
  local n, k = rolls and 3 or any(1, 2, 2, 3, 4), any(1, 2, 2, 4, 4)
  local form = any("line", "circle", "curve", "sine", "dip", "pole")
  local c, b, r, m = uniform(-0.5, 0.5), uniform(-1, 1), uniform(0.5, 1.2), uniform(0.3, 2)
  b = n > 1 and b or 0
  local rate = any(0, 0, 0, uniform(-0.5, 0.5))
  local a, V = n > 1 and not rolls and any(0, uniform(-0.3, 0.3)) or 0, any("bowl", "cos", "hill")
  local function w(q, t)
    local y = n > 1 and q[2] or 0
    if form == "circle" then return (q[1] - c) ^ 2 + y ^ 2 - r end
    if form == "curve" then return q[1] - c + 0.4 * y ^ 2 + rate * t end
    if form == "dip" then return dm.sqrt((q[1] - c) ^ 2 + 1e-3) end
    return form == "sine" and dm.sin(q[1] - c + b * y) or q[1] - c + b * y + rate * t
  end
  local function L(q, v, t)
    local T = w(q, t) ^ k * (v[1] + (n > 1 and a * v[2] or 0)) ^ 2 / 2
    if form == "pole" and n > 1 then T = w(q, t) ^ 2 * v[2] ^ 2 / 2 + v[1] ^ 2 / 2
    elseif n > 1 then T = T + m * v[2] ^ 2 / 2 end
    for i = 3, n do T = T + (1.5 + dm.cos(q[i - 1])) * v[i] ^ 2 / 2 end
    if V == "cos" then return T - dm.cos(q[1] + (n > 1 and q[2] or 0)) end
    return T - (V == "bowl" and 0.5 or -0.25) * q:dot(q)
  end
  local function timeless(q, v) return L(q, v, 0) end
  local system = dm.system { Q = dm.R(n), L = rate ~= 0 and L or timeless,
    rolling = rolls and function(q, v) return v[3] - dm.sin(q[1]) * v[2] end or nil }
  local q, v = {}, {}
  for j = 1, any(3, 9, 21) do
    q[j], v[j] = {}, {}
    for i = 1, n do q[j][i], v[j][i] = uniform(-1.2, 1.2), uniform(-1.5, 1.5) end
    if rolls then v[j][3] = math.sin(q[j][1]) * v[j][2] end
  end
  return system, dm.matrix(q), dm.matrix(v), uniform(0.01, 0.06)
end

-- what a run of member j ends with, and whether the member of e has its last state
local function is_like(e, j, solver, start)
  local fine, run = pcall(solver.run, solver, start)
  local code, steps = fine and "ok" or run.code, fine and start.steps or run.step - 1
  local like = e.status[j] == code and e.steps[j] == steps
  for k = 1, fine and #start.q or 0 do
    like = like and e.q[j][k] == run.q[#run.q][k] and e.p[j][k] == run.p[#run.p][k]
  end
  return like, code, steps
end

local members, unlike, named, where = 0, 0, 0, ""
for i = 1, 24 do
  local rolls = i % 5 == 0
  local system, q, v, h = model(rolls)
  local steps = math.min(150, math.ceil(3 / h))
  for _, rule in ipairs(rolls and ROLLING or RULES) do
    local solver = system:solver { rule = rule, h = h }
    local e = solver:ensemble { members = #q, q = q, v = v, steps = steps, threads = 1 }
    for j = 1, #q do
      local like, code, done = is_like(e, j, solver, { q = q[j], v = v[j], steps = steps })
      members, unlike = members + 1, unlike + (like and 0 or 1)
      named = named + (code == "inertia" and 1 or 0)
      if not like then
        where = where .. ("\n  %d %s, member %d: %s after %d, alone %s after %d"):format(i, rule, j,
          e.status[j], e.steps[j], code, done)
      end
    end
  end
end
-- 4 where looks of a run came at other steps than those of a member
tap.ok(unlike == 0, "members end as runs of their own", unlike .. " of " .. members .. where)
tap.ok(named > members / 10, "many at a place without mass", named .. " of " .. members)

---- members with steps of their own ----
local narrow = dm.system { Q = dm.R(1), L = function(q, v) return (1 - 1.5 / (1 + (q[1] / 0.002) ^ 2)) * v[1] ^ 2 / 2 end }
for _, rule in ipairs { "gauss(2)", "gauss(3)" } do
  for _, hs in ipairs { { 0.1, 1e-4 }, { 1e-4, 0.1 } } do
    local solver = narrow:solver { rule = rule, h = 0.1 }
    local many = solver:ensemble { members = 2, t = 2, h = function(i) return hs[i] end, q = function() return { -1.05 } end, v = function() return { 1 } end }
    for i = 1, 2 do
      local fine, alone = pcall(function() return narrow:solver { rule = rule, h = hs[i] }:run { q = { -1.05 }, v = { 1 }, t = 2 } end)
      tap.ok(not fine and many.status[i] == alone.code and many.steps[i] == alone.step - 1, ("%s, h = %g and %g, member %d ends as alone"):format(rule, hs[1], hs[2], i), many.status[i])
    end
  end
end
tap.done()
