--- Starts of a field: q, v and p as forms, functions of the position, or lists of all values.
local core = require "dm.core"
local form = require "dm.dec.form"
local held = require "dm.dec.fields.held"
local option = require "dm.base.options"

local M = {}

-- one value a cell: the integrals of f over cells
local function integrated(f, of)
  return f.mesh:form(f.degree, of).values
end

-- several values a cell: those of f at the centre; f returns a list
local function sampled(f, of, key)
  local out, at = core.constant(f.n, 0), 0
  for i, p in ipairs(held.centres(f.mesh, f.degree)) do
    local x = of(table.unpack(p))
    if type(x) ~= "table" and type(x) ~= "userdata" or #x ~= f.values then
      option.fail(("field '%s'"):format(key), "the function must return a list of %d numbers at "
        .. "every cell (got %s at cell %d)", f.values, option.got(x), i)
    end
    for c = 1, f.values do out[at + c] = x[c] end
    at = at + f.values
  end
  return out
end

local function of_form(f, a, key)
  local where = ("field '%s'"):format(key)
  if not rawequal(a.mesh, f.mesh) then option.fail(where, "the form is of another mesh") end
  if a.degree ~= f.degree or a.side ~= "primal" or f.values ~= 1 then
    option.fail(where, "a primal %d-form with %d number%s a cell is needed (got a %s)", f.degree,
      f.values, f.values == 1 and "" or "s", form.name(a))
  end
  return a.values
end

local function of_forms(f, list, key)
  local out = core.constant(f.n, 0)
  for c = 1, f.values do
    local a = of_form({ mesh = f.mesh, degree = f.degree, values = 1 }, list[c], key)
    for i = 1, #a do out[(i - 1) * f.values + c] = a[i] end
  end
  return out
end

--- What solver:run takes in the place of x: a form (a list of forms where there are several
-- values), a function, or a list, which is left alone.
function M.read(f, x, key)
  if form.is_form(x) then return of_form(f, x, key) end
  if type(x) == "function" then
    return f.values == 1 and integrated(f, x) or sampled(f, x, key)
  end
  if type(x) == "table" and #x == f.values and form.is_form(x[1]) then
    return of_forms(f, x, key)
  end
  return x
end

return M
