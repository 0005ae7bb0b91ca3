-- A stop may come between any two instructions: what a scene says afterwards is what a new one says.
local tap = require "tap"
local dm = require "dm"

local system = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }
local function new(more)
  local options = { system, q = { 1 }, v = { 0 }, watch = { "q1" }, tolerance = 0.1, until_t = 0.5, rules = { "verlet" } }
  for key, value in pairs(more or {}) do options[key] = value end
  return dm.scene(options)
end
local function told(scene) return (scene:why():gsub(", [^,]+ s of CPU$", "")) end

-- instructions of f()
local function length(f)
  local count = 0
  debug.sethook(function() count = count + 100 end, "", 100)
  f()
  debug.sethook()
  return count
end
local function stopped(count, f)
  debug.sethook(function() debug.sethook() error("interrupted!", 0) end, "", count)
  local fine, why = pcall(f)
  debug.sethook()
  return not fine and tostring(why):find "interrupted!" ~= nil
end

local want = told(new())
local all = length(function() new():why() end)
local stops, wrong = 0, {}
-- the end in small steps: there the choice is told part by part
for _, part in ipairs { 0.05, 0.2, 0.4, 0.6, 0.8, 0.85, 0.87, 0.89, 0.9, 0.91, 0.92, 0.93, 0.935, 0.94, 0.945, 0.95, 0.955, 0.96 } do
  local scene = new()
  if stopped(math.floor(part * all), function() scene:why() end) then stops = stops + 1 end
  local fine, text = pcall(told, scene)
  if not fine or text ~= want then wrong[#wrong + 1] = part .. ": " .. text end
end
tap.ok(stops > 10 and #wrong == 0, stops .. " scenes that were stopped say afterwards what a new one says", table.concat(wrong, "\n"))
tap.done()
