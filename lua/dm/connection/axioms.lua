--- The axioms of a discrete connection A_d : Q x Q -> G, tried at random points that are always the
-- same:
--   (i)   equivariance  A_d(h q0, h q1) = h A_d(q0, q1) h^-1
--   (ii)  splitting     A_d(q, h q) = h
--   (iii) composition   A_d(q0, h q1) = h A_d(q0, q1)
-- Leok prints (i) and (ii) alone; everything that is made of a connection needs (iii), which does
-- not follow [E2].
local blame = require "dm.base.blame"
local bundles = require "dm.connection.bundle"
local core = require "dm.core"
local kits = require "dm.group.kit"

local M = {}

local try = blame.try  -- Ctrl-C passes

local SAMPLES, TRIES = 12, 120
M.TRIES = TRIES

M.names = { "equivariance", "splitting", "composition" }

--- Element i of a stream, exp of normal numbers.
local function element(B, stream, i, size)
  return B.kit.exp(kits.normals(stream, i, B.d, size))
end

--- Sample i: two near points and an element of the group.
function M.sample(B, i)
  local stream = core.random(4400)
  local x0 = kits.normals(stream, 6 * i, B.n, 0.5)
  return { q0 = { x0, element(B, stream, 6 * i + 1, 0.5) },
    q1 = { x0 + kits.normals(stream, 6 * i + 2, B.n, 0.3), element(B, stream, 6 * i + 3, 0.5) },
    h = element(B, stream, 6 * i + 4, 0.4) }
end

local tests = {}

function tests.equivariance(B, A, s)
  return A(bundles.move(B, s.h, s.q0), bundles.move(B, s.h, s.q1)),
    bundles.conjugate(B, s.h, A(s.q0, s.q1))
end

function tests.splitting(B, A, s) return A(s.q0, bundles.move(B, s.h, s.q0)), s.h end

function tests.composition(B, A, s)
  return A(s.q0, bundles.move(B, s.h, s.q1)), B.kit.compose(s.h, A(s.q0, s.q1))
end

-- defects of one sample, or nothing and why where there is no value
local function defects_of(B, A, s)
  local out = {}
  for _, name in ipairs(M.names) do
    local fine, off = try(function() return B.kit.distance(tests[name](B, A, s)) end)
    if not fine then return nil, off end
    if not (off < math.huge) then return nil, "the value is not finite" end
    out[name] = off
  end
  return out
end

local Where = { __name = "dm.connection_sample" }

function Where.__tostring(w)
  local text = ("%s at q0 = %s, "):format(w.axiom, bundles.show(w.q0))
  if w.axiom ~= "splitting" then text = text .. ("q1 = %s, "):format(bundles.show(w.q1)) end
  return ("%sh = %s"):format(text, bundles.show(w.h))
end

local function where(B, axiom, s)
  return setmetatable({ axiom = axiom, q0 = B.give(s.q0), q1 = B.give(s.q1), h = s.h }, Where)
end

--- The largest defects of the three axioms, the worst, and where that is. Samples at which there is
-- no value are passed over; raises where there are no others.
function M.check(B, A)
  local worst, at, tested, cause = {}, {}, 0, nil
  for i = 1, TRIES do
    local s = M.sample(B, i)
    local found, why = defects_of(B, A, s)
    cause = cause or why
    if found then tested = tested + 1 end
    for name, off in pairs(found or {}) do
      if not (worst[name] and off <= worst[name]) then worst[name], at[name] = off, s end
    end
    if tested == SAMPLES then break end
  end
  if tested == 0 then
    error(("there is no value at %d random pairs of points, so that the axioms cannot be tried: %s")
      :format(TRIES, blame.bare(cause)), 0)
  end
  local out, most = {}, M.names[1]
  for _, name in ipairs(M.names) do
    out[name] = worst[name]
    if worst[name] > worst[most] then most = name end
  end
  out.worst, out.where = worst[most], where(B, most, at[most])
  function out.at(name) return where(B, name, at[name]) end
  return out
end

local TURNED = 4 -- samples that are taken round

-- coordinate k of x a turn on
local function turned(B, x, k)
  local out = {}
  for i = 1, B.n do out[i] = x[i] + (i == k and 2 * math.pi or 0) end
  return core.vector(out)
end

--- How far A(x0, x1) is from itself where an angle of both points is a whole turn on: they are the
-- same points. Gives the largest difference, and the coordinate, x0 and x1; 0 without angles.
function M.turns(B, local_form)
  local worst, at, tested = 0, nil, 0
  for i = 1, next(B.angles) and TRIES or 0 do
    local s = M.sample(B, i)
    local x0, x1 = s.q0[1], s.q1[1]
    local fine, here = try(local_form, x0, x1)
    tested = tested + (fine and 1 or 0)
    for k in pairs(fine and B.angles or {}) do
      local there, g = try(local_form, turned(B, x0, k), turned(B, x1, k))
      local off = there and bundles.distance(B, g, here) or math.huge
      if not (off <= worst) then worst, at = off, { k = k, x0 = x0, x1 = x1 } end
    end
    if tested == TURNED then break end
  end
  return worst, at
end

return M
