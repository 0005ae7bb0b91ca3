--- Files that are read, spoilt byte by byte.
local dm = require "dm"

local M = {}

local function read(name)
  local file <close> = assert(io.open(name, "rb"))
  return file:read "a"
end
local function write(name, text)
  local file <close> = assert(io.open(name, "wb"))
  file:write(text)
end
M.read, M.write = read, write

local WORDS = { "99999999999999999999", "nan", "-1", "1e999", "0", "2147483648", "-0.0", "1e-320",
  "inf", "0x10", "1e308", "4294967297", "-9223372036854775808" }

-- two lines change places
local function swapped(random, text)
  local lines = {}
  for line in text:gmatch "[^\n]*\n?" do lines[#lines + 1] = line end
  local i, j = random(#lines), random(#lines)
  lines[i], lines[j] = lines[j], lines[i]
  return table.concat(lines)
end
-- the number at or behind `at` becomes another
local function renumbered(random, text, at)
  local first, last = text:find("%-?%d[%d.e]*", at)
  if not first then return text end
  return text:sub(1, first - 1) .. WORDS[random(#WORDS)] .. text:sub(last + 1)
end
local KINDS = {
  function(random, text, at)
    return text:sub(1, at - 1) .. string.char(random(0, 255)) .. text:sub(at + 1)
  end,
  function(_, text, at) -- one bit
    return text:sub(1, at - 1) .. string.char((text:byte(at) or 0) ~ (1 << at % 8)) .. text:sub(at + 1)
  end,
  function(random, text, at) return text:sub(1, at - 1) .. text:sub(at + random(1, 40)) end,
  function(random, text, at) return text:sub(1, at) .. text:sub(random(#text), at) .. text:sub(at + 1) end,
  function(_, text, at) return text:sub(1, at) end,
  renumbered, renumbered, swapped,
  function(random, text)
    return (text:gsub("\n", random(3) == 1 and "\r\n" or "\n\n", random(3)))
  end,
  function(random, text, at) -- something put in
    return text:sub(1, at) .. (" "):rep(random(0, 1)) .. WORDS[random(#WORDS)] .. text:sub(at + 1)
  end,
}

--- The text with one to three changes: bytes, bits, numbers, lines, pieces left out, put in, cut off.
function M.spoilt(random, text)
  for _ = 1, random(1, 3) do
    if #text == 0 then return text end
    text = KINDS[random(#KINDS)](random, text, random(#text))
  end
  return text
end

local function system() return dm.system { Q = dm.R(2), L = function(q, v)
  return v:dot(v) / 2 - q:dot(q) / 2
end } end

--- Functions by name that spoil a table, a binary table or a checkpoint, in the current folder, and
-- read it. The checksum of a checkpoint is not made right again: what is changed must be refused.
function M.readers(random)
  local oscillator = system()
  local path = oscillator:solver({ rule = "gauss(2)", h = 0.1 })
    :run { q = { 1, 0 }, v = { 0, 1 }, steps = 4 }
  path:csv "whole.csv"
  path:npy "whole.npy"
  path:checkpoint "whole.checkpoint"
  local csv, npy, checkpoint = read "whole.csv", read "whole.npy", read "whole.checkpoint"
  return {
    ["a spoilt csv"] = function()
      write("spoilt.csv", M.spoilt(random, csv))
      return dm.load "spoilt.csv"
    end,
    ["a spoilt npy"] = function()
      write("spoilt.npy", M.spoilt(random, npy))
      return dm.load "spoilt.npy"
    end,
    ["a spoilt checkpoint"] = function()
      local text = M.spoilt(random, checkpoint)
      write("spoilt.checkpoint", text)
      local resumed = dm.resume("spoilt.checkpoint", oscillator)
      assert(text == checkpoint, "DEFECT: a changed checkpoint is taken")
      return resumed:run { steps = 2 }
    end,
  }
end

return M
