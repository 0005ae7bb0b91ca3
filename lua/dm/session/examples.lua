--- The examples that come with dmlua: their names, what each asks, and where its file is.
local M = {}

--- Files of examples/, without .lua.
M.names = { "kepler", "figure_for_paper", "outer_solar_system", "satellite", "reduced_satellite",
  "double_spherical_pendulum", "reduced_pendulum", "families",
  "falling_cat", "foucault", "three_rotors", "locked_formation", "mesh_curvature",
  "rigid_body_phase", "bead", "rods", "boosts",
  "spherical_pendulum", "slack_rope", "own_forces", "taylor_segments", "damped_double_pendulum",
  "pendulum_chain", "chain",
  "carousel", "charged_particle", "runge_lenz", "sliding_plate",
  "elastica", "space_elastica", "schwarzian", "rolling_disk", "chaplygin_sleigh",
  "contact_oscillator", "cart", "guiding_centre",
  "free_body", "heavy_top", "hante_top", "gravity_gradient", "two_bodies", "underwater",
  "link_chain", "turntable", "chaplygin_sphere", "suslov", "tilted_disk",
  "henon_heiles", "escape", "stiff_spring", "vibrating_spring", "energy_steps", "own_space",
  "resonance_tongues", "bounded_but_wrong",
  "least_model", "game_loop", "exact_oscillator", "variational_runge_kutta",
  "porous_hole", "cavity", "torus_fields", "heat_sphere", "potential",
  "rossby_haurwitz", "wave_map", "own_steps",
  "bending_bar", "argon", "star_cluster",
  "rough_rod", "two_scales", "tunnel", "soliton", "kinks", "kdv",
  "free_knots" }

local function text_of(file)
  local handle = io.open(file)
  if not handle then return nil end
  local text = handle:read "a"
  handle:close()
  return text
end

-- "a/b/../c" as "a/c"
local function shortened(path)
  local before
  repeat
    before = path
    path = path:gsub("/([^/]+)/%.%./", function(folder_of)
      return folder_of ~= ".." and "/" or nil
    end, 1)
  until path == before
  return path
end

local folder  -- false: they did not come along

-- beside lua/: in the tree, and under share/dmlua, where share/lua/5.4 points to for a stock Lua
local function find_folder()
  local root = debug.getinfo(1, "S").source:match "^@(.*)/dm/session/[^/]+$"
  for _, place in ipairs(root and { "/../examples/", "/../../dmlua/examples/" } or {}) do
    for _, path in ipairs { shortened(root .. place), root .. place } do
      if text_of(path .. M.names[1] .. ".lua") then return path end
    end
  end
  return false
end

--- The file of an example, or nothing where the examples did not come along.
function M.file(name)
  if folder == nil then folder = find_folder() end
  return folder and folder .. name .. ".lua" or nil
end

--- The text of an example, or nothing.
function M.text(name)
  local file = M.file(name)
  return file and text_of(file) or nil
end

--- The comment at the head of a text, in one line.
function M.head(text)
  local lines = {}
  for line in text:gmatch "[^\n]+" do
    local comment = line:match "^%-%-%s?(.*)$"
    if not comment then break end
    lines[#lines + 1] = comment:match "^%s*(.-)%s*$"
  end
  return table.concat(lines, " ")
end

--- What an example asks: the clause before the first question mark of its head, or its first
-- sentence.
function M.title(head)
  local question, sentence = head:match "^.-%?", head:match "^.-%.%f[%s]"
  if not question or #question > 300 then return sentence or head end
  local clause = question:match "^.*[.:] (.-)$" or question
  return clause:sub(1, 1):upper() .. clause:sub(2)
end

return M
