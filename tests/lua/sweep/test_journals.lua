-- ensembles with a journal: what they return is what one call returns, whatever was finished before
local tap = require "tap"
local core = require "dm.core"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local folder = os.tmpname()
os.remove(folder)
assert(os.execute(("mkdir '%s'"):format(folder)))
local function name(base) return folder .. "/" .. base end
local function text(file, new)
  local f <close> = assert(io.open(file, new and "wb" or "rb"))
  return new and f:write(new) or f:read "a"
end
local function copy(options, more)
  local out = {}
  for key, value in pairs(options) do out[key] = value end
  for key, value in pairs(more or {}) do out[key] = value end
  return out
end

local function alike(x, y) return x == y or x ~= x and y ~= y end
local function same_member(a, b, i)
  for k = 1, #a.q[i] do
    if not (alike(a.q[i][k], b.q[i][k]) and alike(a.p[i][k], b.p[i][k])) then return false end
  end
  if a.status[i] ~= b.status[i] or a.steps[i] ~= b.steps[i] then return false end
  if not a.rows then return true end
  local x, y = a:path(i), b:path(i)
  if #x ~= #y or x.h ~= y.h then return false end
  for _, column in ipairs(x.columns) do
    local u, v = x:column(column), y:column(column)
    for k = 1, #x do if not alike(u[k], v[k]) then return false end end
  end
  return true
end
local function same(a, b)
  for i = 1, #a do if not same_member(a, b, i) then return false, i end end
  local x, y = a:failures(), b:failures()
  for k = 1, math.max(#x, #y) do
    if not x[k] or not y[k] or x[k].member ~= y[k].member or x[k].message ~= y[k].message then
      return false, "failures"
    end
  end
  return true
end

-- part k/n of a journal as dmlua --part makes it, here by hand
local parts = require "dm.sweep.part"

local pendulum = dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p)
  return v[1] ^ 2 / 2 + p.k * math.cos(q[1])
end }
local kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end }
local massive = dm.system { Q = dm.R(1), params = { m = 1 }, L = function(q, v, _, p)
  return p.m * v[1] ^ 2 / 2 - q[1] ^ 2 / 2
end }
local function q1(i) return { i / 500 } end
local function still() return { 0 } end
local base = { members = 700, q = q1, v = still, steps = 40 }
local cases = {
  { "plain", pendulum, "verlet", base },
  { "rows", pendulum, "gauss(2)", copy(base, { every = 7 }) },
  { "watched", pendulum, "midpoint", copy(base, { watch = { "energy", a = function(q) return q[1] end }, rows = 5 }) },
  { "tables, a step each", pendulum, "verlet", copy(base, { q = (function()
    local out = {}
    for i = 1, 700 do out[i] = q1(i) end
    return dm.matrix(out)
  end)(), h = function(i) return 0.05 + 1e-4 * (i % 5) end, every = 10 }) },
  { "parameters", pendulum, "gauss(3)", copy(base, { vary = { k = function(i) return i / 100 end }, every = 20 }) },
  { "parts without a start", massive, "verlet", copy(base, { vary = { m = function(i) return i % 350 == 3 and 0 or 1 + i // 350 end } }) },
  { "failures", kepler, "verlet", { members = 600, q = function(i) return { i % 50 == 0 and 1e-200 or 1, 0 } end,
    v = function(i) return { 0, 1 + i / 1000 } end, steps = 30, every = 10 } },
  { "columns that are NaN", pendulum, "verlet", copy(base, { watch = { ln = function(q) return math.log(q[1]) end }, rows = 5 }) },
  { "gaps", pendulum, "verlet", copy(base, { watch = { ln = function(q) return math.log(q[1]) end }, rows = 5, gaps = true }) },
  { "momenta", pendulum, "midpoint", { members = 300, q = q1, p = still, t = 2, t0 = 1 } },
}
for _, case in ipairs(cases) do
  local title, system, rule, options = table.unpack(case)
  local solver = system:solver { rule = rule, h = 0.05 }
  local plain, file = solver:ensemble(options), name "one.journal"
  local whole = solver:ensemble(copy(options, { journal = file }))
  ok(same(plain, whole), title .. ": a call with a journal", select(2, same(plain, whole)))
  ok(whole.journal.found == 0 and whole.journal.run == #plain, title .. ": all were run")
  local again = solver:ensemble(copy(options, { journal = file, threads = 1 }))
  ok(same(plain, again) and again.journal.found == #plain and again.journal.run == 0, title .. ": all were read")
  -- cut in the last record: its members are run again
  local bytes = text(file)
  text(file, bytes:sub(1, -30))
  again = solver:ensemble(copy(options, { journal = file }))
  ok(same(plain, again) and again.journal.found + again.journal.run == #plain and again.journal.run > 0,
    title .. ": the rest after a cut", again.journal.run)
  os.remove(file)
end
ok(pendulum:solver { rule = "verlet", h = 0.1 }:ensemble(base).journal == nil, "without a journal there is none")

-- members that failed by a NaN are none of an ensemble with gaps
do
  local solver, logarithm = pendulum:solver { rule = "verlet", h = 0.1 }, function(q) return math.log(q[1]) end
  local options = { members = 3, q = function() return { 1 } end, v = still, steps = 40, rows = 5, watch = { ln = logarithm }, journal = name "gaps.journal" }
  ok(solver:ensemble(options).status[1] == "no_value", "a member whose column is NaN")
  raises("watch was ln and is ln, with gaps", solver.ensemble, solver, copy(options, { gaps = true }))
end

-- no function of a start is called for members that are there, but for one that is checked
local calls = 0
local counted = copy(base, { journal = name "calls.journal", q = function(i)
  calls = calls + 1
  return q1(i)
end })
local verlet = pendulum:solver { rule = "verlet", h = 0.05 }
verlet:ensemble(counted)
ok(calls >= 700, "starts of all members were asked for", calls)
calls = 0
verlet:ensemble(counted)
ok(calls < 20, "of those that are there, one", calls)
raises("another member 1", verlet.ensemble, verlet, copy(counted, { q = function() return { 3 } end }))

-- what decides the result, is named
local file = counted.journal
local before = text(file)
for what, other in pairs {
  rule = { pendulum:solver { rule = "midpoint", h = 0.05 } },
  h = { pendulum:solver { rule = "verlet", h = 0.06 } },
  steps = { verlet, { steps = 41 } },
  members = { verlet, { members = 701 } },
  system = { dm.system { Q = dm.R(1), params = { k = 1 }, L = function(q, v, _, p)
    return v[1] ^ 2 / 2 + p.k * math.cos(q[1]) * (1 + 1e-16 * 8)
  end }:solver { rule = "verlet", h = 0.05 } },
  every = { verlet, { every = 3 } },
} do
  local fine, why = pcall(other[1].ensemble, other[1], copy(counted, other[2]))
  ok(not fine and tostring(why):find(": " .. what .. " was", 1, true), "another " .. what .. " is refused", why)
end
ok(text(file) == before, "and the file is as it was")
-- the same graph from another text
local again = dm.system { params = { k = 1 }, Q = dm.R(1), L = function(angle, rate, _, numbers)
  local cosine = math.cos(angle[1]) -- a comment
  return rate[1] ^ 2 / 2 + numbers.k * cosine
end }:solver { rule = "verlet", h = 0.05 }
ok(again:ensemble(counted).journal.found == 700, "names and comments do not count")

-- every byte of a small file: resumed or refused, never believed
local small = { members = 2, q = q1, v = still, steps = 1, every = 1, journal = name "small.journal" }
local good = verlet:ensemble(small)
local bytes, believed, refused, resumed = text(small.journal), 0, 0, 0
local function try(changed)
  text(small.journal, changed)
  local fine, e = pcall(verlet.ensemble, verlet, small)
  if not fine then refused = refused + 1 return end
  resumed = resumed + 1
  if not same(good, e) then believed = believed + 1 end
end
for k = 1, #bytes do
  try(bytes:sub(1, k - 1) .. string.char(bytes:byte(k) ~ (1 << k % 8)) .. bytes:sub(k + 1))
  try(bytes:sub(1, k - 1))
end
ok(believed == 0, "no changed byte and no cut is believed", believed)
ok(refused > 100 and resumed > 100, "changes of the head are refused, of records run again", refused .. " " .. resumed)

-- files whose checksums are right and whose numbers are not: refused or run again, never an index
local head = bytes:sub(13, 12 + ("<I4"):unpack(bytes, 9))
local record = bytes:sub(12 + #head + 5, -5)
local function forged(about, body)
  local all = "dmjournl" .. ("<s4"):pack(about)
  return all .. ("<I4"):pack(core.crc32(all)) .. body .. ("<I4"):pack(core.crc32(body))
end
local function with(first, count, members)
  return "dmrecord" .. ("<i8i8i8"):pack(first, count, #members) .. members
end
local members = record:sub(33)
ok(forged(head, record) == bytes, "a journal by hand")
for _, x in ipairs { { 1 << 62, 1 << 62 }, { 1, math.maxinteger }, { 2, math.maxinteger }, { math.maxinteger, 1 }, { 0, 2 }, { -5, 2 } } do
  try(forged(head, with(x[1], x[2], members)))
end
ok(believed == 0, "records of impossible members")
text(small.journal, forged(head, with(1, 2, members:sub(1, -9))))
raises("other lengths", verlet.ensemble, verlet, small)
raises("other lengths", dm.load, small.journal)
text(small.journal, forged(head, with(1, 2, ("<s4s4"):pack("x", "y"))))
raises("another member 1", verlet.ensemble, verlet, small)
raises("member 1 has other bytes", dm.load, small.journal)
text(small.journal, forged(head:gsub("\nn = 1", "\nn = 1000000000"), record))
raises("no number 'n'", dm.load, small.journal)
for _, other in ipairs { "", "-2", "1e30", "two" } do
  text(small.journal, forged(head:gsub("members = 2", "members = " .. other), record))
  raises("its head is damaged", dm.journal, small.journal)
end
local study = { members = 2, workers = 1, journal = name "study.journal", run = function(i) return i end }
dm.sweep(study)
local kept = text(study.journal)
text(study.journal, forged(kept:sub(13, 12 + ("<I4"):unpack(kept, 9)), with(2, 1, ("<s4"):pack(("<s2s2"):pack("ok", "value") .. "123"))))
raises("member 2", dm.sweep, study)
raises("member 2 has other bytes", dm.load, study.journal)

-- what is in it
text(small.journal, bytes)
local report = dm.journal(small.journal)
ok(report.members == 2 and report.finished == 2 and #report.missing == 0 and report.damaged == 0, "dm.journal")
ok(tostring(report):find "2 of 2 members" or tostring(report):find "2 finished", "and as a text", tostring(report))
text(small.journal, bytes:sub(1, -3))
report = dm.journal(small.journal)
ok(report.finished == 0 and report.missing[1][2] == 2 and report.damaged > 0, "of a damaged one")
raises("no journal", function()
  local fine, why = pcall(dm.journal, name "nowhere")
  error(fine and "" or why:find "No such file" and "no journal" or why, 0)
end)
text(small.journal, "something else that is no journal")
raises("not a journal", verlet.ensemble, verlet, small)
raises("not a journal", dm.journal, small.journal)
ok(text(small.journal) == "something else that is no journal", "a file of somebody else is left alone")

-- columns
local data = dm.load(file)
local last = #data.member
ok(last == 700 and data.q1[last] == verlet:ensemble(base).q[700][1] and data.steps[1] == 40, "dm.load reads the columns")

-- a file in use
ok(core.crc32 "123456789" == 0xcbf43926 and core.crc32("6789", core.crc32 "12345") == 0xcbf43926, "CRC-32 of zlib")

-- options
raises("journal", verlet.ensemble, verlet, copy(base, { journal = 3 }))
raises("700 members", verlet.ensemble, verlet, copy(base, { journal = name "x", v = { { 1 } } }))
raises("No such file", verlet.ensemble, verlet, copy(base, { journal = name "no/folder/x" }))
raises("Is a directory", verlet.ensemble, verlet, copy(base, { journal = folder }))
raises("member 650", verlet.ensemble, verlet, copy(base, { journal = name "y", q = function(i) return i == 650 and {} or q1(i) end }))
ok(dm.journal(name "y").finished >= 256, "members before the one that cannot start are kept")

-- reduced systems and groups
local planar = dm.system { Q = dm.R(2), L = function(q, v)
  return (v[1] ^ 2 + q[1] ^ 2 * v[2] ^ 2) / 2 + 1 / q[1]
end }
local shape = planar:routh { cyclic = { 2 }, q = { 1, 0 }, v = { 0, 1 } }
local reduced = { members = 300, q = function(i) return { 1 + i / 1000 } end, v = function() return { 0 } end, steps = 20 }
local solver = shape:solver { rule = "verlet", h = 0.05 }
ok(same(solver:ensemble(reduced), solver:ensemble(copy(reduced, { journal = name "r" }))), "a reduced system")

-- shares of parts tile the members
local function tiles(members, n)
  local at = 1
  for k = 1, n do
    local first, last_ = parts.share(members, k, n)
    if first ~= at then return false end
    at = last_ + 1
  end
  return at == members + 1
end
ok(tiles(3000, 7) and tiles(3, 7) and tiles(1, 1) and tiles(10 ^ 9 // 1, 64), "parts are disjoint and complete")

os.execute(("rm -r '%s'"):format(folder))
tap.done()
