--- Arrays in files of NumPy: a head that tells the type of the numbers, their order and the shape,
-- then their bytes.
local option = require "dm.base.options"

local M = { MAGIC = "\147NUMPY" }

local function fail(file, ...) option.fail("dm.load: " .. file, ...) end

---- the head ----

-- text of the head; the file is left at the first byte of the data
local function head_of(file, handle)
  local head = handle:read(8) or ""
  if head:sub(1, 6) ~= M.MAGIC or #head < 8 then fail(file, "is not an npy file") end
  local format = head:byte(7) == 1 and "<I2" or "<I4"
  local size = handle:read(format:packsize()) or ""
  if #size < format:packsize() then fail(file, "ends inside the header") end
  return handle:read((format:unpack(size))) or ""
end

local MOST = 2 ^ 48 -- rows that a file may say it has

local function whole(file, digits)
  local n = math.tointeger(tonumber(digits))
  if not n or n > MOST then fail(file, "has an impossible shape: %s", digits:sub(1, 40)) end
  return n
end

-- n numbers of so many bytes are in the file
local function check_room(file, n, bytes, handle)
  local at = handle:seek()
  if bytes * n > handle:seek "end" then fail(file, "ends inside the first row of %d numbers", n) end
  handle:seek("set", at)
  return n
end

-- letter and bytes of a number -> its letter for string.unpack; b: 0 or 1
local LETTERS = { f8 = "d", f4 = "f", b1 = "I1", i1 = "i1", i2 = "i2", i4 = "i4", i8 = "i8",
  u1 = "I1", u2 = "I2", u4 = "I4", u8 = "I8" }
local NOT_READ = { f = "floating-point numbers of another length", c = "complex numbers",
  S = "texts", U = "texts", O = "Python objects", M = "dates", m = "durations", V = "records" }

local EXACT = 2 ^ 53  -- integers up to here are doubles

-- how one number is unpacked, its bytes, and the least that it may be where a double does not tell
-- all of that length apart (I8 beyond 2^63 is negative in Lua); padding between fields, |Vn, gives
-- no number
local function item_of(file, kind, what, is_field)
  local order, letter, bytes = kind:match "^([<>|=]?)(%a)(%d*)"
  local unpack = LETTERS[(letter or "") .. (bytes or "")]
  if unpack and kind == order .. letter .. bytes then
    return { format = (order == ">" and ">" or "<") .. unpack, bytes = tonumber(bytes),
      least = bytes == "8" and (letter == "i" and -EXACT or letter == "u" and 0) or nil,
      numbers = 1 }
  end
  if letter == "V" and is_field and #bytes > 0 and #bytes < 6 then
    return { format = ("x"):rep(tonumber(bytes)), bytes = tonumber(bytes), numbers = 0 }
  end
  local is_complex = letter == "c"
  fail(file, "%s of type %s (%s): save %s", what, kind, NOT_READ[letter] or "unknown",
    is_complex and "x.real and x.imag" or "numbers, as x.astype('float64')")
end

-- the fields of records: names, numbers of each in a row (0: one, and no array), items of a row
local function fields_of(file, fields, handle)
  local names, counts, items, seen = {}, {}, {}, {}
  local field = "%((['\"])(.-[^\\])%1, *'(.-)',? *%(?([%d, ]*)%)"
  for _, name, kind, shape in fields:gsub("%(''", "(' '"):gmatch(field) do
    name = name:gsub("\\(.)", "%1")
    local item = item_of(file, kind, ("field %s is"):format(name), name == " ")
    if shape:find "%d+%s*,%s*%d" then fail(file, "field %s is an array of arrays", name) end
    local digits = shape:match "%d+"
    local count = digits and check_room(file, whole(file, digits), item.bytes, handle)
    if item.numbers > 0 then
      if seen[name] then fail(file, "two fields are called '%s'", name) end
      seen[name] = true
      names[#names + 1] = name
      counts[#names] = count or 0
    end
    for _ = 1, count or 1 do items[#items + 1] = item end
  end
  return names, counts, items
end

-- c1, c2, ..., as many as an array has columns
local function columns_of(count)
  local names, counts = {}, {}
  for c = 1, count do names[c], counts[c] = "c" .. c, 0 end
  return names, counts
end

-- the entries of a shape as texts of digits
local function shape_of(file, text)
  local inside, shape = text:match "'shape': *%(([%d, ]*)%)", {}
  if not inside then fail(file, "has an unknown shape") end
  for digits in inside:gmatch "%d+" do shape[#shape + 1] = digits end
  return shape
end

local MOST_COLUMNS = 1000  -- of an array without rows, of which no byte says how many there are

-- a plain array: one column, or as many as the second entry of the shape
local function plain_of(file, kind, shape, handle)
  if #shape > 2 then
    fail(file, "holds an array of shape (%s), and a table has one entry or two: save "
      .. "x.reshape(%s, -1)", table.concat(shape, ", "), shape[1])
  end
  local item = item_of(file, kind, "holds numbers", false)
  local count = shape[2] and whole(file, shape[2]) or 1
  if shape[1] == "0" then
    count = math.min(count, MOST_COLUMNS)
  else
    check_room(file, count, item.bytes, handle)
  end
  local names, counts = columns_of(count)
  return names, counts, item
end

---- the data ----

local AT_ONCE = 100 -- numbers that one call of unpack gives: its results stand on the stack of Lua

-- items -> { format, bytes, numbers, least = { number = ... } } for each call of unpack
local function blocks_of(items)
  local out, at = {}, 1
  while at <= #items do
    local last = math.min(#items, at + AT_ONCE - 1)
    local block, formats = { bytes = 0, numbers = 0, least = {} }, {}
    for i = at, last do
      local item = items[i]
      formats[#formats + 1] = item.format
      block.bytes, block.numbers = block.bytes + item.bytes, block.numbers + item.numbers
      if item.least then block.least[block.numbers] = item.least end
    end
    block.format = table.concat(formats)
    out[#out + 1], at = block, last + 1
  end
  return out
end

-- whole numbers that no double is
local function check_exact(file, part, least)
  for i, from in next, least do
    if not (part[i] >= from and part[i] <= EXACT) then
      fail(file, "holds %s, and beyond 2^53 not every whole number is a double: save what is "
        .. "smaller, as a difference", from == 0 and ("%u"):format(part[i]) or part[i])
    end
  end
end

-- the next line of numbers, or nil where the file ends
local function line_of(file, handle, blocks)
  local out = {}
  for _, block in ipairs(blocks) do
    local bytes = handle:read(block.bytes)
    if not bytes or #bytes < block.bytes then return nil end
    local part = { block.format:unpack(bytes) }
    check_exact(file, part, block.least)
    table.move(part, 1, block.numbers, #out + 1, out)
  end
  return out
end

-- the same item for every number of a line
local function repeated(item, count)
  local items = {}
  for i = 1, count do items[i] = item end
  return blocks_of(items)
end

-- rows that stand one after the other
local function read_rows(file, handle, names, counts, blocks, rows)
  local columns = {}
  for c in ipairs(names) do columns[c] = {} end
  for i = 1, rows do
    local row, at = line_of(file, handle, blocks), 0
    if not row then fail(file, "ends at row %d of %d", i, rows) end
    for c in ipairs(names) do
      local count = counts[c]
      columns[c][i] = count == 0 and row[at + 1] or table.move(row, at + 1, at + count, 1, {})
      at = at + math.max(1, count)
    end
  end
  return columns
end

-- columns that do: Fortran's order
local function read_columns(file, handle, names, item, rows)
  check_room(file, rows, item.bytes, handle)
  local blocks, columns = repeated(item, rows), {}
  for c in ipairs(names) do
    columns[c] = line_of(file, handle, blocks)
    if not columns[c] then fail(file, "ends in column %d of %d", c, #names) end
  end
  return columns
end

--- Names, columns (lists; of a field of arrays lists of lists) and how many numbers each has in a
-- row (0: one, and no array) of an open file.
function M.read(file, handle)
  local text = head_of(file, handle)
  local shape, fields = shape_of(file, text), text:match("'descr': *%[(.-)%], *'fortran")
  local is_columns = text:find "'fortran_order': *True" and #shape == 2
  local rows = whole(file, shape[1] or "1")
  if fields then
    local names, counts, items = fields_of(file, fields, handle)
    if #names == 0 or #shape > 1 then fail(file, "has an unknown shape") end
    return names, read_rows(file, handle, names, counts, blocks_of(items), rows), counts
  end
  local kind = text:match "'descr': *'([^']*)'"
  if not kind then fail(file, "holds neither numbers nor records of them") end
  local names, counts, item = plain_of(file, kind, shape, handle)
  if is_columns then return names, read_columns(file, handle, names, item, rows), counts end
  return names, read_rows(file, handle, names, counts, repeated(item, #names), rows), counts
end

return M
