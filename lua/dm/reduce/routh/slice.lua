--- What a reduced system shows of its bundle along a line of shapes, as series for dm.plot.
local blame = require "dm.base.blame"
local class = require "dm.base.class"
local core = require "dm.core"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local routh = require "dm.reduce.routh"

local M = {}

-- entries of a value: { name, number } each; of an antisymmetric matrix the upper half
local function entries(what, value, info)
  if type(value) == "number" then return { { what, value } } end
  local names, out = {}, {}
  for i, at in ipairs(info.shape) do names[i] = info.names[at] end
  for i = 1, #value do
    for k = 1, #value[i] do
      local fits = what == "curvature" and i < k or what == "locked_inertia" and i <= k
        or what == "connection"
      local left = what == "curvature" and names[i] or info.names[info.cyclic[i]]
      local right = what == "locked_inertia" and info.names[info.cyclic[k]] or names[k]
      if fits then out[#out + 1] = { ("%s %s, %s"):format(what, left, right), value[i][k] } end
    end
  end
  return out
end

local KINDS = { amended_potential = true, connection = true, curvature = true,
  locked_inertia = true }

local function check(shape, what, options)
  local info = routh.need(shape, "slice")
  if not KINDS[what] then
    error("slice: give \"amended_potential\", \"connection\", \"curvature\" or "
      .. "\"locked_inertia\", and { from =, to =, points = }", 0)
  end
  option.check(options, { "from", "to", "points", "t" }, "slice", "{ from =, to =, points = }")
  local ends = {}
  for _, key in ipairs { "from", "to" } do
    ends[key] = type(options[key]) == "number" and { options[key] } or options[key]
    if lists.count(ends[key]) ~= info.d then
      error(("slice: option '%s' must be a shape, %d numbers"):format(key, info.d), 0)
    end
  end
  if what == "curvature" and info.d < 2 then
    error("slice: a shape of one coordinate has no curvature: it is a two-form, and needs two "
      .. "directions", 0)
  end
  local points = option.whole(options, "points", "slice", 2, nil, 200)
  return info, points, core.vector(ends.from), core.vector(ends.to)
end

-- the coordinate that changes most, and its label
local function axis(info, a, b)
  local best = 1
  for i = 1, info.d do if math.abs(b[i] - a[i]) > math.abs(b[best] - a[best]) then best = i end end
  return best, info.names[info.shape[best]]
end

M.slice = blame.caller(function(shape, what, options)
  local info, points, a, b = check(shape, what, options)
  local best, label = axis(info, a, b)
  if a == b then
    error("slice: 'from' and 'to' are the same shape: a line goes from one to another", 0)
  end
  local series = core.result {}
  for k = 0, points - 1 do
    local x = a + (k / (points - 1)) * (b - a)
    local fine, value = blame.try(shape[what], shape, x, options.t)
    if fine then
      for i, entry in ipairs(entries(what, value, info)) do
        local s = series[i] or { x = {}, y = {}, name = entry[1], xlabel = label,
          ylabel = (what:gsub("_", " ")) }
        series[i] = s
        s.x[#s.x + 1], s.y[#s.y + 1] = x[best], entry[2]
      end
    end
  end
  if #series == 0 then error("slice: L is not finite anywhere on this line", 0) end
  return series
end)

class.method("dm.system", "slice", M.slice, [[
shape:slice(what, {from=, to=, points=, t=}) -> list of series for dm.plot
"amended_potential", "connection", "curvature" or "locked_inertia" along the straight line between
two shapes, a series { x =, y =, name = } for each entry against the coordinate that changes most:
dm.plot(shape:slice("curvature", { from = a, to = b }), { file = "curvature.png" }).]])

return M
