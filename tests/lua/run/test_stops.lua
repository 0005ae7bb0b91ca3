-- a stop, by Ctrl-C or the end of core.within, ends every call in the same way: it is raised, and never a result
package.path = "tests/fuzz/?.lua;" .. package.path
local tap = require "tap"
local dm = require "dm"
local core = require "dm.core"
local is_stop = require "dm.base.blame".is_stop
local ok = tap.ok

---- all calls of templates.lua, stopped before they begin and soon after ----

local files = { "f.npy", "f.checkpoint", "f.vtk", "f.html" }
local function clean()
  for _, file in ipairs(files) do os.remove(file) end
end
local draws = { ["plot of a mesh"] = true, ["space and time"] = true } -- into the terminal
-- what is wrong with how the call ended, beside what is wrong without a stop
local function told(row, seconds)
  local out = table.pack(pcall(core.within, seconds, row[2], row[3]))
  if not out[1] then return pcall(row[2], row[3]) and tostring(out[2]) or nil end
  if not out[2] then return not is_stop(out[3]) and tostring(out[3]) or nil end
  for i = 3, out.n do
    local fine, code = pcall(function() return out[i].code end)
    if fine and code == "stopped" then return "a result of code 'stopped'" end
  end
end
local wrong, count = {}, 0
for _, row in ipairs(require "templates".rows()) do
  for _, seconds in ipairs(draws[row[1]] and {} or { 0, 1e-3, 4e-3 }) do
    local why = told(row, seconds)
    count = count + 1
    if why then wrong[#wrong + 1] = row[1] .. ": " .. why end
  end
end
clean()
ok(#wrong == 0, count .. " calls that are stopped end by the stop, or as without it", table.concat(wrong, "\n# "))

---- loops that once gave a report of code "stopped" ----

local function sequence(more)
  local o = { equation = function(y, x) return { x[1] ^ 2 - y[1] - 1 } end, next = function(_, x) return { x[1] } end,
    start = function(y) return { y[1] } end, y = { 3 }, unknowns = 1, steps = 1e9, every = 1e6 }
  for key, value in pairs(more or {}) do o[key] = value end
  return dm.sequence(o)
end
local _, failure = core.within(0.05, sequence)
ok(is_stop(failure) and failure.code == "stopped" and failure.path.columns == 1 and failure.path.rows >= 1 and failure.path[1][1] == 3,
  "dm.sequence: with the rows so far", tostring(failure))
ok(tostring(failure):find("dm.sequence: stopped on request at step %d+; the path so far is in failure.path") and failure.time == nil,
  "and says so", tostring(failure))

-- a band of 600,000 rows: Newton's method alone takes longer than the deadline
local n, guess, given = 20000, {}, {}
for i = 1, 30 * n do guess[i], given[i] = i / (30 * n), false end
local function stationary()
  return dm.stationary { sites = n, block = 30, window = 2, x = guess, given = given, term = function(w)
    local sum = 0
    for i = 1, 30 do sum = sum + (w[i + 30] - w[i]) ^ 2 + w[i] ^ 4 end
    return sum
  end }
end
_, failure = core.within(0.3, stationary)
ok(is_stop(failure), "dm.stationary ends within a matrix", tostring(failure))

local shift = dm.action { group = dm.R(1), on = dm.R(2), map = function(g, z) return { z[1] + g[1], z[2] } end }
local problem = dm.invariant_problem { points = 2, L = function(I) return ((I[2][1]) ^ 2 + (I[2][2] - I[1][2]) ^ 2) / 2 end,
  frame = dm.moving_frame { action = shift, points = 2, cross_section = function(a) return a[1] end } }
problem:solve { points = { { 0, 0 }, { 1, 0.5 } }, n = 5 } -- what a first call compiles is there
_, failure = core.within(0.1, problem.solve, problem, { points = { { 0, 0 }, { 1, 0.5 } }, n = 1e9, every = 1e6 })
local curve = failure.path
ok(is_stop(failure) and curve and #curve >= 2 and curve.points[1][1] == 0 and failure.points == curve.points,
  "problem:solve: with the curve so far", tostring(failure))
tap.done()
