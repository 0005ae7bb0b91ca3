-- functions of a system that return no numbers, or NaN whatever they are given: the message names the function and what it returned
local tap = require "tap"
local dm = require "dm"
local raises = tap.raises

local function run(fields, start)
  fields.Q, fields.L = dm.R(2), fields.L or function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end
  return dm.system(fields):solver({ rule = "midpoint", h = 0.1 }):run(start or { q = { 1, 0 }, v = { 0, 1 }, steps = 3 })
end
local function roll(_, v) return v[1] end
local function push(_, _, _, u) return { u[1], 0 } end
local nan = function() return 0 / 0 end
raises("L is NaN whatever", run, { L = nan })
raises("L is infinite whatever", run, { L = function() return 1 / 0 end })
raises("constraint is NaN whatever", run, { constraint = nan })
raises("rolling is NaN whatever", run, { rolling = nan })
raises("entry 2 of force is NaN whatever", run, { force = function() return { 0, 0 / 0 } end })
raises("control is NaN whatever", run, { control = nan, force = push })
raises("entry 1 of reaction is NaN whatever", run, { rolling = roll, reaction = function() return { { 0 / 0, 1 } } end })
raises("reaction must return a number, or a vector or table of numbers, got nil: is a return missing?", run,
  { rolling = roll, reaction = function() end })
raises("rolling is NaN at the start", run, { rolling = function(_, v) return v[1] * (0 / 0) end })
local function pair(Ld, force)
  return dm.solver({ dm.discrete_lagrangian { Q = dm.R(2), h = 0.1, Ld = Ld, force = force } }):run { q = { 1, 0 }, p = { 0, 1 }, steps = 1 }
end
raises("Ld is NaN whatever", pair, nan)
raises("entry 1 of force is NaN whatever", pair, function(a, b) return (b - a):dot(b - a) / 0.2 end, function() return { { 0 / 0, 0 }, { 0, 0 } } end)
tap.done()
