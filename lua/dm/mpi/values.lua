--- Values as bytes and back, for messages between ranks: nil, booleans, numbers, strings, vectors,
-- matrices and tables of them. The bits of numbers are kept.
local core = require "dm.core"
local option = require "dm.base.options"

local M = {}

local DEEPEST = 100

local writers = {}

local function write(out, x, depth)
  local meta = type(x) == "userdata" and debug.getmetatable(x)
  local kind = meta and meta.__name or math.type(x) or type(x)
  local writer = writers[kind]
  if not writer then
    option.fail("dm.mpi", "a %s cannot be sent: values are numbers, strings, booleans, vectors, "
      .. "matrices and tables of them", kind)
  end
  if depth > DEEPEST then option.fail("dm.mpi", "tables lie in each other too deeply") end
  writer(out, x, depth)
end

writers["nil"] = function(out) out[#out + 1] = "n" end
writers.boolean = function(out, x) out[#out + 1] = x and "t" or "f" end
writers.integer = function(out, x) out[#out + 1] = ("<c1i8"):pack("i", x) end
writers.float = function(out, x) out[#out + 1] = ("<c1d"):pack("d", x) end
writers.string = function(out, x) out[#out + 1] = ("<c1s8"):pack("s", x) end

writers["dm.vector"] = function(out, x)
  out[#out + 1] = ("<c1i8"):pack("v", #x)
  for i = 1, #x do out[#out + 1] = ("<d"):pack(x[i]) end
end

writers["dm.matrix"] = function(out, x)
  local columns = #x > 0 and #x[1] or 0
  out[#out + 1] = ("<c1i8i8"):pack("m", #x, columns)
  for i = 1, #x do
    local row = x[i]
    for k = 1, columns do out[#out + 1] = ("<d"):pack(row[k]) end
  end
end

writers.table = function(out, x, depth)
  out[#out + 1] = "{"
  for key, value in pairs(x) do
    write(out, key, depth + 1)
    write(out, value, depth + 1)
  end
  out[#out + 1] = "n" -- no key is nil
end

--- The bytes of a value.
function M.pack(x)
  local out = {}
  write(out, x, 0)
  return table.concat(out)
end

local readers = {}

local function read(bytes, at)
  return readers[bytes:sub(at, at)](bytes, at + 1)
end

-- count doubles
local function numbers(bytes, at, count)
  local out = {}
  for i = 1, count do out[i], at = ("<d"):unpack(bytes, at) end
  return out, at
end

function readers.n(_, at) return nil, at end
function readers.t(_, at) return true, at end
function readers.f(_, at) return false, at end
function readers.i(bytes, at) return ("<i8"):unpack(bytes, at) end
function readers.d(bytes, at) return ("<d"):unpack(bytes, at) end
function readers.s(bytes, at) return ("<s8"):unpack(bytes, at) end

function readers.v(bytes, at)
  local count, out
  count, at = ("<i8"):unpack(bytes, at)
  out, at = numbers(bytes, at, count)
  return core.vector(out), at
end

function readers.m(bytes, at)
  local rows, columns, out = nil, nil, {}
  rows, columns, at = ("<i8i8"):unpack(bytes, at)
  for i = 1, rows do out[i], at = numbers(bytes, at, columns) end
  return core.matrix(out), at
end

readers["{"] = function(bytes, at)
  local out = {}
  while true do
    local key, value
    key, at = read(bytes, at)
    if key == nil then return out, at end
    value, at = read(bytes, at)
    out[key] = value
  end
end

--- The value of these bytes.
function M.unpack(bytes) return (read(bytes, 1)) end

return M
