--- The order of a discrete connection, measured (Leok 4.6.2): the largest k with
--   sup |log(A_ref(q, exp(h v)) A_d(q, exp(h v))^-1)| <= c h^(k + 1)
-- over unit velocities v. Pairs of a rule, which has no first point, are laid about random points
-- q: then the leading term of the error is not mixed with the next one. The distance is that to the
-- identity [E6], the reference the one that the connection approximates [E7].
local blame = require "dm.base.blame"
local bundles = require "dm.connection.bundle"
local connections = require "dm.connection"
local core = require "dm.core"
local kits = require "dm.group.kit"
local options = require "dm.base.options"

local M = {}

local WHERE = "A:order"
-- larger ones are taken where of these less than three errors stand above round-off
local DISTANCES = { { 0.4, 0.2, 0.1 }, { 0.8, 0.4, 0.2 }, { 1.6, 0.8, 0.4 } }
local SAMPLES, TRIES, ROUND = 16, 60, 1e-12

-- a point of the base and a unit velocity there
local function sample(B, i, at)
  local stream = core.random(4620)
  local v = kits.normals(stream, 2 * i + 1, B.n, 1)
  return at or kits.normals(stream, 2 * i, B.n, 0.5), v * (1 / v:norm())
end

-- the largest error at each of these distances; samples where either has no value are passed over
local function errors_of(B, distances, forms, references, at, centred)
  local worst, tested, cause = {}, 0, nil
  for i = 1, TRIES do
    local x, v = sample(B, i, at)
    local found, fine, why = {}, true, nil
    for k, h in ipairs(distances) do
      fine, why = blame.try(function()
        local from = centred and x - (0.5 * h) * v or x
        local to = from + h * v
        found[k] = bundles.distance(B, references[k](from, to), forms[k](from, to))
      end)
      if not fine then break end
    end
    cause = cause or why
    if fine then
      tested = tested + 1
      for k, off in ipairs(found) do worst[k] = math.max(worst[k] or 0, off) end
    end
    if tested == SAMPLES then break end
  end
  if tested == 0 then
    options.fail(WHERE, "there is no value at %d random pairs of points: %s; give a point of the "
      .. "base, at =", TRIES, tostring(cause))
  end
  return worst
end

-- how many errors are above round-off, and the slope of log(error) against log(h) of these
local function slope(distances, errors)
  local n, sx, sy, sxx, sxy = 0, 0, 0, 0, 0
  for k, error in ipairs(errors) do
    if error >= ROUND then
      local x, y = math.log(distances[k]), math.log(error)
      n, sx, sy, sxx, sxy = n + 1, sx + x, sy + y, sxx + x * x, sxy + x * y
    end
  end
  return n, n >= 2 and (n * sxy - sx * sy) / (n * sxx - sx * sx)
end

-- the local forms at every distance: a connection made of a rule takes the step h as well
local function at_distances(A, distances)
  local out = {}
  for k, h in ipairs(distances) do
    out[k] = A.own.with_step and A.own.with_step(h) or A.own.local_form
  end
  return out
end

local function reference_of(A, given)
  local reference = given.reference
  if reference == nil and A.own.reference then reference = A.own.reference() end
  if reference == nil then
    options.fail(WHERE, "option 'reference' is missing: the connection that this one approximates")
  end
  options.demand(connections.is_connection(reference), given, "reference", WHERE, "a dm.connection")
  local B, C = A.own.bundle, reference.own.bundle
  if B.n ~= C.n or tostring(B.group) ~= tostring(C.group) then
    options.fail(WHERE, "the reference is a connection of %s over %s, this one of %s over %s",
      tostring(C.group), tostring(reference.base), tostring(B.group), tostring(A.base))
  end
  return reference
end

connections.method("order", function(A, given)
  given = options.check(given or {}, { "reference", "at" }, WHERE, "{ reference =, at = }")
  local B = A.own.bundle
  local at = given.at ~= nil and bundles.base_point(B, given.at, WHERE .. ": at") or nil
  local reference, count, k, errors = reference_of(A, given), nil, nil, nil
  for step, distances in ipairs(DISTANCES) do
    errors = errors_of(B, distances, at_distances(A, distances),
      at_distances(reference, distances), at, A.own.with_step ~= nil)
    count, k = slope(distances, errors)
    if count == #distances or k and step > 1 then break end
  end
  if k then return k - 1 end
  options.fail(WHERE, "there is no order to be seen: the errors at h = 1.6, 0.8, 0.4 are %.2g, "
    .. "%.2g, %.2g, round-off below 1e-12", table.unpack(errors))
end, [[
A:order([{reference=, at=}]) -> number
The order, measured: the slope, less 1, of sup |log(A_ref A_d^-1)| over pairs at the distances h =
0.4, 0.2, 0.1 in directions at random, from (of a rule about) points at random or the one `at`;
errors below 1e-12 are left out, and larger distances, up to 1.6, are tried then. reference: the
connection that is approximated; left out, gauss(8) for those of a rule, which take h as their step
too, and by = "exp" for those of a continuous form.]])

return M
