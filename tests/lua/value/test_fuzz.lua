-- A short run of fuzz.lua (by hand: minutes, under sanitizers), in a folder of its own.
local dmlua, seconds = os.getenv "DMLUA" or "build/dmlua", os.getenv "FUZZ_SECONDS" or "5"
local seed = os.getenv "FUZZ_SEED" or "1"

local function output(command)
  local pipe = assert(io.popen(command .. " 2>&1"))
  local text = pipe:read "a"
  return text, (pipe:close())
end

local here = output "pwd":match "[^\n]+"
local function absolute(file) return file:sub(1, 1) == "/" and file or here .. "/" .. file end
local folder = output "mktemp -d":match "[^\n]+"
local text, fine = output(("cd '%s' && timeout 120 '%s' '%s/tests/lua/fuzz.lua' %s %s </dev/null")
  :format(folder, absolute(dmlua), here, seconds, seed))
print((fine and "ok" or "not ok") .. " 1 - random arguments to everything: each call returns or raises an error with words")
print("# " .. text:gsub("\n(.)", "\n# %1"):gsub("\n$", ""))
if not fine then print("# last: " .. output("cat '" .. folder .. "/last-call'")) end
print "1..1"
output("rm -rf '" .. folder .. "'")
os.exit(fine, true)
