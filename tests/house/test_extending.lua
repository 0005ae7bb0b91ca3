-- docs/extending.md does what it says: its blocks are carried out on a copy of the tree, which is
-- built again, and what comes of them is run. What a block is stands in the line before it:
--   New file `PATH`:                     it becomes that file
--   In `PATH`, behind the line `TEXT`:   it is put in there
--   Then:                                a script that must run to its end
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

-- what adding may cost at most: new files, rows, objects that are compiled again
local MOST = {
  ["A rule"] = { 1, 1, 10 }, ["A group"] = { 2, 1, 20 }, ["A class"] = { 1, 1, 10 },
  ["A verb"] = { 1, 1, 0 }, ["An example"] = { 1, 1, 0 }, ["A demonstration"] = { 1, 1, 0 },
  ["A benchmark"] = { 1, 0, 0 },
}

local function sections(text)
  local list = {}
  for line in text:gmatch "[^\n]*\n" do
    local title = line:match "^## (.*)\n"
    if title then list[#list + 1] = { title = title, body = "" }
    elseif #list > 0 then list[#list].body = list[#list].body .. line end
  end
  return list
end

-- what the block below a line is: kind, path, the line that it goes behind
local function kind_of(label)
  local new = label:match "^New file `([^`]+)`:$"
  if new then return "new", new end
  local path, place = label:match "^In `([^`]+)`, behind the line `(.+)`:$"
  if path then return "row", path, place end
  return label == "Then:" and "script" or "unknown"
end

-- the fenced blocks of a section
local function blocks(body)
  local list, label, code = {}, "", nil
  for line in body:gmatch "([^\n]*)\n" do
    if line:find "^```%a" and not code then code = {}
    elseif line == "```" and code then
      local kind, path, place = kind_of(label)
      local text = table.concat(code, "\n") .. "\n"
      list[#list + 1] = { kind = kind, label = label, path = path, place = place, text = text }
      label, code = "", nil
    elseif code then code[#code + 1] = line
    elseif line:find "%S" then label = line end
  end
  return list
end

-- ---- a copy of the tree and of its objects with their times, so that only what must is compiled

local root = os.tmpname()
os.remove(root)

local function copy()
  local objects = [[find . \( -name '*.[od]' -o -name config.mk -o -name flags -o -name '*.a' ]]
    .. [[-o -name dmlua \) -not -path './tests/*' -not -path './san/*' -not -path './deb/*' -type f -not -path './bench/*' ]]
    .. "-print0 | tar --format=posix --null -T - -cf -"
  local command = [[mkdir -p '%s/build' && cp -a Makefile .ci src lua examples tests '%s' &&
    cd '%s' && %s | tar -C '%s/build' -xf - &&
    find '%s/build' -name '*.d' -exec sed -i 's,%s/,build/,g' {} +]]
  local build = house.build
  local prefix = build:gsub("%p", "\\%0")
  return house.output(command:format(root, root, build, objects, root, root, prefix))
end

local function write(path, text)
  house.output(("mkdir -p '%s'"):format((root .. "/" .. path):match "^(.*)/"))
  local f <close> = assert(io.open(root .. "/" .. path, "w"))
  f:write(text)
end

-- carries a block out; a sentence where that cannot be done
local function apply(block)
  if block.kind == "new" then write(block.path, block.text) end
  if block.kind == "unknown" then return "what is this block for? " .. block.label end
  if block.kind ~= "row" then return end
  local text = house.read(root .. "/" .. block.path)
  local _, last = text:find("\n[^\n]*" .. block.place:gsub("%p", "%%%0") .. "[^\n]*\n")
  if not last then return ("%s has no line %s"):format(block.path, block.place) end
  write(block.path, text:sub(1, last) .. block.text .. text:sub(last + 1))
end

local function here(command) return house.output(("cd '%s' && %s"):format(root, command)) end

-- what is compiled again is only tried: the flags of the copy (-o: not looked at) may be others
local function make()
  return here "make --no-print-directory -o build/flags B=build V= CFLAGS=-O0 build/dmlua"
end

local function build(count, most)
  local log, built = "", true
  if count.c > 0 then log, built = make() end -- what is in Lua alone compiles nothing
  local objects = select(2, log:gsub(" cc +src/", ""))
  if not built then return log end
  if count.new > most[1] or count.row > most[2] or objects > most[3] then
    return ("%d files, %d rows, %d objects compiled"):format(count.new, count.row, objects)
  end
end

local function run(scripts)
  if #scripts == 0 then return "nothing is run" end
  for _, script in ipairs(scripts) do
    write("script.lua", script)
    local text, ran = here "build/dmlua script.lua"
    if not ran then return text end
  end
end

-- the whole section; what went wrong
local function carry_out(part)
  local wrong, scripts, count = {}, {}, { new = 0, row = 0, script = 0, unknown = 0, c = 0 }
  for _, block in ipairs(blocks(part.body)) do
    count[block.kind] = count[block.kind] + 1
    if (block.path or ""):find "^src/" then count.c = count.c + 1 end
    if block.kind == "script" then scripts[#scripts + 1] = block.text end
    wrong[#wrong + 1] = apply(block)
  end
  wrong[#wrong + 1] = #wrong == 0 and build(count, MOST[part.title] or { 0, 0, 0 }) or nil
  wrong[#wrong + 1] = #wrong == 0 and run(scripts) or nil
  return wrong
end

local said, fine = copy()
house.check("the tree can be copied", fine and {} or { said })
said, fine = make()
house.check("and the copy be built", fine and {} or { said })
local there = {}
for _, part in ipairs(sections(house.read "docs/extending.md")) do
  there[part.title] = true
  house.check(part.title .. ": added as the page says, it does what is asserted", carry_out(part))
end
local missing = {}
for title in pairs(MOST) do if not there[title] then missing[#missing + 1] = title end end
house.check("docs/extending.md has them all", missing)
house.output(("rm -rf '%s'"):format(root))
house.finish()
