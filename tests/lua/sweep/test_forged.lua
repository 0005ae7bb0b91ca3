-- journals of charts, maps and sweeps whose checksums are right and whose values are not: refused
-- with the member, never believed and never an error of Lua's own
local tap = require "tap"
local core = require "dm.core"
local dm = require "dm"
local fields = require "dm.data.fields"
local journal = require "dm.data.journal"
local ok = tap.ok

local file = os.tmpname()

local function spit(text)
  local f <close> = assert(io.open(file, "wb"))
  f:write(text)
end

-- the head of the file as bytes, and its members
local function parts()
  local f <close> = assert(io.open(file, "rb"))
  local all, members = f:read "a", {}
  local j = journal.read(file)
  for _, r in ipairs(j.records) do
    for i, one in journal.members(r, journal.bytes(j, r)) do members[i] = one end
  end
  j.file:close()
  return all:sub(1, 16 + ("<I4"):unpack(all, 9)), members
end

-- the file with member i in other words
local function forge(head, members, i, bytes)
  local out = head
  for k, one in ipairs(members) do
    one = k == i and bytes or one
    local body = "dmrecord" .. ("<i8i8i8s4"):pack(k, 1, #one + 4, one)
    out = out .. body .. ("<I4"):pack(core.crc32(body))
  end
  spit(out)
end

-- what a call says of a member in which values are others; `gone` is one that is not there
local gone = {}
local function with(head, members, i, values)
  local t = fields.unpack(members[i])
  for key, x in pairs(values) do t[key] = x ~= gone and x or nil end
  forge(head, members, i, fields.pack(t))
end

local function check(name, make, cases)
  os.remove(file)
  make()
  local head, members = parts()
  local wrong = {}
  for _, case in ipairs(cases) do
    with(head, members, case[1], case[2])
    local fine, why = pcall(function() return tostring(make()) end)
    if fine or not tostring(why):find("remove the file", 1, true) then
      wrong[#wrong + 1] = ("%d: %s"):format(case[1], tostring(why):sub(1, 80))
    end
  end
  forge(head, members, 2, "no named values")
  local fine, why = pcall(make)
  ok(#wrong == 0 and not fine and tostring(why):find("remove the file", 1, true),
    name .. ": forged values are refused", table.concat(wrong, "\n# ") .. " " .. tostring(why))
  forge(head, members)
  ok(pcall(make), name .. ": as it was it is read")
end

local oscillator = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 4 / 4 end }
check("chart", function()
  return oscillator:chart { q = { 1 }, v = { 0 }, rules = { "verlet", "gauss(2)" }, h = { 0.1, 0.05 }, t = 3,
    journal = file, repeats = 1 }
end, { { 1, { load = "x" } }, { 1, { load = gone } }, { 1, { floor = "y" } }, { 1, { floor = 0 / 0 } }, { 1, { text = 3 } },
  { 1, { h = "0.1 x" } }, { 1, { h = "0.1" } }, { 1, { h = "0.1 -0.05" } }, { 2, { setup = "x" } }, { 2, { ns = -1.0 } },
  { 2, { error = math.huge } }, { 2, { steps = 2.5 } }, { 2, { rule = "gauss(2)" } }, { 3, { why = 7 } }, { 3, { below = 1 } },
  { 4, { newton = gone, evaluations = "many" } } })

check("map", function()
  return dm.stability { system = oscillator, q = { 1 }, v = { 0 }, rules = { "verlet", "midpoint" }, h = { 0.1, 0.2 },
    steps = 50, journal = file }
end, { { 2, { h = gone } }, { 2, { h = 0.3 } }, { 2, { h = "0.2" } }, { 2, { rule = "midpoint" } }, { 2, { error = "x" } },
  { 2, { steps = gone } }, { 2, { class = "wide" } }, { 2, { code = 1 } }, { 2, { observable = 5 } } })

os.remove(file)
local function study() return dm.sweep { members = 2, run = function(i) return { a = i, b = 2 * i } end, journal = file } end
study()
local head, members = parts()
forge(head, members, 2, members[2]:sub(1, -9))
local fine, why = pcall(study)
ok(not fine and tostring(why):find("member 2", 1, true) and not tostring(why):find("unpack", 1, true),
  "sweep: a member with a number less than names", tostring(why))
os.remove(file)
tap.done()
