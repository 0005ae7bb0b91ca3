--- What an animation plots over time beside the picture: energy, momenta, columns, numbers of the
-- user's.
local blame = require "dm.base.blame"
local core = require "dm.core"

local M = {}

local abs, min, max = math.abs, math.min, math.max

local fail = require "dm.base.options".failing "animate"

-- { name, lines = { {name, values} } } of "energy", a column name, a space (its momentum) or {
-- name, values }
local function quantity(path, what)
  if what == "energy" then return "energy", { { "", path:energy() } } end
  if type(what) == "string" then return what, { { "", path:column(what) } } end
  if type(what) == "table" and type(what[1]) == "string" and what[2] then
    local values = require "dm.show.series".numbers(what[2], "plot '" .. what[1] .. "'")
    if #values ~= #path then
      fail("plot '%s' has %d numbers, but the path has %d rows", what[1], #values, #path)
    end
    return what[1], { { "", values } }
  end
  local fine, J = blame.try(path.momentum, path, what)
  if not fine then
    local why = tostring(J):match "^[^\n]*":gsub("^.-%.lua:%d+: ", "")
    fail("option 'plots' holds \"energy\", names of columns, groups as dm.SO(2), or { name, "
      .. "numbers } (%s)", why)
  end
  local lines = {}
  if type(J[1]) == "number" then
    lines[1] = { "", J }
  else
    for k = 1, #J[1] do
      local values = {}
      for i = 1, #J do values[i] = J[i][k] end
      lines[k] = { tostring(k), values }
    end
  end
  return "momentum of " .. tostring(what), lines
end

-- may everything be turned? Coordinates of other names than x, y, z are no places: r, theta
local function can_turn(path)
  for _, name in ipairs(path.system.coordinates or {}) do
    if not name:find "^[xyz][_%d]*$" then return false end
  end
  return true
end

-- without being told: the energy, and the momentum of turning everything
local function default_plots(path, dim)
  local out = {}
  if path.watched then
    for _, name in ipairs(path.columns) do
      if name == "energy" then out[1] = "energy" end
    end
    return out
  end
  if type(path.energy) == "function" and blame.try(path.energy, path) then out[1] = "energy" end
  local fine = can_turn(path) and blame.try(function() return path:momentum(core.SO(dim))[1] end)
  if fine then out[#out + 1] = core.SO(dim) end
  return out
end

-- a line of numbers over time between rows first and last, those that can be drawn
local function line_of(path, name, values, first, last)
  local line = { name = name, x = {}, y = {}, lo = math.huge, hi = -math.huge, style = "lines" }
  for i = first, last do
    local v = values[i]
    if v == v and abs(v) < 1e37 then
      line.x[#line.x + 1], line.y[#line.y + 1] = path.t[i], v
      line.lo, line.hi = min(line.lo, v), max(line.hi, v)
    end
  end
  return line.y[1] and line
end

-- floats hold seven digits: lines that change little are shown as their change from the start; and
-- no more points than pixels
local function settle(lines, width)
  local change, size = 0, 0
  for _, line in ipairs(lines) do
    change, size = max(change, line.hi - line.lo), max(size, abs(line.y[1]))
  end
  local from_start = change < 0.2 * size
  for i, line in ipairs(lines) do
    local base, t, y = from_start and line.y[1] or 0, line.x, line.y
    for k = 1, #y do y[k] = y[k] - base end
    local start, span = t[1], max(t[#t] - t[1], 1e-300)
    local thin = require "dm.show.series".thin(line,
      { width = width, height = 200, fx = function(x) return (x - start) / span end,
      fy = function() return 0 end })
    lines[i] = { name = line.name, base = base, t = thin.x, y = thin.y }
  end
  return from_start
end

-- the lines of all paths for the k-th quantity, one plot of the page
local function plot_of(paths, shown, wants, k, names, width)
  local title, lines = nil, {}
  for i, path in ipairs(paths) do
    local name, columns = quantity(path, wants[i][k])
    title = title or name
    for _, column in ipairs(columns) do
      local label = (#paths > 1 and names[i] .. " " or "") .. column[1]
      lines[#lines + 1] = line_of(path, label, column[2], shown[i].first, shown[i].last)
    end
  end
  if #lines == 0 then return nil end
  local from_start = settle(lines, width)
  if from_start and #lines == 1 then
    title = ("%s %s %.10g"):format(title, lines[1].base > 0 and "-" or "+", abs(lines[1].base))
  elseif from_start then
    title = title .. ", change from the start"
  end
  return { name = title, lines = lines }
end

--- The plots of a page: a list of { name, lines = { { name, t, y } } }, one for each quantity, the
-- lines of all paths in it; width: how many pixels of time they must serve.
function M.all(paths, shown, options, names, width)
  local wants, out = {}, {}
  for i, path in ipairs(paths) do wants[i] = options.plots or default_plots(path, shown[i].dim) end
  local count = math.huge
  for i = 1, #paths do count = min(count, #wants[i]) end
  for k = 1, count do out[#out + 1] = plot_of(paths, shown, wants, k, names, width) end
  return out
end

return M
