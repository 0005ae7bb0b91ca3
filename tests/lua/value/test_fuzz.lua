-- A short shard of tests/fuzz (by hand: tests/fuzz/run, under sanitizers), in a folder of its own,
-- and a few hundred spoilt mesh files of each format.
local dmlua = os.getenv "DMLUA" or "build/dmlua"
local calls, seed = os.getenv "FUZZ_CALLS" or "6000", os.getenv "FUZZ_SEED" or "1"

local function output(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read "a"
  return text, (pipe:close())
end

local here = output "pwd":match "[^\n]+"
local function absolute(file) return file:sub(1, 1) == "/" and file or here .. "/" .. file end
local folder, count = output "mktemp -d":match "[^\n]+", 0
local function try(what, script, arguments)
  local text, fine = output(("cd '%s' && timeout 600 '%s' '%s/tests/fuzz/%s' %s </dev/null")
    :format(folder, absolute(dmlua), here, script, arguments))
  count = count + 1
  print(("%s %d - %s"):format(fine and "ok" or "not ok", count, what))
  print("# " .. text:gsub("\n(.)", "\n# %1"):gsub("\n$", ""))
  if not fine then print("# last: " .. output("cat '" .. folder .. "/last-call'")) end
end
try("random calls of everything: each returns or raises an error with words", "shard.lua",
  seed .. " " .. calls .. " 10")
for _, format in ipairs { "obj", "off", "msh2", "msh4", "mesh", "node" } do
  try("spoilt ." .. format .. " files are read or refused", "meshes.lua", format .. " 1 300")
end
print("1.." .. count)
output("rm -rf '" .. folder .. "'")
