--- The file of a journal: finished ranges of members, each a record that says itself whether it is
-- whole. docs/sweeps.md describes it for other programs; all numbers are little-endian.
--   "dmjournl", size of the text (u32), the text ("key = value" lines), CRC-32 of all before (u32)
--   records: "dmrecord", first member (u64, from 1), count (u64), size (u64), bytes, CRC-32 of all
--   of that (u32). The bytes of a member are its length (u32) and so many bytes.
-- What is damaged or cut off is passed over: the next record is found by its word.
local core = require "dm.core"
local option = require "dm.base.options"

local M = { HEAD = "dmjournl" }

local HEAD, RECORD = M.HEAD, "dmrecord"
local PIECE = 1 << 24 -- bytes that are read at a time where records are sought
local SYNC = 2        -- s between waits for the disk
local MOST = 1 << 53  -- members of a sweep: sums of their numbers are whole

local fail = option.fail

---- the text of the head ----

local function one_line(value) return (tostring(value):gsub("\n", " ")) end

--- Of a list of { key, value }: values are texts of one line.
function M.text(head)
  local lines = {}
  for i, entry in ipairs(head) do
    lines[i] = entry[1] .. " = " .. one_line(entry[2]) .. "\n"
  end
  return table.concat(lines)
end

local function read_text(text)
  local head = {}
  for key, value in text:gmatch "([^\n]-) = ([^\n]*)\n" do
    head[#head + 1], head[key] = { key, value }, value
  end
  return head
end

local function packed_head(head)
  local text = M.text(head)
  local bytes = HEAD .. ("<s4"):pack(text)
  return bytes .. ("<I4"):pack(core.crc32(bytes))
end

-- the head and where records begin, or nothing: not a whole one
local function read_head(file)
  local start = file:read(0, 12)
  if start:sub(1, 8) ~= HEAD or #start < 12 then return nil end
  local size = ("<I4"):unpack(start, 9)
  if size > file:size() then return nil end
  local rest = file:read(12, size + 4)
  if #rest < size + 4 then return nil end
  if core.crc32(start .. rest:sub(1, size)) ~= ("<I4"):unpack(rest, size + 1) then return nil end
  local head = read_text(rest:sub(1, size))
  local members = head.kind and math.tointeger(tonumber(head.members))
  if not members or members < 1 or members > MOST then return nil end
  return head, 12 + size + 4
end

--- The first entry in which two heads differ, or nothing.
function M.difference(a, b)
  for i = 1, math.max(#a, #b) do
    local x, y = a[i] or { "nothing", "" }, b[i] or { "nothing", "" }
    if x[1] ~= y[1] then return ("%s and %s"):format(x[1], y[1]), x[2], y[2] end
    if one_line(x[2]) ~= one_line(y[2]) then return x[1], x[2], y[2] end
  end
end

---- records ----

local FIXED = 8 + 3 * 8 -- bytes before those of the members

-- the whole record at an offset: first, count, size; or nothing
local function record_at(file, at, size)
  local start = file:read(at, FIXED)
  if #start < FIXED or start:sub(1, 8) ~= RECORD then return nil end
  local first, count, bytes = ("<i8i8i8"):unpack(start, 9)
  if bytes < 0 or bytes > size - at - FIXED - 4 then return nil end
  if first < 1 or first > MOST or count < 1 or count > bytes // 4 then return nil end
  local sum, done = core.crc32(start), 0
  while done < bytes do
    local piece = file:read(at + FIXED + done, math.min(PIECE, bytes - done))
    if #piece == 0 then return nil end
    sum, done = core.crc32(piece, sum), done + #piece
  end
  local last = file:read(at + FIXED + bytes, 4)
  if #last < 4 or ("<I4"):unpack(last) ~= sum then return nil end
  return first, count, bytes
end

-- where the word of a record stands from `at` on, or nothing
local function next_word(file, at, size)
  while at < size do
    local piece = file:read(at, PIECE)
    local found = piece:find(RECORD, 1, true)
    if found then return at + found - 1 end
    if #piece < PIECE then return nil end
    at = at + PIECE - #RECORD + 1
  end
end

-- records of a file { first, count, at, size }, and the bytes that are none
local function read_records(file, at)
  local records, size, damaged = {}, file:size(), 0
  while at and at < size do
    local first, count, bytes = record_at(file, at, size)
    if first then
      records[#records + 1] = { first = first, count = count, at = at + FIXED, size = bytes }
      at = at + FIXED + bytes + 4
    else
      local found = next_word(file, at + 1, size)
      damaged = damaged + (found or size) - at
      at = found
    end
  end
  return records, damaged
end

--- Records of several files by their first member, long ones first: { r = record, j = its file }.
function M.ordered(files)
  local all = {}
  for _, j in ipairs(files) do
    for _, r in ipairs(j.records) do all[#all + 1] = { r = r, j = j } end
  end
  table.sort(all, function(a, b)
    if a.r.first ~= b.r.first then return a.r.first < b.r.first end
    return a.r.count > b.r.count
  end)
  return all
end

--- Ranges { first, last } of the members `first` to `last` that no ordered record has.
function M.gaps(ordered, first, last)
  local out, at = {}, first
  for _, x in ipairs(ordered) do
    local from, to = x.r.first, x.r.first + x.r.count - 1
    if from > last then break end
    if from > at then out[#out + 1] = { at, from - 1 } end
    at = math.max(at, to + 1)
  end
  if at <= last then out[#out + 1] = { at, last } end
  return out
end

--- How many members ranges have.
function M.count_in(ranges)
  local sum = 0
  for _, range in ipairs(ranges) do sum = sum + range[2] - range[1] + 1 end
  return sum
end

---- reading ----

--- What is in a file: { head, records, damaged (bytes), file }; nil, why: it is none.
function M.read(name, writes)
  local file, why = core.journal_file(name, writes)
  if not file then return nil, why end
  local head, at = read_head(file)
  if not head then
    local empty = file:size() == 0
    if not (empty and writes) then
      file:close()
      return nil, empty and "empty" or "not a journal, or its head is damaged"
    end
    return { file = file, records = {}, damaged = 0, name = name }
  end
  local records, damaged = read_records(file, at)
  return { file = file, head = head, records = records, damaged = damaged, name = name }
end

-- are these the bytes of so many members?
local function are_members(bytes, count)
  local at = 1
  for _ = 1, count do
    if at + 3 > #bytes then return false end
    at = at + 4 + ("<I4"):unpack(bytes, at)
  end
  return at == #bytes + 1
end

--- The bytes of a record; raises where they are not those of its members.
function M.bytes(j, record)
  local bytes = j.file:read(record.at, record.size)
  if are_members(bytes, record.count) then return bytes end
  fail("journal", "%s: members %d to %d have other lengths than their record: remove the file",
    j.name, record.first, record.first + record.count - 1)
end

--- For every member of these bytes: its number, and its own bytes without their length.
function M.members(record, bytes)
  local at, i = 1, record.first - 1
  return function()
    if i >= record.first + record.count - 1 then return nil end
    i = i + 1
    local one
    one, at = ("<s4"):unpack(bytes, at)
    return i, one
  end
end

---- writing ----

local function check(j, fine, why)
  if not fine then fail(j.where, "%s: %s", j.name, why) end
end

--- Begin a file that was empty, or leave it as it is.
function M.begin(j, head)
  if j.head then return end
  j.head = head
  check(j, j.file:append(packed_head(head)))
end

--- Add members first ...; it is on the disk at the latest after SYNC seconds, or after M.flush.
function M.add(j, first, count, bytes)
  local start = RECORD .. ("<i8i8i8"):pack(first, count, #bytes)
  local sum = ("<I4"):pack(core.crc32(bytes, core.crc32(start)))
  check(j, j.file:append(start, bytes, sum)) -- one call: a signal comes before it or after it
  j.waiting = true
  if not j.synced or core.clock() - j.synced > SYNC then M.flush(j) end
end

--- What was added is on the disk.
function M.flush(j)
  if not j.waiting then return end
  check(j, j.file:sync())
  j.waiting = false
  j.synced = core.clock()
end

--- Write a whole new file of these members, ascending, in records of `each` members: source() gives
-- number and bytes.
function M.write(j, head, each, source)
  M.begin(j, head)
  local first, count, pieces
  local function put()
    if count and count > 0 then M.add(j, first, count, table.concat(pieces)) end
    first, count, pieces = nil, 0, {}
  end
  put()
  for i, bytes in source do
    if count == each or first and i ~= first + count then put() end
    first, count = first or i, count + 1
    pieces[count] = ("<s4"):pack(bytes)
  end
  put()
  M.flush(j)
end

return M
