--- dmlua --jupyter: the kernel of notebooks where Jupyter looks for it.
local json = require "dm.base.json"
local text_file = require "dm.base.text_file"

local M = {}

local function shell_quote(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

local function answer_of(command)
  local pipe = io.popen(command .. " 2>/dev/null")
  local text = pipe:read "a"
  pipe:close()
  return text:match "^(.-)%s*$"
end

-- a Python that has ipykernel
local function python()
  for _, name in ipairs { "python3", "/usr/bin/python3" } do
    local found = answer_of(name .. " -c 'import ipykernel, sys; print(sys.executable)'")
    if found ~= "" then return found end
  end
  error("no Python with ipykernel: install it (Debian, Ubuntu: apt install python3-ipykernel "
    .. "jupyter-notebook)", 0)
end

-- the kernel's text, beside lua/dm
local function kernel_text()
  local home = package.searchpath("dm.notebook.install", package.path)
    or debug.getinfo(1, "S").source:sub(2)
  local name = home:gsub("dm/notebook/install%.lua$", "python/dmlua_kernel.py")
  local file, why = io.open(name)
  if not file then error("the kernel did not come with this dmlua: " .. why, 0) end
  local text = file:read "a"
  file:close()
  return text
end

local function make_folder(folder)
  if answer_of("mkdir -p " .. shell_quote(folder) .. " && echo made") ~= "made" then
    error(("cannot make the folder %s: may you write there? --jupyter=PREFIX takes another")
      :format(folder), 0)
  end
end

--- Writes PREFIX/share/jupyter/kernels/dmlua; PREFIX is ~/.local by default.
function M.command(prefix)
  local interpreter, text = python(), kernel_text()
  prefix = prefix or (os.getenv "HOME" or ".") .. "/.local"
  local folder = prefix .. "/share/jupyter/kernels/dmlua"
  make_folder(folder)
  local own = answer_of "readlink /proc/$PPID/exe"
  local spec = {
    argv = { interpreter, "{resource_dir}/dmlua_kernel.py", "-f", "{connection_file}" },
    display_name = "dmlua", language = "lua", interrupt_mode = "signal",
    env = { DMLUA = own ~= "" and own or "dmlua" } }
  text_file.write(folder .. "/dmlua_kernel.py", text, "--jupyter")
  text_file.write(folder .. "/kernel.json", json.encode(spec) .. "\n", "--jupyter")
  print("kernel dmlua is in " .. folder)
  local places = answer_of "jupyter --paths 2>/dev/null"
  if prefix ~= (os.getenv "HOME" or ".") .. "/.local"
    and not places:find(prefix .. "/share/jupyter", 1, true) then
    print("Jupyter finds it with JUPYTER_PATH=" .. prefix .. "/share/jupyter")
  end
end

return M
