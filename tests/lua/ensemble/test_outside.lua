-- parameters that functions read from a table outside of what they are given; what members ran with
-- stays theirs when L and params change
local tap = require "tap"
local ok, raises = tap.ok, tap.raises

-- functions that read a table outside, which is the same for all members
do
  local outside = { k = 4, l = 1 }
  local function of(fields)
    fields.Q, fields.params = dm.R(2), outside
    return dm.system(fields):solver({ rule = "midpoint", h = 0.1 })
  end
  local function members(solver)
    return solver:ensemble { members = 2, q = { { 0, -2 }, { 0, -2 } }, v = { { 0, 0 }, { 0, 0 } }, steps = 1, vary = { l = { 1, 2 }, k = { 4, 5 } } }
  end
  local function why(what) return "members would not differ by parameter 'k': " .. what .. " elsewhere, from a table" end
  local unread = "no function of the system reads it: 'k' is read"
  raises(why "'L' reads it", members, of { L = function(q, v) return outside.l * v:dot(v) / 2 - outside.k * q[2] end })
  raises(why(unread), members, of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - outside.k * q[2] end })
  raises(why "'force' reads it", members, of { L = function(_, v, _, p) return p.l * v:dot(v) / 2 end, force = function(q) return -outside.k * q end })
  raises(why "'constraint' reads it", members, of { L = function(_, v, _, p) return p.l * v:dot(v) / 2 end, constraint = function(q) return q:dot(q) - outside.k end })
  local function pull(q) return outside.k * q[2] end
  raises(why(unread), members, of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - pull(q) end })
  -- though it is read where it is given, too
  raises(why "'force' reads it", members, of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - p.k * q[2] end, force = function(q) return -outside.k * q end })
  local library = { springs = { own = outside } }
  raises(why "'force' reads it", members, of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - p.k * q[2] end, force = function(q) return -library.springs.own.k * q end })
  raises(why "'constraint' reads it", members, of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - p.k * q[2] end, constraint = function(q, _) return q:dot(q) - outside.k end })
  raises(why "'force' reads it", members, of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - p.k * q[2] end,
    control = function(q) return { q[1] } end, force = function(q, _, _, u) return -outside.k * q * u[1] end })
  -- another table may have such a name, and what is given may go to a helper
  local other = { k = 9 }
  local function weight(q, p) return p.k * q[2] end
  local e = members(of { L = function(q, v, _, p) return p.l * v:dot(v) / 2 - weight(q, p) end, force = function(q) return -other.k * q end })
  ok(e.p[1][2] ~= e.p[2][2], "members differ by what is given, beside another table", e.p[2][2] - e.p[1][2])
  -- discrete Lagrangians
  local function pairs_of(force, vary)
    local D = dm.discrete_lagrangian { Q = dm.R(1), h = 0.1, params = outside, force = force,
      Ld = function(q0, q1, h, p) return (q1[1] - q0[1]) ^ 2 / (2 * h) - h * p.k * (q0[1] ^ 2 + q1[1] ^ 2) / 4 end }
    return dm.solver({ D }):ensemble { members = 2, q = { { 1 }, { 1 } }, p = { { 0 }, { 0 } }, steps = 1, vary = vary }
  end
  local k = { k = { 4, 8 } }
  local d = pairs_of(nil, k)
  ok(math.abs(d.q[1][1] - 0.98) < 1e-15 and math.abs(d.q[2][1] - 0.96) < 1e-15, "a discrete Lagrangian gets them: q1 = 1 - h^2 k/2")
  raises(why "'force' reads it", pairs_of, function(q0) return { { -outside.k * q0[1] }, { 0 } } end, k)
  raises("no function of the system reads it", pairs_of, nil, { l = { 1, 2 } })
end
-- what is watched does not see the values of members
do
  local outside = { k = 1 }
  local own = dm.system { Q = dm.R(1), params = outside,
    L = function(q, v, _, p) return (v[1] ^ 2 - p.k * q[1] ^ 2) / 2 end }
  local function members(watch)
    return own:solver({ rule = "verlet", h = 0.1 }):ensemble { members = 2, q = { { 1 }, { 1 } }, v = { { 0 }, { 0 } }, steps = 3, vary = { k = { 1, 9 } }, watch = watch }
  end
  local why = "field 'watch': E reads params.k, which is that of the system, not that of a member"
  raises(why, members, { E = function(q, v) return (v[1] ^ 2 + own.params.k * q[1] ^ 2) / 2 end })
  raises(why, members, { E = function(q, v) return (v[1] ^ 2 + outside.k * q[1] ^ 2) / 2 end })
  local function spring(q) return outside.k * q[1] ^ 2 end
  raises(why, members, { E = function(q, v) return (v[1] ^ 2 + spring(q)) / 2 end })
  local other = { k = 2 }
  local e = members { "energy", E = function(q, v) return (v[1] ^ 2 + other.k * q[1] ^ 2) / 2 end }
  ok(e:path(2):column "energy"[1] == 4.5 and e:path(2):column "E"[1] == 1, "another table may be read")
end
-- paths of members are those of the system as it was, as paths of runs are
do
  local k = 1
  local own = dm.system { Q = dm.R(1), params = { m = 1, c = 1 },
    L = function(q, v, _, p) return (p.m * v[1] ^ 2 - k * p.c * q[1] ^ 2) / 2 end }
  local solver = own:solver { rule = "verlet", h = 0.1 }
  local function members(vary)
    return solver:ensemble { members = 2, q = { { 1 }, { 2 } }, v = { { 1 }, { 1 } }, steps = 5, every = 1, vary = vary }
  end
  local e, varied = members(), members { m = { 1, 3 } }
  local path = solver:run { q = { 2 }, v = { 1 }, steps = 5 }
  own.params.m, own.params.c = 7, 5
  ok(varied:path(2):energy()[1] == 3.5, "energies after other params have changed", varied:path(2):energy()[1])
  k = 5
  ok(e:path(2):energy()[6] == path:energy()[6] and path:energy()[1] == 2.5, "and after L has", e:path(2):energy()[1])
end
tap.done()
