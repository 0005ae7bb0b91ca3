-- arrays of NumPy: numbers of every length, bytes and rows in both orders, records; what is not
-- read says what to save. The bytes are written by hand, as the format's description has them.
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local base = os.tmpname()
local file = base .. ".npy"

local function written(descr, order, shape, data, name)
  local text = ("{'descr': %s, 'fortran_order': %s, 'shape': %s, }"):format(descr, order, shape)
  text = text .. (" "):rep(-(#text + 11) % 64) .. "\n"
  local handle <close> = assert(io.open(name or file, "wb"))
  handle:write("\147NUMPY\1\0", ("<s2"):pack(text), data)
  return name or file
end
local function packed(format, list)
  local out = {}
  for i, x in ipairs(list) do out[i] = format:pack(x) end
  return table.concat(out)
end
local function is(data, wanted, what)
  local fine = #data.columns == #wanted
  for c, list in ipairs(wanted) do fine = fine and data["c" .. c] == dm.vector(list) end
  ok(fine, what, dm.pretty(data))
end

-- every type, by rows and by columns
for kind, format in pairs { ["<f8"] = "<d", [">f8"] = ">d", ["<f4"] = "<f", [">f4"] = ">f", ["|i1"] = "i1", ["|u1"] = "I1",
  ["<i2"] = "<i2", [">i2"] = ">i2", ["<u2"] = "<I2", ["<i4"] = "<i4", [">i4"] = ">i4", ["<u4"] = "<I4", ["<i8"] = "<i8",
  [">i8"] = ">i8", ["<u8"] = "<I8", ["=i4"] = "<i4" } do
  local rows, columns = packed(format, { 1, 2, 3, 4, 5, 120 }), packed(format, { 1, 4, 2, 5, 3, 120 })
  is(dm.load(written("'" .. kind .. "'", "False", "(2, 3)", rows)), { { 1, 4 }, { 2, 5 }, { 3, 120 } }, kind .. " in C order")
  is(dm.load(written("'" .. kind .. "'", "True", "(2, 3)", columns)), { { 1, 4 }, { 2, 5 }, { 3, 120 } }, kind .. " in Fortran order")
  is(dm.load(written("'" .. kind .. "'", "True", "(6,)", rows)), { { 1, 2, 3, 4, 5, 120 } }, kind .. ", one column")
end
is(dm.load(written("'<f4'", "False", "(2,)", packed("<f", { -0.5, 2 ^ -20 }))), { { -0.5, 2 ^ -20 } }, "floats are exact")
is(dm.load(written("'<i8'", "False", "(2,)", packed("<i8", { -2 ^ 53 | 0, 2 ^ 53 | 0 }))), { { -2 ^ 53, 2 ^ 53 } }, "so are integers up to 2^53")
is(dm.load(written("'|b1'", "False", "(3,)", "\1\0\1")), { { 1, 0, 1 } }, "true is 1, false 0")
is(dm.load(written("'<f8'", "False", "()", ("<d"):pack(7))), { { 7 } }, "a single number")
ok(#dm.load(written("'<i4'", "True", "(0, 2)", "")).c2 == 0, "no rows")
local wide = {}
for i = 1, 250 do wide[i] = i end
local data = dm.load(written("'<i4'", "False", "(1, 250)", packed("<i4", wide)))
ok(#data.columns == 250 and data.c101[1] == 101 and data.c250[1] == 250, "more columns than one call of unpack takes")
data = dm.load(written("'>i2'", "True", "(250, 2)", packed(">i2", wide) .. packed(">i2", wide)))
ok(data.c2[250] == 250 and #data.c1 == 250, "and more rows in Fortran order")

-- records, with padding between fields as align = True leaves it
data = dm.load(written("[('n', '|i1'), ('', '|V3'), ('x', '>f4'), ('y', '<i2', (2,)), ('in', '|b1')]", "False", "(2,)",
  packed("i1xxx>f<i2i2I1", {}) .. ("i1xxx>f<i2i2I1"):pack(1, 0.5, 2, 3, 1) .. ("i1xxx>f<i2i2I1"):pack(-4, 1.5, 5, 6, 0)))
ok(table.concat(data.columns, " ") == "n x y in" and data.n == dm.vector { 1, -4 } and data.x == dm.vector { 0.5, 1.5 }
  and data.y == dm.matrix { { 2, 3 }, { 5, 6 } } and data["in"] == dm.vector { 1, 0 }, "records of mixed types", dm.pretty(data))
raises("two fields are called 't'", dm.load, written("[('t', '<f8'), ('t', '<f8')]", "False", "(1,)", ("<dd"):pack(1, 2)))
os.remove(file)
file = base
ok(dm.load(written("'<f4'", "False", "(1,)", ("<f"):pack(2))).c1[1] == 2, "known by its first bytes, whatever its name")

-- what is not read
file = base .. ".npy"
for kind, words in pairs { ["<c16"] = "of type <c16 (complex numbers): save x.real and x.imag", ["<U5"] = "(texts): save numbers",
  ["|O"] = "(Python objects)", ["<f2"] = "another length): save numbers, as x.astype('float64')", ["<M8[ns]"] = "(dates)", ["zz"] = "(unknown)" } do
  raises(words, dm.load, written("'" .. kind .. "'", "False", "(1,)", ("\0"):rep(32)))
  raises("field a is of type " .. kind, dm.load, written("[('a', '" .. kind .. "')]", "False", "(1,)", ("\0"):rep(32)))
end
raises("an array of shape (2, 3, 4), and a table has one entry or two: save x.reshape(2, -1)", dm.load,
  written("'<f8'", "False", "(2, 3, 4)", ("\0"):rep(192)))
raises("holds 9007199254740993, and beyond 2^53", dm.load, written("'<i8'", "False", "(1,)", ("<i8"):pack(2 ^ 53 + 1 | 1)))
raises("holds 18446744073709551615, and beyond 2^53", dm.load, written("'<u8'", "False", "(1,)", ("<i8"):pack(-1)))
raises("ends at row 2 of 2", dm.load, written("'<i4'", "False", "(2,)", "\1\0\0\0\2"))
raises("ends in column 2 of 2", dm.load, written("'<i4'", "True", "(2, 2)", ("\1"):rep(12)))
raises("field a is an array of arrays", dm.load, written("[('a', '<f8', (2, 2))]", "False", "(1,)", ("\0"):rep(32)))
raises("ends inside the first row", dm.load, written("'<f8'", "False", "(1, 999999999)", ("\0"):rep(32)))
raises("impossible shape", dm.load, written("'<f8'", "False", "(99999999999999999999,)", ("\0"):rep(32)))
raises("unknown shape", dm.load, written("'<f8'", "False", "what", ""))
for _, name in ipairs { base, file } do os.remove(name) end

tap.done()
