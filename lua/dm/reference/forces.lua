--- The forces of a system as one traced function of (q, v, t), for steps that must not jump over
-- what is narrow in them (solver:run{control = { hidden = }}).
local blame = require "dm.base.blame"
local bound = require "dm.base.bound"
local core = require "dm.core"
local lists = require "dm.base.lists"

local M = {}

local entries = lists.entries

local LARGEST = 20000  -- operations: beyond it nothing is looked for

-- operations that make no narrow feature of smooth motion: sums, products, powers of low degree
local SMOOTH = { ["+"] = true, ["-"] = true, ["*"] = true, fma = true }

-- is every node of the function a polynomial?
local function is_polynomial(f)
  for line in f:graph():gmatch "[^\n]+" do
    local text = (line:match "= (.*)$" or ""):gsub("%^[2-6]%f[%D]", "")
    for word in text:gmatch "%a[%w_]*" do
      if not word:find "^[tx]%d+$" and not SMOOTH[word] then return false end
    end
    if text:find "[/^]" then return false end
  end
  return true
end

-- (dL/dq, what else pushes, dL/dv): of the last what counts is its size, of the others their
-- impulse
local function all_forces(system)
  local given, n = system.given, system.Q.dimension
  local L = bound(given.L, given.params)
  local slope = core.derivative(function(q, v, t) return L(q, v, t) end, n, n, "number")
  local force = given.force and not given.control and bound(given.force, given.params)
  return core.trace(function(q, v, t)
    local g, out = slope(q, v, t), {}
    for i = 1, n do out[i] = g[i] end
    for _, f in ipairs(force and entries(force(q, v, t)) or {}) do out[#out + 1] = f end
    for i = 1, n do out[#out + 1] = g[n + i] end
    return core.vector(out)
  end, n, n, "number")
end

--- The function, or nil and why nothing can be hidden in the forces, or is not looked for.
function M.of(system)
  if not system.given.L then return nil, "the system is given by its H" end
  if system.place then return nil, "the system lives on a group" end
  local fine, f = blame.try(all_forces, system)
  if not fine then return nil, "the forces are not traced" end
  if f:operations() > LARGEST then
    return nil, ("the forces are %d operations"):format(f:operations())
  end
  if is_polynomial(f) then return nil end
  return f
end

return M
