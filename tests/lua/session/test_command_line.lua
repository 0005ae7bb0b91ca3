-- dmlua's command line against lua5.4's: output, messages and exit code over a table of commands; and
-- what dmlua has beyond it
local tap = require "tap"
local ok = tap.ok

local dmlua = os.getenv "DMLUA" or arg[-1]
if not dmlua:find "/" then dmlua = arg[-1] end
local here = os.tmpname()
os.remove(here)
assert(os.execute("mkdir -p " .. here))

local function write(name, text)
  local file = assert(io.open(here .. "/" .. name, "w"))
  file:write(text)
  file:close()
end

write("args.lua", "print(#arg, arg[0], arg[1], arg[-1], ...)")
write("bang.lua", "#!/usr/bin/env lua\nprint 'shebang'")
write("hash.lua", "# a comment, no newline")
write("fails.lua", "local function f() error 'deep' end\nlocal function g() f() end\ng()")
write("table.lua", "error { code = 1 }")
write("object.lua", "error(setmetatable({}, { __tostring = function() return 'an object' end }))")
write("nothing.lua", "error()")
write("syntax.lua", "x = = 1")
write("exits.lua", "os.exit(7)")
write("closes.lua", "local x <close> = setmetatable({}, { __close = function() print 'closed' end })\nos.exit(true, true)")
write("warns.lua", "warn 'something'")
write("stops.lua", "io.stdout:write 'no newline'")
write("mod.lua", "print(...); return { x = 5 }")
write("init.lua", "print 'init file'")
write("entries.txt", "1+1\nx = 3\n=x\nfor i = 1, 2 do\nprint(i)\nend\n'text', nil\nerror 'oops'\n")
write("gc.lua", "setmetatable({}, { __gc = function() print 'finalized' end })")
write("-", "print 'a file named -'")

-- run in the folder `here`: both outputs and the exit code as one text
local function run(program, command)
  local pipe = io.popen(("cd %s && { %s; } 2>&1; echo \"[$?]\""):format(here, (command:gsub("LUA%f[^%w_]", program))))
  local text = pipe:read "a"
  pipe:close()
  return text
end

local function folder_of(path) return io.popen("realpath " .. path):read "l" end
dmlua = folder_of(dmlua)

-- what may differ: the name of the program, the version line, the option list after a wrong option
local function plain(text, program)
  text = text:gsub(program:gsub("%p", "%%%0"), "LUA"):gsub("dmlua [%d.]+  Lua 5.4  type %? for help", "VERSION")
  text = text:gsub("dmlua [%d.]+  Lua 5.4", "Lua 5.4"):gsub("Lua 5.4.%d  Copyright[^\n]*", "VERSION")
  text = text:gsub("(Available options are:).-(%[1%])", "%1 %2")
  return text
end

local commands = {
  -- options
  "LUA -e 'print(1)'", "LUA -e'print(1)'", "LUA -e 'print(1)' -e 'print(2)'", "LUA -e", "LUA -e -v", "LUA -l", "LUA -l -e",
  "LUA -h", "LUA -vv", "LUA -iv", "LUA -Ex", "LUA -Wx", "LUA ---", "LUA --x", "LUA -e 'x = = 1'", "LUA -e 'error \"oops\"'",
  "LUA -e 'print(1)' -x", "LUA -v", "LUA -v -e 'print(3)'", "LUA -v args.lua a", "LUA -e '' args.lua a",
  "LUA -lmod -e 'print(mod.x)'", "LUA -l mod -e 'print(mod.x)'", "LUA -l g=mod -e 'print(g.x, mod)'",
  "LUA '-lm=math' -e 'print(m.max(1, 2))'", "LUA -l nowhere", "LUA -l string -l io -e 'print(io.write ~= nil)'",
  "LUA -W -e 'warn \"w\"'", "LUA warns.lua", "LUA -W warns.lua", "LUA -e 'warn \"@on\"' warns.lua",
  -- scripts and arg
  "LUA args.lua", "LUA args.lua a b c", "LUA -- args.lua a", "LUA -e '' -- args.lua -x --y", "LUA args.lua -e 'print(1)'",
  "LUA missing.lua", "LUA bang.lua", "LUA hash.lua", "LUA fails.lua", "LUA table.lua", "LUA object.lua", "LUA nothing.lua",
  "LUA syntax.lua", "LUA exits.lua", "LUA closes.lua", "LUA stops.lua", "LUA gc.lua", "LUA .", "LUA -- -",
  "LUA -e 'arg[1] = 100' args.lua a", "LUA -e 'arg = 1' args.lua", "LUA -e 'for i = 1, 300 do arg[i] = i end' args.lua",
  "LUA -E -e 'print(package.path, package.cpath)'", "LUA -e 'print(#arg, arg[0] ~= nil, arg[1])'",
  -- stdin
  "echo 'print(10)' | LUA", "echo 'print(10)' | LUA -", "echo 'print(...)' | LUA - a b", "echo 'x = = 1' | LUA",
  "echo 'error(1)' | LUA -",
  "echo '=1' | LUA", "LUA < args.lua", "LUA - < fails.lua", "LUA -e 'print(io.read())' < bang.lua", "printf '' | LUA",
  -- environment
  "LUA_INIT='print(\"init\")' LUA -e 'print(1)'", "LUA_INIT='print(\"init\")' LUA -E -e 'print(1)'",
  "LUA_INIT=@init.lua LUA args.lua",
  "LUA_INIT='print(1)' LUA_INIT_5_4='print(2)' LUA -e ''",
  "LUA_INIT='error \"in init\"' LUA -e 'print(1)'", "LUA_INIT='x = =' LUA -v",
  "LUA_INIT=@missing.lua LUA -e ''", "LUA_INIT='print(#arg, arg[1])' LUA args.lua a", "LUA_INIT= LUA -e 'print(1)'",
  "LUA_PATH=x LUA -e 'print(package.path)'",
  "LUA_PATH='a;;b' LUA -e 'print(package.path)'",
  "LUA_PATH_5_4=y LUA_PATH=x LUA -e 'print(package.path)'",
  "LUA_CPATH=x LUA -e 'print(package.cpath)'", "LUA_PATH=x LUA -E -e 'print(package.path)'",
  "echo 10 | LUA -e 'print = nil' -i 2>&1 >/dev/null",
  "echo 'error \"oops\"' | LUA -i 2>&1 >/dev/null", "echo 'x = = 1' | LUA -i 2>&1 >/dev/null",
}

-- readline shows what it reads, so these agree only where dmlua has it, as lua5.4 has
if require "dm.manual".readline then
  for _, command in ipairs {
    "LUA -i < entries.txt 2>/dev/null", "LUA -i -e 'print(1)' < entries.txt 2>/dev/null", "LUA -i args.lua a < /dev/null",
    "LUA -e '_PROMPT=\"in \" _PROMPT2=\"more \"' -i < entries.txt 2>/dev/null",
  } do commands[#commands + 1] = command end
end

local lua = io.popen("command -v lua5.4"):read "l"
if lua then
  for _, command in ipairs(commands) do
    local ours, theirs = plain(run(dmlua, command), dmlua), plain(run(lua, command), lua)
    ok(ours == theirs, command, "\n# dmlua: " .. ours:gsub("\n", "\n#  ") .. "\n# lua5.4: " .. theirs:gsub("\n", "\n#  "))
  end
end

---- beyond lua ----

local function shows(command, text)
  local got = run(dmlua, command)
  ok(got:find(text, 1, true), command .. " shows " .. text:gsub("\n", "\\n"), got)
end

shows("LUA --version", "Lua 5.4")
shows("LUA --version", "[0]")
shows("LUA --help", "[0]")
shows("LUA --color=sometimes", "write --color=auto, --color=always or --color=never")
shows("LUA --color=sometimes", "[1]")
shows("LUA -e 'print(dm.R(2).n)'", "2\n")

-- what waits in a buffer is written at the end: a disk that is full then is an error, as any other
for _, script in ipairs { "print(1)", "print(1) os.exit(true)", "io.write(1) error(\"oops\")" } do
  local command = ("LUA -e '%s' > /dev/full"):format(script)
  shows(command, "the standard output is not complete")
  shows(command, "[1]")
end
shows("LUA -e 'print(1)' >&-", "[1]")
shows("LUA -e '' >&-", "[0]")
shows("LUA -e 'print(1)' > /dev/null", "[0]")
shows("cd / && LUA -e 'print(require \"dm\" == dm)'", "true")
shows("LUA_PATH=x LUA_CPATH=x LUA -e 'print(require \"dm\" == dm)'", "true")
shows("printf '1 + 1\\n_ * 10;\\n_ + 5\\n{ 1,\\n2 }\\n' | LUA -q -i", "25")
shows("printf '1 + 1\\n_ * 10;\\n_ + 5\\n{ 1,\\n2 }\\n' | LUA -q -i", "{ 1, 2 }")
shows("LUA -e 'help(dm.vector)'", "dm.vector{x1, x2, ...} -> dm.vector")
shows("LUA -e 'help(dm)'", "demo(name [, {number = value}])")
shows("LUA -e 'apropos \"sphere\"'", "dm.S(n)")
shows("LUA -e 'help = 3' -e 'print(help)'", "3\n")
shows("printf 'print(help)' | LUA -", "nil\n")
shows("echo '?keys' | LUA -q -i", "a trailing ; evaluates without printing")
shows("echo '1+1' | LUA -q -i | head -c 1", ">")

-- help and its like in -e, where no name of the user is in the way
shows("LUA -e 'help(dm)'", "dm.plot(x, y")
shows("LUA -e 'help \"rules\"' -e 'print(type(demo), type(who))'", "function\tfunction")
shows("LUA -e 'help = 6 print(help * 7)'", "42")
shows("printf 'help(help)\\n' | LUA -q -i -e 'x = 1'", "What x is: the doc of a function")
local plain = os.tmpname()
io.open(plain, "w"):write("print('help is', help)"):close()
shows("LUA " .. plain, "help is\tnil")
os.remove(plain)

-- every option of the table is in --help, in the man page, and known to the parser
local man, help = require "dm.session.man", run(dmlua, "LUA --help")
local page, bash, zsh = man.page(), man.bash(), man.zsh()
for _, row in ipairs(require "dm.manual".options) do
  local all = help:find(row.what, 1, true) and page:find(row.name:gsub("%-", "\\-"), 1, true)
  local shells = row.name:find "^%-%-?$" or bash:find(row.name, 1, true) and zsh:find(row.name, 1, true)
  ok(all and shells, row.name .. " is in --help, the man page and the completions")
  local value = row.name == "-e" and "''" or row.name == "-l" and "io" or ""
  if row.name == "--color" then value = "=never" elseif row.name == "--part" then value = " 1/1"
  elseif row.name == "--where" then value = " lua"
  elseif row.name == "--jupyter" then value = "=/proc/none"
  elseif value ~= "" then value = " " .. value end
  local answer = run(dmlua, "printf '' | LUA " .. row.name .. value)
  local refused = { ["--join"] = "write --join OUT FILE", ["--machine"] = "two open descriptors" }
  if row.name == "--jupyter" then refused[row.name] = answer:find "/proc/none" and "/proc/none" or "python3-ipykernel" end
  ok(refused[row.name] and answer:find(refused[row.name], 1, true) or answer:find "%[0%]\n$" and not answer:find "unrecognized", row.name .. " is an option", answer)
end

local function same_as(name, text)
  local file = io.open("docs/" .. name)
  ok(file and file:read "a" == text, "docs/" .. name .. " is what `make docs` writes")
  if file then file:close() end
end
same_as("dmlua.1", page)
same_as("completion/dmlua.bash", bash)
same_as("completion/_dmlua", zsh)

os.execute("rm -r " .. here)
tap.done()
