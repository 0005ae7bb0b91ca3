--- Poincare sections: where runs cross a surface g = 0, or each period of a driven system, as
-- points of a plot. solver:section{g =, q =, v =, t =}.
local blame = require "dm.base.blame"
local circle = require "dm.group.so2"
local class = require "dm.base.class"
local core = require "dm.core"
local kits = require "dm.group.kit"
local lists = require "dm.base.lists"
local option = require "dm.base.options"
local place = require "dm.group.place"
local starts = require "dm.base.start"

local M = {}

local Section = core.class({ __name = "dm.section" }, [[
dm.section: the crossings of a surface by one run or several, made by solver:section{g=, ...}
fields: orbits (each {x, y, t, path, failure}: vectors with a number for each crossing), count (of
all crossings), failures (how many runs ended early), xlabel, ylabel; #section orbits.]])

function Section.__len(section) return #section.orbits end
function Section.__tostring(section)
  local orbits, count, failed = #section.orbits, section.count, section.failures
  return ("section of %d orbit%s: %d crossing%s as (%s, %s)%s")
    :format(orbits, orbits == 1 and "" or "s", count, count == 1 and "" or "s",
    section.xlabel, section.ylabel, failed > 0 and ("; %d ended early"):format(failed) or "")
end

---- what is read off a crossing ----

local WHERE = "solver:section"
local fail = option.failing(WHERE)

-- the same on a group: entries of the element, and flat coordinates where they do not jump
local function columns_on_group(own)
  local read, names = { t = function(_, _, t) return t end }, { q = {}, p = {}, also = ", R31" }
  local angles = own.size == own.kit.coordinates and own.kit.angles or {}
  names.angles, names.entry = angles, function(g, i) return own.flat(g)[i] end
  for i = 1, own.jumps and 0 or own.size do
    names.q[i] = "q" .. i
    read[names.q[i]] = function(g)
      local x = own.flat(g)[i]
      return angles[i] and circle.principal(x) or x
    end
  end
  for i = 1, own.dimension do
    names.p[i] = "p" .. i
    read[names.p[i]] = function(_, mu) return mu[i] end
  end
  return setmetatable(read, { __index = function(_, name) return place.entry(own, name) end }),
    names
end

-- name -> function(q, p, t), and the name a coordinate or momentum prints as; which coordinates are
-- angles: paths do not wrap them, what is read off a crossing is
local function columns_of(system)
  if system.place then return columns_on_group(system.place) end
  local read, names = { t = function(_, _, t) return t end }, { q = {}, p = {} }
  local given, angles = system.coordinates or {}, kits.of(system.Q).angles
  names.angles = angles
  for i = 1, system.Q.dimension do
    local name = given[i] or "q" .. i
    names.q[i], names.p[i] = name, given[i] and "p_" .. name or "p" .. i
    for _, key in ipairs { name, "q" .. i } do
      read[key] = read[key] or function(q)
        return angles[i] and circle.principal(q[i]) or q[i]
      end
    end
    for _, key in ipairs { names.p[i], "p" .. i } do
      read[key] = read[key] or function(_, p) return p[i] end
    end
  end
  return read, names
end

local function known(names)
  local all = table.move(names.p, 1, #names.p, #names.q + 1, { table.unpack(names.q) })
  return table.concat(all, ", ") .. ", t" .. (names.also or "")
end

-- the function and the label of option x or y
local function axis(o, key, columns, names)
  local what = o[key]
  if type(what) == "function" then return core.one(what, key), o[key .. "label"] or key end
  if type(what) ~= "string" or not columns[what] then
    fail("'%s' must be one of %s, or a function of (q, p, t) (got %s)", key, known(names),
      type(what) == "string" and what or type(what))
  end
  return columns[what], o[key .. "label"] or what
end

-- which coordinate g names, if it does
local function coordinate(g, names)
  for i, name in ipairs(names.q) do
    if g == name or g == "q" .. i then return i end
  end
end

-- the plane of another coordinate and its momentum, where x and y are left out
local function with_axes(o, names)
  if o.x ~= nil or o.y ~= nil then return o end
  local cut, n = coordinate(o.g, names), #names.q
  if n > 1 and not cut then
    fail("'x' and 'y' say what is drawn: names (%s) or functions of (q, p, t)", known(names))
  end
  local i = cut == 1 and n > 1 and 2 or 1
  local out = lists.copy(o)
  out.x, out.y = names.q[i], names.p[i]
  return out
end

---- runs ----

local KNOWN = { "a", "direction", "every", "g", "p", "period", "project", "q", "starts", "steps",
  "t", "t0", "v", "x", "xlabel", "y", "ylabel" }

local function check(o)
  option.check(o, KNOWN, WHERE, "{ g =, q =, v =, t = }")
  option.one_of(o, "direction", WHERE, { "up", "down", "both" })
  option.positive(o, "period", WHERE, "a duration")
  for _, key in ipairs { "xlabel", "ylabel" } do option.text(o, key, WHERE) end
  if o.period and (o.g ~= nil or o.direction ~= nil) then
    fail "'period' stands in place of 'g' and 'direction'"
  end
  if o.starts ~= nil and (type(o.starts) ~= "table" or type(o.starts[1]) ~= "table") then
    fail("'starts' must be a list of starts { q =, v = } or { q =, p = } (got %s)", type(o.starts))
  end
  if o.starts and (o.q or o.v or o.p) then fail "give 'starts' or one start q and v, not both" end
end

-- g as a function of (q, v, t, p), and where one is given: is an event (q, p, t) on the surface? An
-- angle is 0 where its sine is and its cosine is positive, as often as it comes round.
local function surface(o, columns, names)
  if o.period then
    return function(_, _, t) return math.sin(2 * math.pi / o.period * (t - (o.t0 or 0))) end
  end
  if type(o.g) == "function" then return o.g end
  if o.g == "t" then fail "t passes 0 once: for a section each period T, period = T" end
  local f = type(o.g) == "string" and columns[o.g]
  if not f then
    fail("'g' must be a function of (q, v, t, p) that is 0 on the surface, or one of %s (got %s)",
      known(names), type(o.g) == "string" and o.g or type(o.g))
  end
  local i = coordinate(o.g, names)
  if i and names.angles and names.angles[i] then
    local entry = names.entry or function(q) return q[i] end
    return function(q) return math.sin(entry(q, i)) end,
      function(q) return math.cos(entry(q, i)) > 0 end
  end
  return function(q, _, t, p) return f(q, p, t) end
end

local ONLY_ENDS = 1000000000  -- steps between the rows that are kept

-- the path of one start, up to where it failed
local function run(solver, o, start, g)
  local direction = o.direction ~= "both" and (o.direction or "up") or nil
  start, solver = starts.lists({ q = start.q, v = start.v, p = start.p, a = start.a or o.a },
    solver)
  local fine, path = blame.try(solver.run, solver, { q = start.q, v = start.v, p = start.p, t = o.t,
    steps = o.steps, t0 = o.t0, project = o.project, every = o.every or ONLY_ENDS,
    events = { cut = { g = g, direction = direction } } })
  if fine then return path end
  local failed, so_far = blame.try(function() return path.path end)
  if type(path) == "string" or not failed or not so_far then error(path, 0) end
  return so_far, path
end

local function orbit(path, failure, fx, fy, on_surface)
  local x, y, t = {}, {}, {}
  for _, event in ipairs(path.events or {}) do
    if not on_surface or on_surface(event.q) then
      local k = #t + 1
      x[k], y[k], t[k] = fx(event.q, event.p, event.t), fy(event.q, event.p, event.t), event.t
    end
  end
  for _, list in ipairs { x, y } do
    for k, number in ipairs(list) do
      if type(number) ~= "number" then
        fail("%s of crossing %d is no number (got %s)", list == x and "x" or "y", k,
          kits.class_of(number))
      end
    end
  end
  return core.result { x = core.vector(x), y = core.vector(y), t = core.vector(t), path = path,
    failure = failure }
end

M.section = blame.caller(function(solver, o)
  check(o)
  local columns, names = columns_of(solver.system)
  local g, on_surface = surface(o, columns, names)
  o = with_axes(o, names)
  local fx, xlabel = axis(o, "x", columns, names)
  local fy, ylabel = axis(o, "y", columns, names)
  local section = { orbits = {}, count = 0, failures = 0, xlabel = xlabel, ylabel = ylabel }
  for i, start in ipairs(o.starts or { o }) do
    local path, failure = run(solver, o, start, g)
    if failure and not o.starts then error(failure, 0) end
    section.orbits[i] = orbit(path, failure, fx, fy, on_surface)
    section.count = section.count + #section.orbits[i].x
    section.failures = section.failures + (failure and 1 or 0)
  end
  return setmetatable(section, Section)
end)

core.method("dm.section", "series", blame.caller(function(section)
  local out = core.result {}
  for i, one in ipairs(section.orbits) do
    if #one.x > 0 then
      out[#out + 1] = { x = one.x, y = one.y, name = "orbit " .. i, style = "points",
        xlabel = section.xlabel, ylabel = section.ylabel }
    end
  end
  if #out == 0 then
    fail("no orbit crossed the surface in that direction; try a longer run, direction = \"both\" "
      .. "or another g")
  end
  return out
end), [[
section:series() -> list of { x =, y =, name = } for dm.plot and dm.figure
The crossings of each orbit that has some.]])

core.method("dm.section", "plot", blame.caller(function(section, options)
  local given = lists.copy(options or {})
  if given.legend == nil then given.legend = false end
  return require "dm.show.plot".plot(section:series(), given)
end), [[
section:plot{file=, title=, ...} -> file name or nothing
Draw the crossings, one colour an orbit; options as in dm.plot.]])

class.method("dm.solver", "section", M.section,
  "solver:section{g= | period=, q=, v= | p=, starts=, t= | steps=, t0=, direction=, x=, y=, "
  .. "xlabel=, ylabel=, every=, project=} -> dm.section\n" .. [[
The Poincare section of a run: where it crosses the surface g(q, v, t, p) = 0; g may be the name of
a coordinate, "q1", of an angle of dm.T(n) up to whole turns; period = T in its place: each period
of a driven system from t0 on (a stroboscope). direction: "up" (g grows; the default), "down" or
"both". starts = { {q =, v =}, {q =, p =}, ... }: several runs, one of which may fail. x, y: what is
read off a crossing, names of columns ("q2", "p2", "t", on groups "R31"; angles from -pi to pi) or
functions of (q, p, t); left out: another coordinate than g and its momentum. Crossings are found by
steps of fitting length, with the accuracy of the rule; two within one step are not seen.
section:plot() draws them. every = k keeps rows of the runs, orbits[i].path.]])

return M
