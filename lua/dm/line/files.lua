--- Runs on lines into files: NumPy records, VTK polylines with a series for their times.
local blame = require "dm.base.blame"
local core = require "dm.core"
local npy = require "dm.data.npy"
local series = require "dm.data.series"
local text_file = require "dm.base.text_file"

local M = {}

---- what a run has ----

-- { name, matrix } of the values at nodes: u and p of n values each, or the components of boxes
local function matrices_of(run)
  local out = {}
  if run.boxes then
    for _, name in ipairs(run.boxes.names) do out[#out + 1] = { name, run[name] } end
    return out
  end
  out[1], out[2] = { "u", run.u }, { "p", run.p }
  if run.x then out[3] = { "x", run.x } end
  return out
end

---- npy ----

local function write_npy(run, file, where)
  local matrices, fields = matrices_of(run), { { "t", 0 } }
  if not run.boxes then fields[2] = { "energy", 0 } end
  for _, entry in ipairs(matrices) do fields[#fields + 1] = { entry[1], #entry[2][1] } end
  npy.stream(file, fields, where, function(write)
    for i = 1, #run do
      local row = { t = run.t[i], energy = not run.boxes and run.energy[i] or nil }
      for _, entry in ipairs(matrices) do row[entry[1]] = entry[2][i] end
      write(row)
    end
  end)
  return file
end

---- vtk ----

-- places of the nodes at row i; a ring is cut open
local function places_of(run, i) return run.x and run.x[i] or run.nodes end

local function vtk_lines(run, matrices, i)
  local x = places_of(run, i)
  local lines = { "# vtk DataFile Version 3.0", ("t = %.17g"):format(run.t[i]), "ASCII",
    "DATASET POLYDATA", ("POINTS %d double"):format(#x) }
  for k = 1, #x do lines[#lines + 1] = ("%.17g 0 0"):format(x[k]) end
  local ids = {}
  for k = 1, #x do ids[k] = k - 1 end
  lines[#lines + 1] = ("LINES 1 %d"):format(#x + 1)
  lines[#lines + 1] = #x .. " " .. table.concat(ids, " ")
  lines[#lines + 1] = "POINT_DATA " .. #x
  for _, entry in ipairs(matrices) do
    local row = entry[2][i]
    local each = #row // #x
    for v = 1, each do
      lines[#lines + 1] = ("SCALARS %s%s double 1"):format(entry[1], each > 1 and v or "")
      lines[#lines + 1] = "LOOKUP_TABLE default"
      for k = 0, #x - 1 do lines[#lines + 1] = ("%.17g"):format(row[k * each + v]) end
    end
  end
  lines[#lines + 1] = ""
  return table.concat(lines, "\n")
end

local function write_vtk(run, prefix, where)
  local matrices = matrices_of(run)
  return series.vtk(prefix, #run, function(i) return run.t[i] end, where, function(i, file)
    return text_file.write(file, vtk_lines(run, matrices, i), where)
  end)
end

--- Gives a class of runs these methods.
function M.give(class)
  core.method(class, "npy", blame.caller(function(run, file)
    return write_npy(run, file, "run:npy")
  end), [[
run:npy(file) -> file name
The rows as a NumPy array with fields t, energy, u, p (of boxes: t and the components): u of a row
is an array of all nodes; dm.load reads it.]])

  core.method(class, "vtk", blame.caller(function(run, prefix)
    return write_vtk(run, prefix, "run:vtk")
  end), [[
run:vtk(file) -> {file, ...}
A file file_00001.vtk, ... for every row, the nodes as a line with their values, and as the last one
file.vtk.series, which gives ParaView their times.]])
end

return M
