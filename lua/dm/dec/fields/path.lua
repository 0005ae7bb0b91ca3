--- Paths of fields: rows as forms, and columns that only fields have.
local class = require "dm.base.class"
local core = require "dm.core"
local form = require "dm.dec.form"
local option = require "dm.base.options"

local M = {}

-- the field that a path is of
local function field_of(path, where)
  local f = path.system.field
  if not f then option.fail(where, "the system of this path is no field: K:field makes one") end
  return f
end

local function one_of(f, x, c)
  local values = core.constant(f.cells, 0)
  for i = 1, f.cells do values[i] = x[(i - 1) * f.values + c] end
  return form.new(f.mesh, f.degree, "primal", values)
end

class.method("dm.path", "form", function(path, i, what)
  local f = field_of(path, "path:form")
  option.one_of({ what = what }, "what", "path:form", { "q", "p" })
  local x = (what == "p" and path.p or path.q)[i]
  if x == nil then
    option.fail("path:form", "there are rows 1 to %d (got %s)", #path, tostring(i))
  end
  if f.values == 1 then return form.new(f.mesh, f.degree, "primal", 1 * x) end
  local list = core.result {}
  for c = 1, f.values do list[c] = one_of(f, x, c) end
  return list
end, [[
path:form(i [, "q" | "p"]) -> dm.form
Row i of the path of a field as a form, its momenta with "p"; a list of forms where a cell has
several values.]])

---- Gauss's law ----

-- cells of degree k - 1 all of whose cofaces are free
local function free_faces(f)
  local free = {}
  for i = 1, f.mesh:count(f.degree - 1) do
    free[i] = true
    for _, j in ipairs(f.mesh:cofaces(f.degree - 1, i)) do
      if f.held[(j - 1) * f.values + 1] then free[i] = false end
    end
  end
  return free
end

-- d^T of the momenta of row i, component c
local function charge(f, path, i, c)
  local p = path.p[i]
  local values = f.values == 1 and p or one_of(f, p, c).values
  return f.mesh:boundary_sum(f.degree, values)
end

-- does L have the form in its d alone? Then the force on d f vanishes for every f at free faces.
local function is_exact(f, path)
  if f.is_exact == nil then
    local q = core.constant(f.n, 0)
    for i = 1, f.n do q[i] = math.sin(1.7 * i) end
    local force, worst = core.field_force(path.system, q, path.t[1]), 0
    for c = 1, f.values do
      local values = f.values == 1 and force or one_of(f, force, c).values
      local sum = f.mesh:boundary_sum(f.degree, values)
      for j = 1, #sum do if f.free[j] then worst = math.max(worst, math.abs(sum[j])) end end
    end
    f.is_exact = worst <= 1e-10 * force:norm()
  end
  return f.is_exact
end

local function gauss(f, path)
  if f.degree == 0 then
    option.fail("column 'gauss'", "a form of degree 0 has no Gauss's law")
  end
  f.free = f.free or free_faces(f)
  if not is_exact(f, path) then
    option.fail("column 'gauss'", "L has the form not in its d alone: nothing keeps d^T p")
  end
  local out = core.constant(#path, 0)
  for c = 1, f.values do
    local first = charge(f, path, 1, c)
    for i = 2, #path do
      local now = charge(f, path, i, c)
      for j = 1, #now do
        if f.free[j] then out[i] = math.max(out[i], math.abs(now[j] - first[j])) end
      end
    end
  end
  return out
end

local COLUMNS = { gauss = gauss }

--- The column of a path of a field that has this name, or nothing.
function M.column(f, path, name)
  local make = COLUMNS[name]
  return make and make(f, path)
end

return M
