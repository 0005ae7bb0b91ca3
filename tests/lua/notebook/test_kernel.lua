-- the Jupyter kernel, where Python has ipykernel and nbconvert: it installs, and the notebooks run
local tap = require "tap"
require "dm"
local ok = tap.ok
local dmlua = os.getenv "DMLUA" or arg[-1]

local function answer_of(command)
  local pipe = io.popen(command .. " 2>&1")
  local text = pipe:read "a"
  return text, pipe:close()
end

local python = answer_of "/usr/bin/python3 -c 'import ipykernel, nbconvert; print(1)'" == "1\n"
local folder = os.tmpname()
os.remove(folder)
if not python or os.getenv "UNDER" ~= "" then
  print "# skipped: notebooks (python3-ipykernel, jupyter-nbconvert)"
  local text, fine = answer_of(("PATH='' '%s' --jupyter='%s'"):format(dmlua, folder))
  ok(not fine and (text:find "python3%-ipykernel" or text:find "cannot make the folder"),
    "without commands it says what is missing", text)
  tap.done()
  return
end

local text, fine = answer_of(("'%s' --jupyter='%s'"):format(dmlua, folder))
ok(fine and text:find(folder, 1, true), "the kernel is installed", text)
local f <close> = io.open(folder .. "/share/jupyter/kernels/dmlua/kernel.json")
local spec = f and require "dm.base.json".decode(f:read "a")
ok(spec and spec.display_name == "dmlua" and spec.env.DMLUA:find "dmlua", "with the program that installed it")
-- one process of nbconvert for all of them, since its start takes longer than a notebook
local NAMES = { "noether", "symplecticity", "routh" }
local sources = "docs/notebooks/" .. table.concat(NAMES, ".ipynb docs/notebooks/") .. ".ipynb"
text, fine = answer_of(("JUPYTER_PATH='%s/share/jupyter' /usr/bin/python3 -m nbconvert --to notebook --execute %s --output-dir '%s'")
  :format(folder, sources, folder))
ok(fine, "notebooks run to their ends", text:sub(-300))
for _, name in ipairs(NAMES) do
  local result <close> = io.open(("%s/%s.ipynb"):format(folder, name))
  ok(result and result:read "a":find '"output_type"', "notebook " .. name)
end
text, fine = answer_of(("'%s' --jupyter=/proc/none"):format(dmlua))
ok(not fine and text:find "/proc/none", "a folder where nobody may write", text)
os.execute(("rm -rf '%s'"):format(folder))

tap.done()
