--- The first level of boxes: components that are given, and those that follow from rows without
-- z_t. What is given and does not satisfy these rows is moved there, or refused: they would be off
-- by the same at every level, with alternating signs.
local algebra = require "dm.line.box_algebra"
local blame = require "dm.base.blame"
local core = require "dm.core"
local follow = require "dm.line.box_follow"
local grids = require "dm.line.grid"
local kernel = require "dm.line.box_kernel"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local sample = require "dm.line.sample"

local M = {}

local WHERE = "solver:run"
local FAR = 0.25  -- of its size: what a component may be moved by
local SAME = 1e-9 -- of its size: what is not worth telling
local CLOSED = 1e-9 -- of its terms: a sum round the ring that is 0
local BOUND = 1e-8 -- of its terms: by how much a row without z_t may be off

-- adds slope (x - from) at all nodes
local function lift(boxes, values, slope)
  for i = 1, slope ~= 0 and boxes.cells or 0 do
    values[i] = values[i] + slope * (i - 1) * boxes.dx
  end
end

-- of a component that gains a constant: of a function; of a list, the last box as those beside it
local function slope_of(boxes, f, values)
  local n = boxes.cells
  if type(f) == "function" then return (f(boxes.to) - f(boxes.from)) / (boxes.to - boxes.from) end
  local last = (values[2] - values[1] + values[n] - values[n - 1]) / 2
  return (values[n] - values[1] + last) / (n * boxes.dx)
end

-- given components as vectors, by number, less what they gain
local function given_of(boxes, z)
  if type(z) ~= "table" then
    option.fail(WHERE, "option 'z' must be a table { %s = f, ... } (got %s)", boxes.names[1],
      option.got(z))
  end
  local out = {}
  for name, f in pairs(z) do
    local c = boxes.number[name]
    if not c then
      option.fail(WHERE, "option 'z': there is no component %s; there are %s", option.got(name),
        table.concat(boxes.names, ", "))
    end
    out[c] = grids.values(boxes.grid, f, 1, name, WHERE)
    if boxes.gain[c] then boxes.slope_given[c] = slope_of(boxes, f, out[c]) end
    boxes.slope[c] = boxes.slope_given[c]
    lift(boxes, out[c], -(boxes.slope[c] or 0))
  end
  return out
end

-- the slope of a gained component that the gauge mode asks for: y K slope - (2/h) pull . mean z =
-- y grad S(0), without which no level above exists
local function fit_slope(boxes, gauge, known, h)
  local sum, at = boxes.gradient(core.zeros(boxes.d)):dot(gauge.y), nil
  local terms = math.abs(sum)
  local function add(x, size) sum, terms = sum + x, terms + size end
  for c = 1, boxes.d do
    local pulled = 0
    for r = 1, boxes.d do pulled = pulled + gauge.y[r] * boxes.K[r][c] end
    local pull = 2 / h * gauge.pull[c]
    local values, n = known[c], boxes.cells
    if values then add(pull * values:sum() / n, math.abs(pull) * values:norm() / math.sqrt(n)) end
    if boxes.gain[c] and pulled ~= 0 then at = { c = c, pulled = pulled } end
    local gained = boxes.slope[c] and not (at and at.c == c) and pulled * boxes.slope[c] or 0
    add(-gained, math.abs(gained))
  end
  if at then
    boxes.slope[at.c] = sum / at.pulled
  elseif math.abs(sum) > CLOSED * terms then
    option.fail(WHERE, "the start has no level above it: its means are off by %.3g; a component "
      .. "that gains a constant round the ring is to be named in 'gain', or h is at a resonance of "
      .. "the boxes: take another h", sum)
  end
end

---- what is given twice ----

local function mean_of(values) return values:sum() / #values end

-- how far two vectors are apart, and how large they are, `shift` taken off the second
local function apart(a, b, shift)
  local off, size, middle = 0, 0, shift ~= 0 and mean_of(a) or 0
  for i = 1, #a do
    off = math.max(off, math.abs(b[i] - shift - a[i]))
    size = math.max(size, math.abs(a[i] - middle), math.abs(b[i] - shift - middle))
  end
  return off, size
end

-- component c as it follows, in the place of what is given; where S does not depend on it its
-- constant is the given one
local function move(state, given, found, c)
  local name, shown = state.names[c], 1 * found
  lift(state, shown, (state.slope[c] or 0) - (state.slope_given[c] or 0))
  local shift = algebra.depends(state, c) and 0 or mean_of(shown) - mean_of(given)
  local off, size = apart(given, shown, shift)
  if off > FAR * size then
    option.fail(WHERE, "'%s' of the start does not satisfy the rows without z_t (K z_x = grad S): "
      .. "it is off by %.3g from what follows from the others, which is %.3g at most; leave '%s' "
      .. "out, it follows", name, off, size, name)
  end
  for i = 1, #found do found[i] = found[i] - shift end
  if off > SAME * size then state.moved[name] = off end
  return found
end

-- y (K D z - grad S(m z)) in all boxes: the largest, that of its terms, and where
local function off_bond(state, known, y)
  local largest, terms, at = 0, 0, 1
  for i = 1, state.cells do
    local sum, gradient = 0, follow.slopes(state.gradient, follow.mean(state, known, i), i)
    for r = 1, y[1] and state.d or 0 do
      local D = y[r] ~= 0 and follow.differences(state, r, known, i) or 0
      sum, terms = sum + y[r] * (D - gradient[r]), math.max(terms, math.abs(y[r] * D),
        math.abs(y[r] * gradient[r]))
    end
    if math.abs(sum) > largest then largest, at = math.abs(sum), i end
  end
  return largest, terms, at
end

-- does a row of y have a component of this list?
local function has(state, y, list)
  for r = 1, state.d do
    for _, c in ipairs(y[r] ~= 0 and list or {}) do
      if state.K[r][c] ~= 0 or algebra.depends(state, c, r) then return true end
    end
  end
  return false
end

-- the first bond that the start does not satisfy, of those without open components, which are not
-- known yet: { y, off, at }; nil: there is none
local function broken(state, known, open)
  for _, y in ipairs(algebra.bonds(state)) do
    if not has(state, y, open) then
      local off, terms, at = off_bond(state, known, y)
      if off > BOUND * terms then return { y = y, off = off, at = at } end
    end
  end
end

local function row_of(y)
  local rows = {}
  for r = 1, #y do if y[r] ~= 0 then rows[#rows + 1] = r end end
  return (#rows == 1 and "row " or "a combination of the rows ") .. table.concat(rows, ", ")
end

-- components with a z_t that are given, those first that gain a constant
local function candidates(state, given)
  local out = {}
  for pass = 1, 2 do
    for c = 1, state.d do
      local now = (state.gain[c] and 1 or 2) == pass
      if now and given[c] and state.turns[c] then out[#out + 1] = c end
    end
  end
  return out
end

-- Where components with a z_t are given that a row binds to each other, one is moved; a loose one
-- that it binds is named: steps keep it as far off, to and fro.
local function bind(state, known, given, open, loose)
  local bond = broken(state, known, open)
  if not bond then return end
  for _, c in ipairs(candidates(state, given)) do
    local others, slope = {}, state.slope[c]
    for k, values in pairs(known) do others[k] = k ~= c and values or nil end
    local fine = blame.try(follow.all, state, others, {})
    if fine and others[c] and not broken(state, others, open) then
      known[c] = move(state, given[c], others[c], c)
      return
    end
    state.slope[c] = slope
  end
  for _, c in ipairs(loose) do
    if has(state, bond.y, { c }) then
      option.fail(WHERE, "'%s' of the start does not satisfy %s, which has no z_t: K z_x = grad S "
        .. "is off by %.3g in the box at node %d, and would be at every level, to and fro; leave "
        .. "'%s' out, it follows", state.names[c], row_of(bond.y), bond.off, bond.at,
        state.names[c])
    end
  end
  option.fail(WHERE, "the start does not satisfy %s, which has no z_t: K z_x = grad S is off by "
    .. "%.3g in the box at node %d, and would be at every level; give fewer components, others "
    .. "follow", row_of(bond.y), bond.off, bond.at)
end

-- known components from those that are given: with a z_t first, then what follows, then others
local function compose(state, given)
  local known, found = {}, {}
  for c = 1, state.d do if state.turns[c] then known[c] = given[c] end end
  follow.all(state, known, given)
  for c = 1, state.d do
    found[c] = known[c] ~= nil and known[c] ~= given[c]
    if known[c] == nil and given[c] then
      known[c] = given[c]
      follow.all(state, known, given)
    end
  end
  for c = 1, state.d do
    if found[c] and given[c] then known[c] = move(state, given[c], known[c], c) end
  end
  return known
end

-- components without a z_t that no row tells, and zeros for those that are not given
local function loose_of(state, known, given)
  local loose = {}
  for c = 1, state.d do
    if not known[c] and state.turns[c] then
      option.fail(WHERE, "component '%s' is needed: z_t of it occurs, and no row without z_t "
        .. "tells it (one that has its differences leaves a constant open)", state.names[c])
    end
    if not state.turns[c] and (not known[c] or known[c] == given[c]) then loose[#loose + 1] = c end
    known[c] = known[c] or core.zeros(state.cells)
  end
  return loose
end

-- what was given where M's kernel lies along no component, moved along that kernel
local function moved_along_kernel(state, given)
  local known = kernel.solve(state, given, state.slope)
  for c, values in pairs(given) do
    local off, size = apart(values, known[c], 0)
    if off > FAR * size then
      option.fail(WHERE, "'%s' of the start does not satisfy the rows without z_t (y (K z_x - grad "
        .. "S) = 0 where y M = 0): it is off by %.3g from what follows, which is %.3g at most; "
        .. "leave a component out, it follows", state.names[c], off, size)
    end
    if off > SAME * size then state.moved[state.names[c]] = off end
  end
  return known
end

-- On a ring of an even number of nodes: loose components as near to what is given as their rows
-- allow; a list of those.
local function settle_given(state, known, given, loose)
  local told, sure = {}, lists.copy(known)
  for _, c in ipairs(loose) do sure[c] = nil end
  for _, c in ipairs(state.cells % 2 == 0 and loose or {}) do
    local found = given[c] and follow.nearest(state, c, sure, given[c])
    if found then known[c], told[#told + 1] = move(state, given[c], found, c), c end
  end
  return told
end

-- all components, and those that nothing tells, row by row
local function by_rows(state, given)
  local known = compose(state, given)
  local loose = loose_of(state, known, given)
  local open = settle_given(state, known, given, loose)
  for _, c in ipairs(loose) do if not given[c] then open[#open + 1] = c end end
  bind(state, known, given, open, loose)
  return known, loose
end

-- the same; where rows do not tell them, and M's kernel lies along no component, all at once
local function known_of(state, given)
  if kernel.is_aligned(state) then return by_rows(state, given) end
  local slopes = lists.copy(state.slope)
  local fine, known, loose = blame.try(by_rows, state, given)
  if fine then return known, loose end
  state.slope, state.moved = slopes, {}
  return moved_along_kernel(state, given), {}
end

-- Raises where S is no number at the mean of a box.
local function check_domain(state, known)
  for i = 1, state.cells do
    local value = sample.number(state.S, follow.mean(state, known, i))
    if value - value ~= 0 then
      option.fail(WHERE, "S of the start is no finite number in the box at node %d: is it inside "
        .. "of the domain of S?", i)
    end
  end
end

--- { z = vector of all nodes, node after node; slope = of gained components; loose = components
-- that nothing tells; given, moved = by name, how far what was given is from where it starts }.
function M.level(boxes, z, solver)
  local state = setmetatable({ slope = {}, slope_given = {}, turns = {}, moved = {} },
    { __index = boxes })
  for c = 1, boxes.d do state.turns[c] = not algebra.is_zero(boxes.M[c]) end
  local given = given_of(state, z)
  local known, loose = known_of(state, given)
  check_domain(state, known)
  for _, gauge in ipairs(solver.gauges) do fit_slope(state, gauge, known, solver.h) end
  local all = core.zeros(boxes.cells * boxes.d)
  for i = 1, boxes.cells do
    for c = 1, boxes.d do all[(i - 1) * boxes.d + c] = known[c][i] end
  end
  return { z = all, slope = state.slope, loose = loose, given = given, moved = state.moved }
end

return M
