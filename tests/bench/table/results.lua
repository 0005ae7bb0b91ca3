-- What the programs of the benchmark printed, read back.
local results = {}

-- lines of all files FOLDER/<pattern>, split at tabs
function results.lines(folder, names)
  local rows = {}
  for _, name in ipairs(names) do
    local file = io.open(folder .. "/" .. name)
    for line in file and file:lines() or function() end do
      local row = {}
      for field in line:gmatch "[^\t]+" do row[#row + 1] = tonumber(field) or field end
      rows[#rows + 1] = row
    end
    if file then file:close() end
  end
  return rows
end

local SEARCHES = { "search-bound.tsv", "search-gsl.tsv", "search-odeint.tsv", "search-dmlua.tsv" }

-- { problems = keys in order, targets[key][target][side] = rows {method, steps, error, ns, setup} by ns,
--   curves[key][side][method] = {{ns, error}, ...} }
function results.searches(folder)
  local all = { problems = {}, targets = {}, curves = {} }
  local function at(t, key)
    t[key] = t[key] or {}
    return t[key]
  end
  for _, row in ipairs(results.lines(folder, SEARCHES)) do
    local kind, side, key, method, steps, err, ns, target, setup = table.unpack(row)
    if not all.curves[key] then all.problems[#all.problems + 1] = key end
    local curve = at(at(at(all.curves, key), side), method)
    if kind == "point" then
      curve[#curve + 1] = { ns, err }
    else
      local list = at(at(at(all.targets, key), target), side)
      list[#list + 1] = { method = method, steps = steps, error = err, ns = ns, setup = setup }
    end
  end
  for _, targets in pairs(all.targets) do
    for _, sides in pairs(targets) do
      for _, list in pairs(sides) do table.sort(list, function(a, b) return a.ns < b.ns end) end
    end
  end
  return all
end

function results.steps(folder)
  return results.lines(folder, { "steps-c.tsv", "steps-lua.tsv", "steps-dmlua.tsv" })
end

results.targets = { 1e-4, 1e-8, 1e-10 }
return results
