--- The six data that a discrete connection can be given by (Leok 4.4), each read as the one-form
-- A_d(q0, q1). In a trivialization, with A(x0, x1) = A_d((x0, e), (x1, e)):
--   A_d((x0, g0), (x1, g1)) = g1 A(x0, x1) g0^-1         local_form: A itself
--   hor(q0, q1) = (q0, A_d(q0, q1)^-1 q1)                horizontal: its second point
--   (x0, x1)^h_q0 = ((x0, g0), (x1, g0 A(x0, x1)^-1))    lift: its second point
--   phi([q0, q1]) = [q0, A_d(q0, q1)]                    splitting: a representative { q, g }
--   (x0, x1)^h in (Q x Q)/G                              horizontal_splitting: one, q0, q1
local bundles = require "dm.connection.bundle"

local M = {}

local SAYS = "what %s returns"

-- the second point of a pair that should lie over x1
local function second_point(B, q, x1, name)
  local text = SAYS:format(name)
  q = B.take(q, text)
  bundles.same_fibre(B, q[1], x1, "%s must lie over x1", text)
  return q
end

-- A_d, where q1 = A_d qbar
local function from_horizontal(B, q1, qbar) return bundles.between(B, qbar, q1) end

M.by = {}

function M.by.local_form(B, f)
  return function(q0, q1)
    local A = bundles.element(B, f(q0[1], q1[1]), SAYS:format "local_form")
    return B.kit.compose(B.kit.compose(q1[2], A), B.kit.inverse(q0[2]))
  end
end

function M.by.one_form(B, f)
  return function(q0, q1)
    return bundles.element(B, f(B.give(q0), B.give(q1)), SAYS:format "one_form")
  end
end

function M.by.horizontal(B, f)
  return function(q0, q1)
    return from_horizontal(B, q1,
      second_point(B, f(B.give(q0), B.give(q1)), q1[1], "horizontal"))
  end
end

function M.by.lift(B, f)
  return function(q0, q1)
    return from_horizontal(B, q1, second_point(B, f(q0[1], q1[1], B.give(q0)), q1[1], "lift"))
  end
end

-- the class is known by any representative: the one whose first slot is q0 is wanted [E3]
function M.by.splitting(B, f)
  return function(q0, q1)
    local class = f(B.give(q0), B.give(q1))
    if type(class) ~= "table" or #class ~= 2 then
      error("what splitting returns must be a representative { q, g } of [q0, g]", 0)
    end
    local q = B.take(class[1], SAYS:format "splitting" .. ": q")
    bundles.same_fibre(B, q[1], q0[1], "what splitting returns: q must lie over x0")
    local g = bundles.element(B, class[2], SAYS:format "splitting" .. ": g")
    return bundles.conjugate(B, bundles.between(B, q, q0), g)
  end
end

function M.by.horizontal_splitting(B, f)
  return function(q0, q1)
    local a, b = f(q0[1], q1[1])
    if b == nil then error("horizontal_splitting must return two points, q0 and q1", 0) end
    local text = SAYS:format "horizontal_splitting"
    a, b = B.take(a, text .. ": q0"), second_point(B, b, q1[1], "horizontal_splitting")
    bundles.same_fibre(B, a[1], q0[1], "%s: q0 must lie over x0", text)
    return from_horizontal(B, q1, bundles.move(B, bundles.between(B, a, q0), b))
  end
end

M.names = { "local_form", "one_form", "horizontal", "lift", "splitting", "horizontal_splitting" }

return M
