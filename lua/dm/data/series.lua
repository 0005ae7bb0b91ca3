--- Many files of one kind with their times: the .vtk.series that ParaView opens as one.
local option = require "dm.base.options"
local text_file = require "dm.base.text_file"

local M = {}

--- Writes prefix_00001.vtk, ... as write(i, file) does for i = 1 .. count, then prefix.vtk.series;
-- gives the list of all files. time(i): of row i. A .vtk at the end of the prefix is left out.
function M.vtk(prefix, count, time, where, write)
  if type(prefix) ~= "string" then
    option.fail(where, "the beginning of file names is needed (got %s)", option.got(prefix))
  end
  prefix = prefix:gsub("%.vtk$", "")
  local list, entries, base = {}, {}, prefix:match "[^/]*$"
  for i = 1, count do
    local number = ("_%05d.vtk"):format(i)
    list[i] = write(i, prefix .. number)
    entries[i] = ('    { "name": "%s%s", "time": %.17g }'):format(base, number, time(i))
  end
  local text = ('{\n  "file-series-version": "1.0",\n  "files": [\n%s\n  ]\n}\n')
    :format(table.concat(entries, ",\n"))
  list[count + 1] = text_file.write(prefix .. ".vtk.series", text, where)
  return list
end

return M
