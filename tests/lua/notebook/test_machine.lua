-- dmlua --machine: cells as frames of JSON; what is printed stays apart; pictures inline
local tap = require "tap"
require "dm"
local json = require "dm.base.json"
local ok, raises = tap.ok, tap.raises
local dmlua = os.getenv "DMLUA" or arg[-1]

---- JSON ----

local function back(value) return json.decode(json.encode(value)) end
ok(back { "a\"\\\n</script>\0é", 1, 2.5, true, { x = { 1, {} }, y = -1e300 } }[1] == "a\"\\\n</script>\0é", "texts come back")
ok(back { 0.1, -1e300 }[1] == 0.1 and back { 0.1, -1e300 }[2] == -1e300, "numbers too, to the bit")
ok(json.encode { 0 / 0, 1 / 0 } == "[null,null]", "what is not finite is null")
ok(not json.encode("</script>"):find "<", "nothing ends a script element")
ok(json.decode [[ {"a" : [1 , {"b":null,"c":"\ud83d\ude00\u00e9\/"}] } ]].a[2].c == "😀é/", "escapes")
for _, text in ipairs { "", "{", "[1,", "[1 2]", '{"a" 1}', "{a:1}", '"\\x"', '"\\u12"', '"open', "tru", "1 2", "-", "[" } do
  raises("JSON", function() json.decode(text) end, "refused: " .. text)
end
raises("nesting", function() json.decode(("["):rep(1000)) end, "deep nesting")

---- a session of frames ----

local name = os.tmpname()
local function session(requests)
  local f <close> = assert(io.open(name, "w"))
  for _, request in ipairs(requests) do
    if type(request) == "string" and request:find "^raw " then
      f:write(request:sub(5), "\n")
    else
      f:write(json.encode(type(request) == "string" and { op = "execute", code = request } or request), "\n")
    end
  end
  f:close()
  local command = ("'%s' --machine=0,3 <'%s' 3>'%s.frames' 2>&1"):format(dmlua, name, name)
  local pipe = io.popen(command)
  local printed = pipe:read "a"
  local fine = pipe:close()
  local frames = {}
  for line in io.lines(name .. ".frames") do frames[#frames + 1] = json.decode(line) end
  os.remove(name .. ".frames")
  return frames, printed, fine
end
local function results(...)
  local frames, printed = session { ... }
  local out = {}
  for _, frame in ipairs(frames) do
    if frame.event ~= "done" then out[#out + 1] = frame end
  end
  return out, printed
end

local got, printed = results("6*7", "x = 5\ny = x^2\ny + 1,\n x", "x = 1;", "x;", 'print "hi"; os.execute "echo there"', "_", "#out", "=x")
ok(got[1].text == "42" and got[1].event == "result", "an expression")
ok(got[2].text == "26.0\t5", "the last lines are one", got[2].text)
ok(got[3].text == "1" or got[3].text == "42", "_ is the last result", got[3].text)
ok(printed == "hi\nthere\n", "what is printed, by children too, goes to stdout", printed)
got = results("local a = 1\nlocal b = a +\n 2\nno_such(b)", "x = = 1", "error { 1 }", "for i = 1, 2 do", "error('é')")
ok(#got == 5 and got[1].event == "error" and got[1].text:find "cell:4" and got[1].text:find "no_such", "an error has its line", got[1].text)
ok(got[2].text:find "cell:1" and got[4].text:find "'end' expected", "syntax", got[4].text)
ok(#got[1].lines > 1, "a traceback")
got, printed = results("?dm.vector", "dm.vector?", "!echo shell", "!exit 3")
ok(select(2, printed:gsub("dm.vector%(", "")) >= 2 and printed:find "shell", "?x, x? and !command")
ok(got[1].event == "error" and got[1].text:find "3", "a command that fails says so", got[1].text)
got = results({ op = "execute", code = 'a, b = io.read("n", "l")' }, { op = "input", text = "21" }, { op = "input", text = "text" },
  "a*2, b", "io.read(2)", { op = "input", text = "abc" }, "io.read('x')", { op = "input", text = "" })
ok(got[1].event == "input" and got[3].text == '42\t"text"' or got[3].text == "42\ttext", "io.read asks", got[3].text)
ok(got[5].text:find "ab" and not got[5].text:find "abc", "for letters too", got[5].text)
ok(got[7].event == "error" and got[7].text:find "format", "a format that is none", got[7].text)

local SWING = [[s = dm.system { Q = dm.R(1), coordinates = { "theta" }, L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
p = s:solver { rule = "verlet", h = 0.05 }:run { q = {2}, v = {0}, t = 20 };]]
got = results(SWING, 'p:plot("t", "theta")', "dm.plot(p.t, p:energy())", "p:animate()", "p:plot('t', 'theta', { file = 'no/where.svg' })",
  "s:solver { rule = 'verlet', h = 0.05 }:run { q = {0/0}, v = {0}, steps = 3 }")
ok(got[1].event == "display" and got[1].type == "image/svg+xml" and got[1].content:find "<svg", "a plot inline")
ok(got[2].type == "image/svg+xml", "columns of a path are plotted")
ok(got[3].type == "text/html" and got[3].content:find "<html" and got[3].content:find "Space: pause", "an animation inline")
ok(got[4].event == "error" and got[4].text:find "where", "a file that cannot be written", got[4].text)
ok(got[5].event == "error", "a run that fails", got[5].text)
got = results("x, y = {}, {}; for i = 1, 6000 do x[i], y[i] = i, math.sin(i) end", "dm.plot(x, y)")
ok(got[1].type == "image/png" and got[1].content:find "^iVBOR", "many points are a PNG")

---- what a front end asks; what is no request ----

local frames = session { { op = "complete", code = "dm.syst" }, { op = "complete", code = 'x = "no' }, { op = "inspect", code = "dm.system{", at = 10 },
  { op = "inspect", code = "nothing_here", at = 5 }, { op = "whole", code = "for i = 1, 2 do" }, { op = "whole", code = "x = = 1" },
  { op = "whole", code = "6*7" }, { op = "fly" }, "raw junk", "raw 7", { op = "inspect", code = "dm.R", at = 1e300 } }
ok(frames[1].words[1] == "system" and frames[1].first == 3, "completion")
ok(frames[2].files == true, "names of files in a string")
ok(frames[3].found and frames[3].text:find "dm.system{", "inspection, behind a brace too")
ok(frames[4].found == false, "of nothing")
ok(frames[5].status == "incomplete" and frames[6].status == "invalid" and frames[7].status == "complete", "is a cell whole?")
ok(frames[8].event == "wrong" and frames[9].event == "wrong" and frames[10].event == "wrong" and #frames == 11, "what is no request is told")
os.remove(name)
local pipe = io.popen(("'%s' --machine=77,x 2>&1"):format(dmlua))
ok(pipe:read("a"):find "descriptors" and not pipe:close(), "descriptors that are none")

tap.done()
