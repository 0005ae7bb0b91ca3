--- What solving an invariant problem gives: curves, and failures with the points so far.
local core = require "dm.core"
local windows = require "dm.frame.invariant_windows"

local M = {}

local Curve = core.class({ __name = "dm.invariant_curve" }, [[
dm.invariant_curve: a sequence of points, from problem:solve or problem:boundary
fields: points (dm.matrix, a row each), invariants (vectors by name), multiplier, first_site, frame
(the last group element), form; iterations, residual (of problem:boundary); #curve is the number of
points.]])
M.Curve = Curve
function Curve.__tostring(c)
  return ("curve of %d points%s")
    :format(#c.points, c.form and (", by the form of " .. c.form) or "")
end
function Curve.__len(c) return #c.points end

--- The curve through the points of the rows, those before and those in the last window
function M.of(p, form, rows, before)
  local layout, points, last = form.layout, {}, rows[#rows]
  for i, z in ipairs(before) do points[i] = z:totable() end
  for i = 1, #rows do points[#points + 1] = layout:get(rows[i], "u") end
  local g = p.group:unflat(core.vector(layout:get(last, "g")))
  for j, z in ipairs(windows.blocks(layout:get(last, "U"), p.window, p.d)) do
    if j > 1 then points[#points + 1] = p.act(p.group:inverse(g), z):totable() end
  end
  local curve = setmetatable({ points = core.matrix(points), frame = g, invariants = {},
    multiplier = nil }, Curve)
  for k, name in ipairs(p.names) do
    local values = {}
    for i = 2, #rows do values[i - 1] = layout:get(rows[i], "I")[k] end
    if #values > 0 then curve.invariants[name] = core.vector(values) end
  end
  if p.constraints > 0 and #rows > 1 then
    local mu = {}
    for i = 2, #rows do
      local x = layout:get(rows[i], "x1")
      mu[i - 1] = { table.unpack(x, p.d + 1, p.d + p.constraints) }
    end
    curve.multiplier = core.matrix(mu)
  end
  return curve
end

local Failure = { __name = "dm.failure", __tostring = function(f) return f.message end }

M.Failure = Failure

--- loop(options), a loop of the core: where a stop ends it, its path becomes the curve that
-- curve_of(path) gives.
function M.run(loop, options, curve_of)
  local fine, out, report = core.until_stop(loop, options)
  if fine then return out, report end
  if type(out) == "table" then
    out.path = curve_of(out.path)
    out.points = out.path.points
  end
  error(out, 0)
end

--- Raises for a step that has no root, with the curve so far.
function M.stopped(p, report, curve, at)
  local why = report.text
  if report.outside > 0 then
    why = ("the root breaks condition %d of 'inside'"):format(report.outside)
  end
  local advice = report.code == "singular"
    and "the equations do not determine the next point: is L degenerate (does it see all of the "
    .. "last point, beside the first?), or is a constraint missing"
    or "the equation for the next invariants has no root there that follows from the last ones; "
    .. "try closer points"
  local message = ("%s: %s at point %d (step %d, residual %.3g after %d iterations): %s; "
    .. "failure.path has the %d points so far")
    :format(p.name or "invariant problem", why, at, report.done + 1, report.residual,
      report.iterations, advice, #curve.points)
  error(setmetatable({ code = report.code, step = report.done + 1, residual = report.residual,
    iterations = report.iterations, message = message, path = curve, points = curve.points },
    Failure), 0)
end

return M
