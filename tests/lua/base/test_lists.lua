-- Lists: what counts as one, and numbers that are checked.
local tap = require "tap"
local dm = require "dm"
local lists = require "dm.base.lists"
local ok = tap.ok

ok(lists.count { 1, 2 } == 2 and lists.count(dm.vector { 1, 2, 3 }) == 3, "tables and vectors are lists")
ok(lists.count "abc" == nil and lists.count(3) == nil and lists.count(nil) == nil, "texts and numbers are none")
ok(lists.got { 1, 2 } == 2 and lists.got "ab" == "string", "what was given, in a word")
ok(#lists.entries(3) == 1 and lists.entries(dm.vector { 4, 5 })[2] == 5, "a number is a list of one entry")
ok(lists.part({ 1, 2, 3, 4 }, 1, 2) == dm.vector { 2, 3 }, "a part of a list")
ok(lists.joined({ 1 }, dm.vector { 2, 3 }) == dm.vector { 1, 2, 3 }, "two lists joined")
local given = { a = 1 }
local copy = lists.copy(given)
copy.a = 2
ok(given.a == 1 and #lists.zeros(3) == 3 and lists.zeros(3)[3] == 0, "a copy is another table")
local TEXT = "%s must be %d number%s (got %s)"
ok(lists.numbers("x", 3, 1, TEXT) == dm.vector { 3 }, "a number is a point of one coordinate")
local function says(text, x, count)
  local fine, message = pcall(lists.numbers, "x", x, count, TEXT)
  ok(not fine and message == text, "'" .. text .. "'", message)
end
says("x must be 2 numbers (got 3)", { 1, 2, 3 }, 2)
says("x must be 1 number (got string)", "1", 1)
says("x must be 2 numbers (got something else)", { 1, "b" }, 2)
says("x: entry 2 is inf, but must be finite", { 1, math.huge }, 2)
tap.done()
