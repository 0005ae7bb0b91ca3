-- Steps of curve(rk4) near the speed of light, where Newton's method leaves the domain of L from
-- its guess and the equations have several roots: the one that is taken is that of a small step. q1
-- is from a continuation in h in long double (tests/bench/c/by_hand/curve_steps.c).
local tap = require "tap"
local dm = require "dm"
local near = tap.near

-- L = -sqrt(1 - v^2) - a q - b q^2
local function system(a, b)
  return dm.system { Q = dm.R(1), L = function(q, v)
    return -(1 - v[1] ^ 2) ^ 0.5 - a * q[1] - b * q[1] ^ 2
  end }
end
local fall, plunge, well, steep = system(-10, 0), system(-100, 0), system(0, 10), system(0, 40)

-- L, q, v, h, q1
local steps = {
  -- other roots are nearer to the line through the last two
  { steep, 0.5683, 0.3135, 0.1959, 0.459169734196602 },
  { steep, -0.5038, -0.7781, 0.4053, -0.756709295889229 },
  { well, 0.6167, 0.00573, 0.4193, 0.403355747671232 },
  { steep, 0.5536, -0.506, 0.2711, 0.282775552391498 },
  { well, 0.5848, 0.1936, 0.3344, 0.425620405323952 },
  { steep, -0.3703, -0.6559, 0.3909, -0.610389970464102 },
  -- a long part would go over to another root
  { plunge, -0.9697, -0.6519, 0.4516, -1.259390157952584 },
  { plunge, 0.8519, -0.6527, 0.3877, 0.604393229527506 },
  { plunge, 0.9395, -0.657, 0.3989, 0.684602389124526 },
  { steep, -0.5793, -0.6641, 0.4067, -0.834472340572917 },
  -- along the edge of the domain, by short parts alone
  { fall, 0.4169, 0.488, 0.1231, 0.528884287205955 },
  { well, -0.9864, -0.6365, 0.3884, -1.210606417326744 },
  { steep, 0.7698, 0.6413, 0.1486, 0.856588168291858 },
  { plunge, 0.3258, 0.4618, 0.09792, 0.380715639174888 },
  { steep, -0.8886, 0.4831, 0.3495, -0.539177725734769 },
  { plunge, 0.2316, -0.6551, 0.2555, 0.071212405834338 },
  { well, 0.3719, -0.5395, 0.4652, 0.163848828274452 },
  { steep, -0.7387, -0.6464, 0.06502, -0.770089491617970 },
  { plunge, -0.7739, 0.4616, 0.1737, -0.670524419755107 },
}
for _, s in ipairs(steps) do
  local path = s[1]:solver { rule = "curve(rk4)", h = s[4] }
    :run { q = { s[2] }, v = { s[3] }, steps = 1 }
  near(path.q[2][1], s[5], 1e-10, ("q = %g, v = %g, h = %g"):format(s[2], s[3], s[4]))
end

tap.done()
