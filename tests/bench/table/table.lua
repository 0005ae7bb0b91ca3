-- table.lua FOLDER CSV LOAD: prints the tables of the benchmark and writes the CSV file
package.path = arg[0]:match "^(.*/)" .. "?.lua;" .. package.path
local results = require "results"
local folder, load = arg[1], arg[3]
local csv = assert(io.open(arg[2], "w"))
csv:write "problem,target error,rule,ns,bound_ns,ratio,peer,peer_ns,bound_rule,setup_ns,load\n"

local function quoted(x)
  x = tostring(x)
  return x:find '[,"]' and '"' .. x:gsub('"', '""') .. '"' or x
end
local function write_row(row)
  for i = 1, 11 do
    csv:write(row[i] == nil and "" or quoted(row[i]), i < 11 and "," or "\n")
  end
end

local function duration(ns)
  if not ns then return "-" end
  if ns < 1e3 then return ("%.3g ns"):format(ns) end
  if ns < 1e6 then return ("%.1f us"):format(ns / 1e3) end
  return ("%.2f ms"):format(ns / 1e6)
end
-- names of rules for a narrow column
local function short(name) return (name:gsub("log%-hamiltonian", "log-h"):gsub("sofroniou%-spaletta", "sofspa"):gsub(" sums$", "")) end
-- ends its sweeps by number, above round-off, or sums without compensation; the second line is for those that do not
local function is_loose(name) return name:find "^gauss%(%d+, %d+%)" or name:find ", plain sums$" end
local function ratio(a, b) return a and b and ("%.2f"):format(a / b) or "-" end

-- work at equal error: the cheapest of each side; the file has every rule of dmlua
local all = results.searches(folder)
-- the ratio, and in brackets without the set-up (tracing and compilation) that is part of the time
local FORM = "%-13s %-6s | %-21s %9s | %-24s %9s %7s (%6s) | %-29s %9s %7s"
print(FORM:format("problem", "error", "bound", "", "dmlua", "", "ratio", "run", "best peer", "", "ratio"))
for _, key in ipairs(all.problems) do
  for _, target in ipairs(results.targets) do
    local sides = (all.targets[key] or {})[target] or {}
    local bound, peer = (sides.bound or {})[1], (sides.peer or {})[1]
    local best = (sides.dmlua or {})[1]
    if bound then
      local mine = best or { method = "not reached" }
      local theirs = peer or { method = "not reached" }
      print(FORM:format(key, ("%g"):format(target), bound.method, duration(bound.ns),
        short(mine.method), duration(mine.ns), ratio(mine.ns, bound.ns), ratio(mine.ns and mine.ns - mine.setup, bound.ns),
        theirs.method, duration(theirs.ns), ratio(theirs.ns, bound.ns)))
      local exact = 1
      while sides.dmlua and sides.dmlua[exact] and is_loose(sides.dmlua[exact].method) do exact = exact + 1 end
      if exact > 1 and sides.dmlua[exact] then
        local other = sides.dmlua[exact]
        local what = sides.dmlua[1].method:find "plain" and "  sums compensated:" or "  no number of sweeps:"
        print(FORM:format("", "", what, "", short(other.method), duration(other.ns),
          ratio(other.ns, bound.ns), ratio(other.ns - other.setup, bound.ns), "", "", ""))
      end
      for _, rule in ipairs(sides.dmlua or { {} }) do
        write_row { key, ("%g"):format(target), rule.method, rule.ns, bound.ns,
          rule.ns and ("%.3f"):format(rule.ns / bound.ns), peer and peer.method, peer and peer.ns,
          bound.method, rule.setup, load }
      end
    end
  end
end

-- ns per step
local what, order = {}, {}
for _, row in ipairs(results.steps(folder)) do
  local _, side, name, method, ns, newton = table.unpack(row)
  if not what[name] then
    what[name] = {}
    order[#order + 1] = name
  end
  table.insert(what[name], { side = side, method = method, ns = ns, newton = newton })
end
if #order > 0 then print(("\n%-38s %-6s %-24s %10s %8s %6s"):format("ns per step", "", "", "ns", "Newton", "ratio")) end
for _, name in ipairs(order) do
  local bound, peer = nil, nil
  for _, row in ipairs(what[name]) do
    if row.side == "C" and (not bound or row.ns < bound.ns) then bound = row end
    if row.side == "peer" and (not peer or row.ns < peer.ns) then peer = row end
  end
  for _, row in ipairs(what[name]) do
    print(("%-38s %-6s %-24s %10.2f %8s %6s"):format(name, row.side, row.method, row.ns,
      row.newton > 0 and ("%.2f"):format(row.newton) or "", bound and ratio(row.ns, bound.ns) or ""))
    if bound and row.side == "dmlua" then
      write_row { name, nil, row.method, row.ns, bound.ns, ("%.3f"):format(row.ns / bound.ns), peer and peer.method,
        peer and peer.ns, bound.method, nil, load }
    end
  end
end
csv:close()
print(("\nload at the start %s; figures also in %s"):format(load, arg[2]))
