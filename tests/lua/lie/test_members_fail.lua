-- Members that fail say why as runs of their own do: a turn past the chart, a constraint that
-- depends on others, a force that jumps.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok

local MEMBERS = 11

-- All members by threads and lanes against runs: what a run says has its rule in front, and when
-- at the end or in the middle.
local function compare(what, system, q, v, rules, options, reason)
  for _, rule in ipairs(rules) do
    local solver = system:solver { rule = rule, h = options.h }
    local function start(i)
      local part, out = 1 + (options.spread or 0.02) * i, {}
      for k = 1, #v do out[k] = part * v[k] end
      return out
    end
    local lost = {}
    for _, f in ipairs(solver:ensemble { members = MEMBERS, steps = options.steps,
      q = function() return q end, v = start, every = options.every }:failures()) do
      lost[f.member] = f
    end
    local wrong, told = nil, 0
    for i = 1, MEMBERS do
      local fine, f = pcall(solver.run, solver, { q = q, v = start(i), steps = options.steps })
      local m = lost[i]
      if fine and m or not fine and (not m or m.code ~= f.code or m.step ~= f.step) then
        wrong = ("member %d: %s; alone %s"):format(i, m and m.message or "ok", tostring(f))
      elseif not fine and m.message:find(reason, 1, true) then
        local why = m.message:gsub("^[^:]*: ", "")
        if f.message:find(why, 1, true) then told = told + 1 else wrong = m.message .. f.message end
      end
    end
    ok(not wrong, ("%s, %s: members say what runs say"):format(what, rule), wrong)
    ok(told >= (options.least or MEMBERS), ("%s, %s: and the reason"):format(what, rule), told)
  end
end

-- ---- turns ----

local TURNS = { "lie(1)", "lie(2)", "lie(2, lobatto(3))", "rkmk4", "crouch-grossman3" }
local function spins(G)
  return dm.system { Q = G, L = function(_, w)
    local T = 0
    for i = 1, G.dimension do T = T + (1 + i / 7) * w[i] ^ 2 end
    return T / 2
  end }
end
local function fast(d, i, size)
  local v = {}
  for k = 1, d do v[k] = k == i and size or 0.3 * k end
  return v
end
for _, case in ipairs { { dm.SO(3), 2, 31 }, { dm.SE(3), 5, 31 }, { dm.SO(4), 3, 31 },
  { dm.SU(2), 3, 31 } } do
  local G, i, size = table.unpack(case)
  local system, v = spins(G), fast(G.dimension, i, size)
  compare(tostring(G), system, G:identity(), v, TURNS, { h = 0.1, steps = 4 }, "h turns the body by")
  compare(tostring(G), system, G:identity(), v, { "lie(1, cayley)", "lie(2, cayley)" },
    { h = 0.2, steps = 4 }, "xi of the step is")
end
-- a turn that grows: after some steps, members at different ones
local driven = dm.system { Q = dm.SO(3), L = function(g, w, t)
  return (w[1] ^ 2 + 2 * w[2] ^ 2 + 3 * w[3] ^ 2) / 2 end,
  force = function(g, w) return { 0, 0, 8 * w[3] } end }
compare("driven", driven, dm.SO(3):identity(), { 0.1, 0.2, 2 }, { "lie(1)", "rkmk4" },
  { h = 0.05, steps = 60, every = 1 }, "h turns the body by")
-- with a joint
local hinged = dm.system { Q = dm.SO(3), L = function(g, w) return w:dot(w) / 2 - g[3][3] end,
  constraint = function(g) return { g[3][1], g[3][2] } end }
compare("hinged", hinged, dm.SO(3):identity(), { 0, 0, 32 }, { "lie(1)", "lie(2)" },
  { h = 0.1, steps = 4 }, "h turns the body by")

-- ---- others ----

local crossing = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end,
  rolling = function(x, v) return { v[1] - x[3] * v[2], v[1] + x[3] * v[2] } end }
compare("crossing", crossing, { 0, 0, 1 }, { 0, 0, -1 }, { "midpoint", "gauss(2)", "lobatto(3)" },
  { h = 0.1, steps = 30, spread = 0, every = 1 }, "rolling constraint 2 depends on those before it")
local dry = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end,
  force = function(q, v) return { dm.where(v[1], -0.1, 0.1) } end }
compare("friction", dry, { 1.05 }, { 0.01 }, { "midpoint", "gauss(2)" }, { h = 0.1, steps = 400,
  }, "the force has a branch")

tap.done()
