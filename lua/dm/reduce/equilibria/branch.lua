--- What shape:relative_equilibria and shape:continue give: an equilibrium, and a branch of them
-- with its columns, as they print and as dm.plot takes them.
local class = require "dm.base.class"
local core = require "dm.core"

local M = {}

local max = math.max

local function list_text(v)
  local out = {}
  for i = 1, #v do out[i] = ("%.6g"):format(v[i]) end
  return "(" .. table.concat(out, ", ") .. ")"
end

M.WORD = { energy = "stable (minimum)", spectral = "stable (spectrum)", [false] = "unstable" }

---- one of them ----

local one = { __name = "dm.relative_equilibrium" }

function one.__tostring(e)
  local flat = e.flat > 0
    and (", V_mu is flat in %d direction%s"):format(e.flat, e.flat == 1 and "" or "s") or ""
  return ("x = %-36s energy %-12.6g velocity %-14s index %d  %s%s")
    :format(list_text(e.x), e.energy, list_text(e.velocity), e.index, M.WORD[e.stable], flat)
end

--- The fields of an equilibrium as a value that prints itself.
function M.equilibrium(fields) return setmetatable(fields, one) end

--- Is a value one of them?
function M.is_equilibrium(value) return type(value) == "table" and getmetatable(value) == one end

---- a branch ----

local branch = { __name = "dm.branch" }

function branch.__tostring(b)
  local head = "branch of %d relative equilibria, mu from %.6g to %.6g"
  local out = { head:format(#b, b[1].momentum, b[#b].momentum) }
  for _, e in ipairs(b.events) do
    out[#out + 1] = ("  %s near mu = %.6g, x = %s"):format(e.what, e.momentum, list_text(e.x))
  end
  return table.concat(out, "\n")
end

local function column(b, key)
  local read = rawget(b, "rows_of")[key]
  if not read then return nil end
  local out = {}
  for i = 1, #b do out[i] = read(b[i]) end
  return core.locked(core.vector(out), "a column of a branch")
end

function branch.__index(b, key)
  local found = branch.methods[key] or column(b, key)
  if found == nil and type(key) == "string" then core.miss("dm.branch", key) end
  return found
end
branch = core.class(branch, [[
dm.branch: relative equilibria followed in the momentum by shape:continue
fields: [i] (as in relative_equilibria, with momentum), events ({what, momentum, x, at}: folds,
changes of stability, crossings); columns, vectors: mu, energy, velocity, growth (largest real part
of a characteristic value), the coordinates of the shape by name or as x1, x2, ...; for groups of
several dimensions velocity1, velocity2, ...]])

class.method("dm.branch", "series", function(b, x, y)
  x, y = x or "mu", y or "energy"
  local out = core.result { xlabel = x, ylabel = y }
  for axis, key in pairs { x = x, y = y } do
    out[axis] = type(key) == "string" and column(b, key)
    if not out[axis] then
      local names = {}
      for name in pairs(rawget(b, "rows_of")) do names[#names + 1] = name end
      table.sort(names)
      error(("branch:series: there is no column '%s'; columns are %s")
        :format(tostring(key), table.concat(names, ", ")), 0)
    end
  end
  return out
end, [[
branch:series([x, y]) -> series for dm.plot
Two columns of a branch against each other (default "mu", "energy"): dm.plot { up:series(),
down:series() } is a bifurcation diagram.]])

local READ = {
  mu = function(e) return e.momentum end,
  energy = function(e) return e.energy end,
  velocity = function(e) return e.velocity[1] end,
  growth = function(e)
    local worst = 0
    for _, value in ipairs(e.values) do worst = max(worst, value[1]) end
    return worst
  end,
}

--- A branch that begins with `first`, of the reduction `info`.
function M.branch(info, first)
  local rows = {}
  for i = 1, info.d do
    local function read(e) return e.x[i] end
    rows[info.own[i]], rows["x" .. i] = read, read
  end
  for a = 1, info.m do rows["velocity" .. a] = function(e) return e.velocity[a] end end
  for name, read in pairs(READ) do rows[name] = read end
  return setmetatable({ first, events = {}, rows_of = rows }, branch)
end

return M
