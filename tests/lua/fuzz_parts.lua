--[[ What tests/lua/fuzz.lua is made of beside numbers: an object of every class, options by the names that docs give them, functions that
go wrong in every way, and files that are changed byte by byte. ]]
local dm = require "dm"
local core = require "dm.core"
local M = {}

---- options ----

--- Names in the signature of a doc that stand before a '='.
function M.keys(doc)
  local keys, signature = {}, doc and doc:match "^(.-)%->" or doc or ""
  for key in signature:gmatch "([%a_][%w_]*)%s*=" do keys[#keys + 1] = key end
  return keys
end

---- functions of a user that go wrong ----

local function deep(n) return n == 0 and 0 or 1 + deep(n - 1) end

--- A function that returns what `right` does for some calls, then something else: too many values, none, other types, NaN, errors of
-- every type, a yield, a run inside itself, a stack that overflows.
function M.callback(random, right, value)
  local from, kind = random(0, 6), random(1, 16)
  local calls, inside = 0, false
  return function(...)
    calls = calls + 1
    if calls <= from then return right(...) end
    if kind == 1 then return end
    if kind == 2 then return nil, nil end
    if kind == 3 then return right(...), right(...), 3 end
    if kind == 4 then return 0 / 0 end
    if kind == 5 then return -1 / 0 end
    if kind == 6 then return "text" end
    if kind == 7 then return { {}, { 1, "x" } } end
    if kind == 8 then error "raised on purpose" end
    if kind == 9 then error({}) end
    if kind == 10 then error(nil) end
    if kind == 11 then return coroutine.yield(1) end
    if kind == 12 then return deep(1e7) end
    if kind == 13 then return value(1) end
    if kind == 14 then return function() end end
    if kind == 15 then return (...) end
    if inside then return right(...) end
    inside = true
    local fine, result = pcall(function(...)
      dm.system({ Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end })
        :solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1 }, v = { 0 }, steps = 3 }
      return right(...)
    end, ...)
    inside = false
    if not fine then error(result, 0) end
    return result
  end
end

---- an object of every class ----

local function oscillator(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end

local saddle, tied, rolls, damped, fast, kepler, shift, rho, grid, torus, f -- made once, below

-- one object a line; a line that raises leaves it out
local makers = {
  function() tied = dm.system { Q = dm.R(3), L = function(q, v) return v:dot(v) / 2 - q[3] end, constraint = function(q) return q:dot(q) - 1 end } return tied end,
  function() rolls = dm.system { Q = dm.R(3), L = function(_, v) return v:dot(v) / 2 end, rolling = function(q, v) return v[3] - q[2] * v[1] end } return rolls end,
  function()
    damped = dm.system { Q = dm.R(1), L = oscillator, force = function(_, v, _, u) return { u[1] - v[1] } end, control = function(q) return { -q[1] } end }
    return damped
  end,
  function()
    saddle = dm.system { Q = dm.R(2), L = function(q, v) return v[1] ^ 2 / 2 - q[2] end, constraint = function(q) return q[2] - q[1] ^ 2 / 2 end }
    return saddle
  end,
  function() kepler = dm.system { Q = dm.R(2), L = function(q, v) return v:dot(v) / 2 + 1 / q:norm() end } return kepler end,
  function() fast = dm.system { Q = dm.R(1), L = function(q, v) return -(1 - v[1] ^ 2) ^ 0.5 - q[1] ^ 2 end } return fast end,
  function() return dm.discrete_lagrangian(kepler, { rule = "midpoint", h = 0.1 }) end,
  function() return dm.discrete_lagrangian(kepler, { rule = "gauss(2)", h = 0.1 }) end,
  function() return saddle:solver { rule = "rattle", h = 0.1 } end,
  function() return saddle:solver { rule = "gauss(2)", h = 0.1 } end,
  function() return tied:solver { rule = "rattle", h = 0.05 } end,
  function() return tied:solver { rule = "lobatto(3)", h = 0.05 } end,
  function() return rolls:solver { rule = "gauss(2)", h = 0.05 } end,
  function() return damped:solver { rule = "midpoint", h = 0.05 } end,
  function() return fast:solver { rule = "verlet", h = 0.1 } end,
  function() return dm.galerkin { degree = 2, nodes = { 0, 0.5, 1 }, weights = { 1 / 6, 2 / 3, 1 / 6 } } end,
  function() return dm.curve "rk4" end,
  function() return dm.bundle { system = kepler, h = 0.1, segments = "rk4" } end,
  function()
    return kepler:solver({ rule = "verlet", h = 0.05 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 40,
      events = { apsis = function(q, v) return q:dot(v) end } }
  end,
  function()
    return kepler:solver({ rule = "verlet", h = 0.05 }):section { q = { 1, 0 }, v = { 0, 1.1 }, g = function(q) return q[2] end, t = 30, x = "q1", y = "p1" }
  end,
  function() return dm.chart { kepler, q = { 1, 0 }, v = { 0, 1 }, t = 1, rules = { "verlet" }, h = { 0.1, 0.05 }, repeats = 1 } end,
  function() return dm.stability { system = kepler, rule = "midpoint", q = { 1, 0 }, v = { 0, 1 }, steps = 50, h = { 0.1, 1, 3 } } end,
  function() return dm.scene { kepler, q = { 1, 0 }, v = { 0, 1 }, watch = { "q1" }, tolerance = 1e-2, until_t = 1 } end,
  function() return dm.scaling { system = kepler, start = function() return { q = { 1, 0 }, v = { 0, 1 } } end, members = { 1, 2 }, rules = { "verlet" }, h = 0.1, steps = 3 } end,
  function()
    shift = dm.action { group = dm.R(1), on = dm.R(2), map = function(g, z) return { z[1] + g[1], z[2] } end }
    return shift
  end,
  function() rho = dm.moving_frame { action = shift, cross_section = function(z) return z[1] end } return rho end,
  function()
    local points = dm.moving_frame { action = shift, points = 2, cross_section = function(a) return a[1] end }
    return dm.invariant_problem { frame = points, points = 2, L = function(I) return (I[2][1] ^ 2 + I[2][2] ^ 2) / 2 end }
  end,
  function() return dm.random(3) end,
  function() return kepler:solver({ rule = "verlet", h = 0.1 }):run({ q = { 1, 0 }, v = { 0, 1 }, steps = 3 }).q end,
  function() return dm.root { equations = function(y, x) return y[1] ^ 3 - x[1] end, start = { 1 }, unknowns = 1 } end,
  function() return dm.hyperdual and dm.hyperdual(1, 1, 0, 0) end,
  function() grid = dm.mesh { grid = 3 } return grid end,
  function() torus = dm.mesh { square_torus = 4 } return torus end,
  function() f = grid:form(0, function(x, y) return x * y end) return f end,
  function() return f:d() end,
  function() return grid:form(1, function() return { 1, 2 } end) end,
  function() return f:star() end,
  function() return grid:chain(1, { { 2, { 1, 2 } } }) end,
  function() return grid:vector_field(function(x, y) return { x, y } end) end,
  function() return f:grad() end,
  function() return torus:form(2, torus:volume(2)) end,
  function() return core.matching(grid) end,
  function()
    local same = {}
    for i = 1, grid:count(0) do same[i] = i end
    return dm.simplicial_map(grid, grid, same)
  end,
  function() return dm.mesh({ grid = 1 }):cone {} end,
  function() return grid:d(0) end,
  function() return grid:incidence(1) end,
  function() return grid:laplacian(0) end,
  function() return grid:laplacian(0):factor() end,
  function() return dm.mesh { icosphere = 0 } end,
  function() return dm.mesh { named = "rp2" } end,
}

--- Calls add(object) with what can be made; what fails to be made is left out.
function M.objects(add)
  for _, make in ipairs(makers) do
    local fine, object = pcall(make)
    if fine and object ~= nil then add(object) end
  end
end

---- files ----

local function read(name)
  local file <close> = assert(io.open(name, "rb"))
  return file:read "a"
end

local function write(name, text)
  local file <close> = assert(io.open(name, "wb"))
  file:write(text)
end

-- text with some bytes changed, left out, put in or cut off
local function spoilt(random, text)
  for _ = 1, random(1, 4) do
    local at, kind = random(1, math.max(1, #text)), random(1, 6)
    if kind == 1 then text = text:sub(1, at - 1) .. string.char(random(0, 255)) .. text:sub(at + 1) end
    if kind == 2 then text = text:sub(1, at - 1) .. text:sub(at + random(1, 40)) end
    if kind == 3 then text = text:sub(1, at) .. text:sub(random(1, #text), at) .. text:sub(at + 1) end
    if kind == 4 then text = text:sub(1, at) end
    if kind == 5 then text = text:gsub("%d+", function(d) return random(20) == 1 and "99999999999999999999" or d end) end
    if kind == 6 then text = text:gsub("\n", random(3) == 1 and "\r\n" or "\n\n", 1) end
  end
  return text
end

-- the checksum of a checkpoint made right again is not ours to make: most changes end there, those of csv and npy do not
local READERS = { csv = dm.load, npy = dm.load, checkpoint = dm.resume }

--- Files of every kind that is read, in the current folder, and a function that spoils one of them and reads it.
function M.files(random)
  local system = dm.system { Q = dm.R(2), L = oscillator }
  local path = system:solver({ rule = "gauss(2)", h = 0.1 }):run { q = { 1, 0 }, v = { 0, 1 }, steps = 20 }
  path:csv "whole.csv"
  path:npy "whole.npy"
  path:checkpoint "whole.checkpoint"
  local kinds, whole = {}, {}
  for kind in pairs(READERS) do
    kinds[#kinds + 1] = kind
    whole[kind] = read("whole." .. kind)
  end
  table.sort(kinds)
  return function()
    local kind = kinds[random(#kinds)]
    local name = "spoilt." .. kind
    write(name, spoilt(random, whole[kind]))
    if kind ~= "checkpoint" then return READERS[kind](name) end
    local resumed = READERS[kind](name, system)
    return resumed:run { steps = 2 }
  end
end

return M
