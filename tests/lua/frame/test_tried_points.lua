-- frames are tried when they are made: none is made of which nothing is known, and what section and branch return is looked at
local tap = require "tap"
local dm = require "dm"
local ok, near, raises = tap.ok, tap.near, tap.raises

local shift = dm.action { group = dm.R(1), on = dm.R(2), map = function(g, z) return { z[1] + g[1], z[2] } end }
local function frame(section, solution, branch)
  return dm.moving_frame { action = shift, cross_section = section, solution = solution, branch = branch }
end
local function first(z) return z[1] end
raises("no point tried was finite", frame, first, function() return { 0 / 0 } end)
raises("no point tried was finite", frame, first, function() return { 1 / 0 } end)
raises("no point tried was finite", frame, first, function(z) return { -z[1] + 0 * (z[2] - 1000) ^ 0.5 } end)
raises("domain(z) > 0", frame, first, function(z) return { -z[1] + 0 * (z[2] - 1000) ^ 0.5 } end)
raises("there was none at", frame, function(z) return z[1] + (z[2] - 1000) ^ 0.5 end)
-- of a section that its trace does not see, also where the trace alone has no root
raises("not what its trace says", frame, function(z) return z[1] + (type(z[1]) == "number" and 0.1 or 0) end)
raises("not what its trace says", frame, function(z) return type(z[1]) == "number" and z[1] or z[1] ^ 2 + 1 end)
-- points where the domain is rare are looked for
local rare = dm.action { group = dm.R(1), on = dm.R(2), domain = function(z) return z[2] - 1.5 end,
  map = function(g, z) return { z[1] + g[1], z[2] } end }
local rho = dm.moving_frame { action = rare, cross_section = function(z) return z[1] + (z[2] - 1.5) ^ 0.5 end }
near(rho({ 3, 5.5 })[1], -5, 1e-12, "a frame whose domain is rare among the points tried")

raises("must return", frame, function(z) return z[1], 5 end)
raises("must return", frame, function(z) return z[1], nil end)
raises("must return", frame, function(z) return { z[1] }, 5 end)
raises("must return", frame, first, nil, function() return { 1 }, 5 end)
raises("must return", frame, first, nil, function() return 1, nil end)
raises("must return", frame, first, nil, function() return 1, "x" end)
ok(frame(first, nil, function() return 1, 2 end), "several numbers are several conditions")

-- a steep section: the root where it is found, else an error that says where
local steep, found = frame(function(z) return dm.tanh(50 * z[1]) end), 0
for i = 1, 50 do
  local x = -3 + 6 * (i - 0.5) / 50
  local fine, g = pcall(steep, { x, 0.3 })
  if fine then
    found = found + 1
    if math.abs(g[1] + x) > 1e-14 then ok(false, "a root that is found is one", g[1] + x) end
  elseif not tostring(g):find "no moving frame near" then
    ok(false, "it says that there is none near", g)
  end
end
ok(found >= 35, "a section of slope 50 from most points", found)

-- orbits that are no circles and cut a section at two places far apart: e^2g x^2 + e^-2g z^2 = 4
-- where |x z| < 2
local weights = dm.action { group = dm.R(1), on = dm.R(3), domain = function(z) return z[1] end,
  map = function(g, z)
    local e = dm.exp(g[1])
    return { e * z[1], e ^ 2 * z[2], z[3] / e }
  end }
local function weighted(section, branch)
  return dm.moving_frame { action = weights, cross_section = section, branch = branch }
end
local function far(z) return z[1] ^ 2 + z[3] ^ 2 - 4 end
raises("cuts the cross-section more than once", weighted, far)
raises("branch holds at both", weighted, far, function(z) return z[2] ^ 2 + 1 end)
near(weighted(far, function(z) return z[1] ^ 2 - z[3] ^ 2 end) { 2 * math.exp(3), 1, 0 }[1], -3,
  1e-13, "the root on the branch")

-- a stop passes through everything that is tried, also in a function of the user that spins
local rest = frame(first)
local function stopped(name, f, ...)
  debug.sethook(function() error("interrupted!", 0) end, "", 1000000)
  local fine, why = pcall(f, ...)
  debug.sethook()
  ok(not fine and tostring(why):find "interrupted!", name .. " is stopped by Ctrl-C", why)
end
local function spin() while true do end end
stopped("action:invariant", shift.invariant, shift, spin)
stopped("rho:check", rest.check, rest, { samples = 2 ^ 40 // 1 | 0 })
stopped("dm.moving_frame", dm.moving_frame, { action = shift, cross_section = spin })
tap.done()
