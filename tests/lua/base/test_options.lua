-- Tables of options: keys that are not known, values of the wrong kind, and where an error points.
local tap = require "tap"
local blame = require "dm.base.blame"
local options = require "dm.base.options"

local function says(text, f, ...)
  local fine, message = pcall(f, ...)
  tap.ok(not fine and message == text, "'" .. text .. "'", message)
end

local KNOWN = { 1, "system", "steps", "h" }
local given = { 5, steps = 3 }
tap.ok(options.check(given, KNOWN, "dm.f") == given, "a table whose keys are known comes back")
tap.ok(options.check({ 1, 2, 3 }, { "h", entries = true }, "dm.f"), "entries may be allowed")
says("dm.f: takes a table { q =, v = } (got 3)", options.check, 3, KNOWN, "dm.f", "{ q =, v = }")
says("dm.f: takes a table of options (got nil)", options.check, nil, KNOWN, "dm.f")
says("dm.f: unknown option 'stepz'; did you mean 'steps'? options are system, steps, h",
  options.check, { stepz = 1 }, KNOWN, "dm.f")
says("dm.f: unknown option 'colour'; options are system, steps, h",
  options.check, { colour = 1 }, KNOWN, "dm.f")
says("dm.f: unknown option '2'; options are system, steps, h",
  options.check, { 1, 2 }, KNOWN, "dm.f")
says("dm.f: unknown option 'true'; options are h", options.check, { [true] = 2 }, { "h" }, "dm.f")

----- getters ----
local t = { n = 3, x = 0.5, zero = 0, half = 2.5, whole = 4.0, inf = 1 / 0, text = "up", f = print,
  list = { 7 }, empty = {}, nan = 0 / 0 }
tap.ok(options.whole(t, "n", "dm.f", 1) == 3, "a whole number")
tap.ok(math.type(options.whole(t, "whole", "dm.f", 1, 4)) == "integer", "4.0 is 4")
tap.ok(options.whole(t, "none", "dm.f", 1) == nil, "an option may be left out")
tap.ok(options.whole(t, "none", "dm.f", 1, nil, 8) == 8, "and has a default then")
says("dm.f: option 'half' must be a whole number >= 1 (got 2.5)",
  options.whole, t, "half", "dm.f", 1)
says("dm.f: option 'n' must be a whole number from 1 to 2 (got 3)",
  options.whole, t, "n", "dm.f", 1, 2)
says("dm.f: option 'nan' must be a whole number >= 0 (got " .. tostring(0 / 0) .. ")",
  options.whole, t, "nan", "dm.f", 0)
says("dm.f: option 'text' must be a whole number >= 0 (got \"up\")",
  options.whole, t, "text", "dm.f", 0)
tap.ok(options.number(t, "x", "dm.f") == 0.5 and options.number(t, "none", "dm.f", nil, 2) == 2,
  "a number")
says("dm.f: option 'inf' must be a time (got inf)", options.number, t, "inf", "dm.f", "a time")
tap.ok(options.positive(t, "x", "dm.f", "a step") == 0.5, "a positive number")
says("dm.f: option 'zero' must be a step > 0 (got 0)",
  options.positive, t, "zero", "dm.f", "a step")
says("dm.f: option 'inf' must be a number > 0 (got inf)", options.positive, t, "inf", "dm.f")
tap.ok(options.fraction(t, "x", "dm.f") == 0.5, "a fraction")
says("dm.f: option 'n' must be a number between 0 and 1 (got 3)", options.fraction, t, "n", "dm.f")
tap.ok(options.callable(t, "f", "dm.f") == print, "a function")
says("dm.f: option 'n' must be a function of (q, t) (got 3)",
  options.callable, t, "n", "dm.f", "(q, t)")
tap.ok(options.text(t, "text", "dm.f") == "up", "a text")
says("dm.f: option 'f' must be a string (got function)", options.text, t, "f", "dm.f")
tap.ok(options.list(t, "list", "dm.f", "rules") == t.list, "a list")
says("dm.f: option 'empty' must be a list of rules (got table)",
  options.list, t, "empty", "dm.f", "rules")
tap.ok(options.one_of(t, "text", "dm.f", { "up", "down" }) == "up", "one of a few")
tap.ok(options.one_of(t, "none", "dm.f", { "up", "down" }, "down") == "down",
  "or what stands for none")
says('dm.f: option \'n\' must be "up", "down" or "both" (got 3)',
  options.one_of, t, "n", "dm.f", { "up", "down", "both" })
says("dm.f: option 'h' is missing: a step > 0", options.need, t, "h", "dm.f", "a step > 0")
tap.ok(options.need(t, "zero", "dm.f", "a number") == 0, "what is needed and there comes back")
says("dm.f: option 'q' must be a point (got dm.vector)",
  options.demand, false, { q = dm.vector { 1 } }, "q", "dm.f", "a point")

----- whose line ----
local verb = blame.caller(function(o) options.check(o, KNOWN, "dm.f") end)
local here = debug.getinfo(1, "l").currentline + 1
local _, message = pcall(function() verb { steps_ = 1 } end)
tap.ok(message:find(("test_options.lua:%d: dm.f: unknown option"):format(here), 1, true) ~= nil,
  "an error names the line of the caller", message)

----- what is tried: a stop, by Ctrl-C or a deadline, passes -----
local stopped = setmetatable({ code = "stopped" }, { __tostring = function() return "stop" end })
tap.raises("interrupted!", blame.try, error, "scene.lua:1: interrupted!", 0)
tap.raises("stop", blame.try, error, stopped)
tap.ok(not blame.try(error, "no convergence") and not blame.try(error, { code = "not_finite" })
  and select(2, blame.try(math.max, 1, 7)) == 7, "all else is tried")
local solver = dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 / 2 end }
  :solver { rule = "verlet", h = 1e-9 }
local ended, why = require "dm.core".within(0.01, blame.try, solver.run, solver,
  { q = { 0 }, v = { 1 }, steps = 10 ^ 9, every = 10 ^ 9 })
tap.ok(not ended and why.code == "stopped", "also that of a deadline", tostring(why))
tap.raises("dm.f: 3 of 4", options.failing "dm.f", "%d of %d", 3, 4)
tap.done()
