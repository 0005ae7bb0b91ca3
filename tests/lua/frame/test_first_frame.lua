-- What the first frame of a process reads: modules that only messages and rarer calls need are read
-- when these come.
local tap = require "tap"
local dm = require "dm"
local ok = tap.ok
local function is(a, b, what) ok(a == b, what) end

local action = dm.action { group = dm.SE(2), on = dm.R(2) }
local frame = dm.moving_frame { action = action, points = 2,
  cross_section = function(a, b) return { a[1], a[2], b[2] } end,
  branch = function(_, b) return b[1] end }

local LATER = { "dm.base.linear", "dm.group.matrix_functions", "dm.group.methods", "dm.group.son",
  "dm.frame.derivatives", "dm.frame.partial" }
for _, name in ipairs(LATER) do
  ok(not package.loaded[name], name .. " is not read for a frame")
end

-- they come with the first call, with their docs and messages
local _, condition = frame:transversality({ 0, 0 }, { 1, 0 })
ok(package.loaded["dm.frame.derivatives"] and condition > 0, "methods of frames come when called")
is(dm.SE(2):exp({ 1, 2, 0 })[2], 2.0, "and those of groups")
ok(require("dm.core").docs[action.group.dexp]:find("G:dexp", 1, true) ~= nil, "with their docs")

local class = require "dm.base.class"
local reads = 0
local module = class.module(function()
  reads = reads + 1
  return { one = 1, f = function(x) return x + 1 end }
end)
is(reads, 0, "a module is read when it is asked for something")
is(module.one + module.f(1) + module.f(2), 6, "and gives what it has")
is(module.none, nil, "or nothing")

tap.done()
