--- rsprk(rule): the reduced symplectic partitioned Runge-Kutta rule of Leok 2.5 on a reduced
-- system. In the variables (x, p), p = s + mu A(x), it is the rule itself on the classical
-- Routhian, so that is what steps; paths hold p, and shape:magnetic_momentum gives s.
local core = require "dm.core"
local blame = require "dm.base.blame"
local lists = require "dm.base.lists"
local routh = require "dm.reduce.routh"

local M = {}

-- explicit Runge-Kutta methods: no partitioned rule makes them symplectic (Leok 2.4.2)
local function is_hopeless(name)
  for _, row in ipairs(core.rules()) do
    if row.name == name then return row.explicit and not row.symplectic end
  end
end

-- "gauss(2)" of "rsprk(gauss(2))" and "rsprk(gauss, 2)"
local function inner(text)
  local inside = text:match "^%s*rsprk%s*%((.*)%)%s*$"
  if not inside then
    error(("rule '%s': write rsprk(rule) with the name of a rule, for instance \"rsprk(gauss(2))\"")
      :format(text), 0)
  end
  if is_hopeless(inside:match "^%s*([%w]+)") then
    error(("rule '%s': %s is not symplectic, so it is no reduced symplectic rule; shape:solver { "
      .. "rule = \"%s\" } steps the shape with it")
      :format(text, inside, inside), 0)
  end
  local name, stages = inside:match "^%s*([%a%-]+)%s*,%s*(%d+)%s*$"
  return name and ("%s(%s)"):format(name, stages) or inside
end

--- system:solver(options) with such a rule; plain is the method without it.
M.solver = blame.caller(function(plain, system, options)
  local rule = options.rule
  if not routh.info(system) then
    error(("rule '%s' steps a reduced system, made by system:routh { cyclic = ..., mu = ... }")
      :format(rule), 0)
  end
  local other = lists.copy(options)
  other.rule = inner(rule)
  return plain(system, other)
end)

return M
