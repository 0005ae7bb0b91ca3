-- path:csv, path:npy and dm.load: the same bits come back, the formats are what others expect, misuse
local tap = require "tap"
local dm = require "dm"
local export = require "dm.data.export"
local ok, raises = tap.ok, tap.raises

local function bits(x) return ("<d"):pack(x) end
local function slurp(file)
  local f = assert(io.open(file, "rb"))
  local text = f:read "a"
  f:close()
  return text
end
local function spit(file, text)
  local f = assert(io.open(file, "wb"))
  f:write(text)
  f:close()
  return file
end
local base = os.tmpname()
local csv, npy = base .. ".csv", base .. ".npy"

local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local path = kepler:solver { rule = "verlet", h = 0.1 }:run { q = { 0.4, 0 }, v = { 0, 2 }, steps = 3000 }

local function same_columns(data, what)
  local same = #data.columns == #path.columns
  for i, name in ipairs(path.columns) do
    local a, b = path:column(name), data[name]
    same = same and data.columns[i] == name and #a == #b
    for k = 1, #a do same = same and bits(a[k]) == bits(b[k]) end
  end
  ok(same, what)
end

-- a real path
ok(path:csv(csv) == csv and path:npy(npy) == npy, "csv and npy return the name of the file")
same_columns(dm.load(csv), "csv: names and bits of every column come back")
same_columns(dm.load(npy), "npy: names and bits of every column come back")
ok(path:csv() == slurp(csv), "csv without a name is the text that a file would get")
ok(path:csv():match "^t,q1,q2,p1,p2\n0,0.40000000000000002,0,0,2\n" ~= nil, "csv: line of names, then 17 digits",
  path:csv():sub(1, 60))
local _, lines = path:csv():gsub("\n", "")
ok(lines == #path + 1, "csv: one line a row", lines)

-- npy read independently: magic, version, aligned header, then records
local raw = slurp(npy)
local size = ("<I2"):unpack(raw, 9)
ok(raw:sub(1, 8) == "\147NUMPY\1\0" and (10 + size) % 64 == 0 and raw:sub(10 + size, 10 + size) == "\n",
  "npy: version 1.0, header aligned to 64 bytes")
ok(raw:sub(11, 10 + size):find("'descr': [('t', '<f8'), ('q1', '<f8'), ('q2', '<f8'), ('p1', '<f8'), ('p2', '<f8')]", 1,
  true) ~= nil, "npy: named fields of doubles")
ok(raw:find("'shape': (3001,)", 1, true) ~= nil and #raw == 10 + size + 3001 * 40, "npy: as many records as rows")
ok(("<d"):unpack(raw, 11 + size + 40 * 1000 + 8) == path.q[1001][1], "npy: row 1001, field q1 where it should be")

-- awkward numbers and names
local awkward = { 0.1, -0.0, 1e308, 5e-324, 1 / 3, 2 ^ 53 + 2, -1e16, math.pi, 1e-310 }
local fake = setmetatable({ columns = { 'a "b", c', "θ", "back\\slash'" }, column = function(self, name)
  return name == "θ" and { table.unpack(awkward, 1) } or awkward
end }, { __len = function() return #awkward end })
for _, case in ipairs { { "csv", csv }, { "npy", npy } } do
  export[case[1]](fake, case[2])
  local data, same = dm.load(case[2]), true
  for i, name in ipairs(fake.columns) do
    same = same and data.columns[i] == name
    for k, x in ipairs(awkward) do same = same and bits(data[name][k]) == bits(x) end
  end
  ok(same, case[1] .. ": quotes, commas, Greek letters, -0.0, subnormal and huge numbers come back", data.columns[1])
end
ok(slurp(npy):sub(1, 8) == "\147NUMPY\3\0" and (12 + ("<I4"):unpack(slurp(npy), 9)) % 64 == 0,
  "npy: version 3.0 when a name is not ASCII")

-- files of others
local data = dm.load(spit(csv, "t,x\r\n1,2.5\r\n\r\n3, nan\r\n-inf,1e3\r\n"))
ok(#data.t == 3 and data.x[1] == 2.5 and data.x[2] ~= data.x[2] and data.t[3] == -math.huge,
  "csv with carriage returns, an empty line, nan and inf")
raises("line 3, column x: -1e400 is beyond the largest number", dm.load,
  spit(csv, "t,x\n1,1e308\n2,-1e400\n"))
for _, text in ipairs { "t\tx\n1\t2\n3\t4\n", "t x\n1 2\n3 4\n", "t;x\n1;2\n3;4\n", "# by hand\nt,x\n1,2\n\n3,4\n",
  "\239\187\191t,x\n1,2\n3,4\n", "# t x\n1 2\n3 4\n", "  t    x \n  1    2 \n# between\n  3 4\n", "#\n# t, x\n1,2\n3,4",
  "\"t\" x\r\n1\t2\r\n3\t4\r\n", "\239\187\191# t;x\n1;2\n3;4\n" } do
  data = dm.load(spit(csv, text))
  ok(#data.columns == 2 and data.t and #data.t == 2 and data.t[1] == 1 and data.x[2] == 4, ("a text as %q"):format(text:sub(1, 9)))
end
for _, text in ipairs { "1,2\n3,4\n", " 1 2\n 3 4\n", "1\t2\n3\t4", "# one\n1;2\n3;4\n", "# 1 2\n1 2\n3 4\n" } do
  data = dm.load(spit(csv, text))
  ok(table.concat(data.columns, " ") == "c1 c2" and #data.c1 == 2 and data.c1[1] == 1 and data.c2[2] == 4,
    ("numbers without names keep their first row: %q"):format(text:sub(1, 9)))
end
data = dm.load(spit(csv, "angle (deg)\n-0\n2\n"))
ok(data.columns[1] == "angle (deg)" and 1 / data["angle (deg)"][1] == -math.huge, "one column, its name with blanks")
data = dm.load(spit(csv, "t, angle in deg\n1,2\n"))
ok(data["angle in deg"][1] == 2, "names with blanks between commas")
data = dm.load(spit(csv, "t,columns\n0,5\n1,7\n"))
ok(data.columns[2] == "columns_" and data.columns_[2] == 7, "a column of the name columns is not lost", data.columns)
data = dm.load(spit(csv, "columns_,columns\n3,5\n"))
ok(data.columns_[1] == 3 and data.columns__[1] == 5 and data.columns[2] == "columns__", "nor beside one of the other name")
data = dm.load(spit(csv, "t,x\n"))
ok(#data.t == 0 and #data.x == 0, "names without rows")
raises("line 2, column c2: nothing is there: the line has 1 field, the first one 2", dm.load, spit(csv, "1;2\n3\n"))
raises("line 1, column c3: not a number: nothing is there; where one is missing write nan", dm.load, spit(csv, "1,2,\n3,4,5\n"))
raises("line 3, column c2: not a number", dm.load, spit(csv, "# data\n1 2\n3 x\n"))
-- a first row with a fault is not taken for names
raises('line 1: "1.O5" is no number, and 1.0 no name', dm.load, spit(csv, "1.0,1.O5\n2,3\n"))
raises('line 2: "N/A" is no number', dm.load, spit(csv, "# day\n1;N/A\n2;3\n"), { names = { "t", "x" } })
data = dm.load(spit(csv, "1.0D+00 2.5d-3\n-3D0 1.5-103\n"))
ok(data.c1[1] == 1 and data.c2[1] == 2.5e-3 and data.c1[2] == -3 and data.c2[2] == 1.5e-103,
  "exponents of Fortran, with D and without a letter, are numbers, in the first row too")
ok(dm.load(spit(csv, "1,5D-2 2,0D0\n")).c1[1] == 1.5e-2, "with a decimal comma too")
data = dm.load(spit(csv, '"year","2020"\n1,2\n'))
ok(data["2020"][1] == 2, "a number in quotes is a name")
raises("two columns are called 't'", dm.load, spit(csv, "t,t\n1,2\n"))
raises("is empty", dm.load, spit(csv, "# nothing\n\n"))
raises("save it as UTF-8", dm.load, spit(csv, "\255\254t\0,\0x\0\n\0"))
local plain = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }"
spit(npy, "\147NUMPY\1\0" .. ("<s2"):pack(plain) .. ("<dddddd"):pack(1, 2, 3, 4, 5, 6))
data = dm.load(npy)
ok(#data.columns == 3 and data.c2[1] == 2 and data.c3[2] == 6, "a plain 2-D array: columns c1, c2, c3")

-- misuse
raises("cannot open", path.csv, path, "/no/such/folder/a.csv")
raises("file name", path.npy, path)
raises("file name", path.csv, path, {})
raises("cannot open", dm.load, base .. ".absent")
raises("cannot read /tmp: Is a directory", dm.load, "/tmp")
for _, device in ipairs { "/dev/zero", "/dev/full", "/dev/null" } do
  raises("cannot read " .. device .. ": it is a device", dm.load, device)
  raises("it is a device", dm.resume, device, dm.system { Q = dm.R(1), L = function(_, v) return v[1] ^ 2 end })
end
do -- a pipe is read from its first byte to its end
  local pipe = base .. ".pipe"
  os.execute(("mkfifo %s && (printf 't,x\\n1,2\\n3,4\\n' > %s) &"):format(pipe, pipe))
  repeat local there = os.execute("test -p " .. pipe) until there
  local data = dm.load(pipe)
  ok(table.concat(data.columns, " ") == "t x" and data.t == dm.vector { 1, 3 } and data.x == dm.vector { 2, 4 }, "a pipe is read whole", data.columns)
  os.remove(pipe)
end
raises("file name", dm.load, 7)
raises("is empty", dm.load, spit(csv, ""))
-- what looks like numbers and would be a name without rows; lines that end in no newline
for _, text in ipairs { "1\u{a0}2\n", "1\u{a0}2\n3\u{a0}4\n", "1\xa02\n", "\u{2212}2\n", "1\u{2009}2,5\n", "1,\u{2212}2\n3,4\n" } do
  raises("line 1: not a number: ", dm.load, spit(csv, text))
end
raises('line 2, column a: not a number: "3\u{a0}4" (a sign in it', dm.load, spit(csv, "a\n3\u{a0}4\n"))
raises('write it as "-2"', dm.load, spit(csv, "1,\u{2212}2\n"))
ok(dm.load(spit(csv, "T\u{a0}in\u{a0}K,p\n1,2\n"))["T\u{a0}in\u{a0}K"][1] == 1, "names may hold any blank")
raises("line 1: a carriage return inside of it", dm.load, spit(csv, "1,2\r3,4\r"))
raises("line 1: a carriage return inside of it", dm.load, spit(csv, "a,b\r1,2\r3,4\r"))
local pages = dm.load(spit(csv, "\f1 2\n\f3 4\n5 6\n"))
ok(#pages.c1 == 3 and pages.c1[1] == 1 and pages.c1[2] == 3, "a form feed before a line begins a page")
raises("line 2: control character 12 inside of it", dm.load, spit(csv, "1 2\n3\f4\n"))
ok(#dm.load(spit(csv, "a,b\r\r\n1,2\r\r\n")).a == 1, "at the end of a line they are none of it")
raises('xxx..."', dm.load, spit(csv, "a\n" .. ("x"):rep(1e6)))
raises("line 3, column x: not a number", dm.load, spit(csv, "t,x\n1,2\n3,oops\n"))
raises("line 2, column 3: one too many: the line has 3 fields", dm.load, spit(csv, "t,x\n1,2,3\n"))
local said = dm.load(spit(csv, "1 2 # the first\n3 4\t# and more\n"))
ok(#said.columns == 2 and said.c2[2] == 4, "comments behind numbers")
raises("quote is not closed", dm.load, spit(csv, 'a,"b\n1,2\n'))
raises("not an npy file", dm.load, spit(npy, "t,x\n"))
raises("ends inside the header", dm.load, spit(npy, "\147NUMPY\1\0"))
raises("ends at row 2", dm.load, spit(npy, "\147NUMPY\1\0" .. ("<s2"):pack(plain) .. ("<dddd"):pack(1, 2, 3, 4)))
local killed = dm.load(spit(npy, "\147NUMPY\1\0" .. ("<s2"):pack(plain) .. ("<ddddddd"):pack(1, 2, 3, 4, 5,
  6, 7)))
ok(#killed.c1 == 2, "of a run that was killed while it wrote: the rows that its header counts", #killed.c1)
local full = io.open("/dev/full", "w")
if full then
  full:close()
  raises("cannot write /dev/full", path.csv, path, "/dev/full")
end
for _, name in ipairs { base, csv, npy } do os.remove(name) end

---- texts of others: what stands between fields, decimal commas, names ----

local function loaded(text, given)
  local name = os.tmpname()
  local f <close> = assert(io.open(name, "w"))
  f:write(text)
  f:flush()
  local fine, data = pcall(dm.load, name, given)
  os.remove(name)
  return fine and data, data
end
for what, case in pairs {
  ["blanks"] = { "0 1.5\n2 -300\n", "c1 c2" }, ["a comment"] = { "# made by hand\n# t  x\n0 1.5\n\n2 -3e2\n", "t x" },
  ["tabs"] = { "t\tx\n0\t1.5\n2\t-300\n", "t x" }, ["semicolons and commas"] = { "t;x\n0;1,5\n2;-300\n", "t x" },
  ["blanks and commas"] = { "0 1,5\n2 -300,0\n", "c1 c2" }, ["tabs and commas"] = { "0\t1,5\n2\t-3e2\n", "c1 c2" },
  ["names with blanks"] = { "the t,x\n0,1.5\n2,-300\n", "the t x" }, ["commas"] = { "0,1.5\n2,-300\n", "c1 c2" },
  ["commas and blanks"] = { "0, 1.5\n2, -300\n", "c1 c2" }, ["quotes"] = { '"t";"x"\n"0";"1,5"\n"2";"-300,0"\n', "t x" },
} do
  local data, why = loaded(case[1])
  local c = data and data.columns
  ok(data and table.concat(c, " ") == case[2] and data[c[1]][2] == 2 and data[c[2]][1] == 1.5 and data[c[2]][2] == -300, "dm.load: " .. what, why)
end
local data = loaded("head\nmore\n1;2,5\n", { skip = 2, names = { "a", "b" } })
ok(data and data.a[1] == 1 and data.b[1] == 2.5, "skip and names")
data = loaded("x y\n1 2\n", { names = { "a", "b" } })
ok(data and data.a[1] == 1 and not data.x, "names in place of those of the file")
data = loaded("1,5 2\n3 4,5\n", { decimal = "," })
ok(data and data.c1[1] == 1.5 and data.c2[2] == 4.5, "decimal comma, given")
data = loaded("1,5\n2,5\n", { separator = "," })
ok(data and data.c2[2] == 5 and data.c1[2] == 2, "separator, given")
for wrong, case in pairs { ["line 3"] = { "0 1\n1 2\n3\n" }, ["must be 2 texts"] = { "0 1\n", { names = { "a" } } }, ["separator"] = { "1", { separator = "x" } },
  ["decimal"] = { "1", { decimal = ";" } }, ["skip"] = { "1", { skip = -1 } }, ["unknown option 'sep'"] = { "1", { sep = "," } },
  ["line 2, column c1: not a number"] = { "0 1\nx 2\n" } } do
  local fine, why = loaded(case[1], case[2])
  ok(not fine and why:find(wrong, 1, true), "refused: " .. wrong, why)
end

tap.done()
