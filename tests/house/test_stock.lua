-- The other ways in: a stock lua5.4 with the paths that README names, and an installed copy.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

local probe = [[
local dm = require "dm"
local s = dm.system { Q = dm.R(1), L = function(q, v) return v:dot(v) / 2 - q:dot(q) / 2 end }
local path = s:solver { rule = "verlet", h = 0.01 }:run { q = { 1 }, v = { 0 }, steps = 100 }
assert(math.abs(path.q[#path.q][1] - math.cos(1)) < 1e-4)
print "a step of cosine"]]

local function says(command)
  local text, fine = house.output(command)
  return fine and text:find "a step of cosine" and {} or { text }
end

local here = house.lines("pwd")[1]
local build = house.build:sub(1, 1) == "/" and house.build or here .. "/" .. house.build
local script = os.tmpname()
do
  local f <close> = assert(io.open(script, "w"))
  f:write(probe)
end
local outside = "cd / && env -u LUA_INIT "

if house.under == "" and house.output("command -v lua5.4") ~= "" then
  local paths = ("LUA_PATH='%s/lua/?.lua;%s/lua/?/init.lua;;' LUA_CPATH='%s/?.so;;' "):format(here, here, build)
  house.check("a stock lua5.4 loads dm from the build tree", says(outside .. paths .. "lua5.4 " .. script))
else
  house.skip("a stock lua5.4 loads dm from the build tree", "no lua5.4, or a sanitizer in the way")
end

local prefix = os.tmpname()
os.remove(prefix)
local make = ("make --no-print-directory B='%s' PREFIX='%s' "):format(house.build, prefix)
local log, fine = house.output(make .. "install")
house.check("make install goes through", fine and {} or { log })
house.check("the installed dmlua runs anywhere", says(outside .. prefix .. "/bin/dmlua " .. script))
if house.under == "" and house.output("command -v lua5.4") ~= "" then
  local paths = ("LUA_PATH='%s/share/lua/5.4/?.lua;%s/share/lua/5.4/?/init.lua' LUA_CPATH='%s/lib/lua/5.4/?.so' ")
    :format(prefix, prefix, prefix)
  house.check("a stock lua5.4 loads the installed dm", says(outside .. paths .. "lua5.4 " .. script))
end
house.check("the man page is installed",
  house.output("grep -c dmlua " .. prefix .. "/share/man/man1/dmlua.1"):find "^[1-9]" and {} or { "not found" })
house.output(make .. "uninstall")
house.check("make uninstall leaves no file", house.lines("find " .. prefix .. " ! -type d"))
house.output("rm -rf " .. prefix)
os.remove(script)
house.finish()
