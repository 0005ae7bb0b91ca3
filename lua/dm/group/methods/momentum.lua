--- Momentum maps of a dm.action on paths and discrete Lagrangians, beside those of a group's
-- standard action.
local blame = require "dm.base.blame"
local classes = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"

-- where the momentum of a coordinate of this name is, "" where there is none
local function of_coordinate(path, name)
  for _, column in ipairs(path.columns) do
    if column == "p_" .. name or column == name:gsub("^q%f[%d]", "p") and column ~= name then
      return "; that of a coordinate is a column: path." .. column
    end
  end
  return ""
end

-- the method `momentum` of a class, which asks `other` when its argument is a dm.action
local function also_of_actions(class, other, signature)
  local most = select(2, signature:gsub(",", "")) + 1
  local momentum, doc, put = classes.wraps("dm.group.methods.momentum", class .. ":momentum")
  doc = doc:gsub("^([^\n]*)\n", "%1   or   " .. signature .. "\n", 1)
  put(blame.relay(function(object, action, ...)
    if action == nil and kits.class_of(object) == class or type(action) == "string" then
      error(("momentum: of what? a group, such as dm.SO(2), a dm.action, or a function (got %s)%s")
        :format(action and "a string" or "nil", action and class == "dm.path"
          and of_coordinate(object, action) or ""), 0)
    end
    local meta = type(action) == "table" and getmetatable(action)
    if not meta or meta.__name ~= "dm.action" or kits.class_of(object) ~= class then
      return momentum(object, action, ...)
    end
    if select("#", ...) >= most and (select(most, ...)) ~= nil then
      error(("bad argument #%d to 'momentum' (a surplus argument: %s)")
        :format(most + 2, signature), 0)
    end
    return other(object, action, ...)
  end, "momentum"), doc)
end

-- J of a point of one or several blocks of the size the action has
local function blockwise(action, q, p)
  local m, n = action.dimension, #q
  if n % m ~= 0 then
    error(("%s moves points of %d numbers, but there are %d coordinates")
      :format(tostring(action), m, n), 0)
  end
  local J = core.zeros(action.group.dimension)
  for first = 1, n, m do
    J = J + action:momentum(q:slice(first, first + m - 1), p:slice(first, first + m - 1))
  end
  return J
end

also_of_actions("dm.path", blame.caller(function(path, action)
  if path.watched then error("a path of watched numbers has no momentum map: record states", 0) end
  if path.system.place then
    error(("path:momentum: on %s give the group, and how it moves elements: path:momentum(%s, "
      .. "{ action = function(k, g) ... end })")
      :format(tostring(path.system.Q), tostring(action.group)), 0)
  end
  local q, p, rows, first = path.q, path.p, {}, {}
  for i = 1, #path do
    rows[i] = blockwise(action, q[i], p[i])
    first[i] = rows[i][1]
  end
  return action.group.dimension == 1 and core.vector(first) or core.matrix(rows)
end), "path:momentum(action)")

also_of_actions("dm.discrete_lagrangian", blame.caller(function(Ld, action, q0, q1, t)
  local p1 = Ld:legendre_plus(q0, q1, t)  -- checks the points
  return blockwise(action, core.vector(q1), p1)
end), "Ld:momentum(action, q0, q1, t)")

return {}
