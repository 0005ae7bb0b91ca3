-- members that are compared with a flow while they are made (ensemble{beside=}): those that fly off between two looks are, like
-- all others, what they are alone
local dm = require "dm"
local tap = require "tap"
local ok = tap.ok

local system = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 - (q[1] ^ 2 + q[2] ^ 2) / 2 - q[1] ^ 2 * q[2] + q[2] ^ 3 / 3 end }
local flow = system:solver { rule = "kahan-li(8)", h = 0.05 }:ensemble { members = 1, q = { { 0.1, 0.1 } }, v = { { 0.2, 0 } }, t = 30, every = 1, watch = { "q1", "q2" } }
local columns = { "q1", "q2" }

-- members of this list of numbers, each looked at as often as its number says; every third one to the end, others until they are off
local function members(rule, list)
  local q, v, flows = {}, {}, {}
  for k, i in ipairs(list) do
    q[k], v[k] = { 0.02, 0.3 + 0.03 * i }, { 0.3, 0.1 }
    flows[k] = { e = flow, i = 1, horizon = 30, rows = 37 + i, bound = i % 3 == 0 and { 1e9, 1e9 } or { 1e3, 1e3 } }
  end
  return system:solver { rule = rule, h = 0.1 }:ensemble { members = #list, q = q, v = v, steps = 300, rows = 11, watch = { "energy" },
    beside = { watch = columns, compared = columns, flows = flows } }
end

local function text(e, k)
  local off, sums = e:followed(k), e:summary "energy"
  return ("%s %d %a %a %a %a %a"):format(e.status[k], e.steps[k], off.q1, off.q2, sums.last[k], sums.largest[k], sums.slope[k])
end

for _, rule in ipairs { "verlet", "rk4", "midpoint" } do
  local list, failed, different = {}, 0, 0
  for i = 1, 40, 3 do list[#list + 1] = i end
  local e = members(rule, list)
  for k, i in ipairs(list) do
    if e.status[k] ~= "ok" then failed = failed + 1 end
    if text(e, k) ~= text(members(rule, { i }), 1) then different = different + 1 end
  end
  ok(failed > 4 and failed < #list, rule .. ": some fly off", failed)
  ok(different == 0, rule .. ": in lanes what they are alone", different)
end

tap.done()
