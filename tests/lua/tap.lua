-- tap.lua - the whole Lua test harness: a line per claim, a plan at the end, exit code 1 on a failure
local M, count, failed = {}, 0, 0

--- watched: do sanitizers or valgrind look on, for whom a few of many like samples are enough?
M.watched = (os.getenv "UNDER" or "") ~= ""

--- samples(n): how many of n random models or starts are tried: a third, under sanitizers and valgrind a
--- tenth, which look for other things; SAMPLES=1 tries all, SAMPLES=0.1 a tenth. At least one
local part = tonumber(os.getenv "SAMPLES") or M.watched and 0.1 or 1 / 3
function M.samples(n)
  return math.max(1, math.floor(n * part + 0.5))
end

--- ok(condition, sentence [, figure]): one claim
function M.ok(condition, sentence, figure)
  count = count + 1
  if not condition then failed = failed + 1 end
  print(("%sok %d - %s"):format(condition and "" or "not ", count, sentence))
  if not condition and figure ~= nil then print("# got: " .. tostring(figure)) end
end

--- near(a, b, tolerance, sentence): |a - b| <= tolerance
function M.near(a, b, tolerance, sentence)
  M.ok(math.abs(a - b) <= tolerance, sentence, ("%.17g against %.17g, off by %.3g"):format(a, b, math.abs(a - b)))
end

--- raises(pattern, f, ...): f(...) raises an error whose text has the plain words of pattern
function M.raises(words, f, ...)
  local fine, message = pcall(f, ...)
  M.ok(not fine and tostring(message):find(words, 1, true) ~= nil, "raises '" .. words .. "'", fine and "no error" or message)
end

--- done(): the plan; ends the script
function M.done()
  print("1.." .. count)
  os.exit(failed == 0, true)
end

return M
