--- Potentials of closed forms, or what is in their way (Leok 3.11).
local class = require "dm.base.class"
local form = require "dm.dec.form"
local homology = require "dm.dec.homology"
local matching = require "dm.dec.homology.matching_cone"
local morse = require "dm.dec.homology.morse"
local option = require "dm.base.options"

local M = {}

local function fail(...) option.fail("mesh:potential", ...) end

local CLOSED = 1e-10 -- max |da| of max |a|

local SMALL = 1e-3 -- what integrals of a closed form by quadrature may leave

local function check_closed(K, a)
  local da, largest = a:d(), CLOSED * a:max()
  for cell = 1, #da do
    local off = math.abs(da[cell])
    if not (off <= largest) then
      fail("the form is not closed: da = %.3g on the cell {%s} of degree %d, and no d of "
        .. "anything%s", da[cell], table.concat(K:simplices(da.degree)[cell], ", "), da.degree,
        off <= SMALL * a:max() and "; integrals of a function are as closed as they are exact: "
        .. "K:form(k, f, { order = 21 })" or "")
    end
  end
end

-- the period over a chain, and the sum of moduli that its round-off goes by
local function period_of(a, c)
  local sum, size = 0.0, 0.0
  for _, cell in ipairs(c:support()) do
    local x = c.coefficients[cell] * a.values[cell]
    sum, size = sum + x, size + math.abs(x)
  end
  return sum, size
end

local function check_periods(m, a)
  for i, c in ipairs(homology.of(m, a.degree).generators) do
    local period, size = period_of(a, c)
    if math.abs(period) > CLOSED * size then
      fail("the form is closed but not exact: its period over generator %d of degree %d is %.10g "
        .. "(%s)", i, a.degree, period, tostring(c))
    end
  end
end

class.method("dm.mesh", "potential", function(K, a)
  if not form.is_form(a) or not rawequal(a.mesh, K) then
    fail("a form of this mesh is needed (got %s)", option.got(a))
  end
  if a.side ~= "primal" or a.degree == 0 then
    fail("a primal form of degree 1 or more is needed (got a %s)", form.name(a))
  end
  local m = morse.of(K)
  if a.degree < K.dimension then check_closed(K, a) end
  check_periods(m, a)
  return form.new(K, a.degree - 1, "primal",
    matching.engine(m).cocone(a.degree - 1, a.values))
end, [[
K:potential(a) -> dm.form
A form b with db = a. Raises "not closed", with the cell where |da| is above 1e-10 max |a|, or "not
exact", with a generator of homology and the period of a over it. It is the cocone of K:cone() (Leok
3.11).]])

return M
