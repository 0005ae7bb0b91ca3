-- docs/extending.md does what it says: its blocks are carried out on a copy of the tree, which is built again, and
-- what comes of them is run. What a block is stands in the line before it:
--   New file `PATH`:                     it becomes that file
--   In `PATH`, behind the line `TEXT`:   it is put in there
--   Then:                                a script that must run to its end
-- and what it may cost: new files, rows, objects that are compiled again.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

local MOST = { -- new files, rows, objects
  ["A group"] = { 2, 1, 20 }, ["A class"] = { 1, 1, 10 }, ["A verb"] = { 1, 1, 0 },
  ["An example"] = { 1, 1, 0 }, ["A demonstration"] = { 1, 1, 0 }, ["A benchmark"] = { 1, 0, 0 },
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

-- the fenced blocks of a section: kind, path, place, code
local function blocks(body)
  local list, label, block = {}, nil, nil
  for line in body:gmatch "([^\n]*)\n" do
    if line:find "^```%a" and not block then block = {}
    elseif line == "```" and block then
      local code = table.concat(block, "\n") .. "\n"
      local new, path, place = label:match "^New file `([^`]+)`:$", label:match "^In `([^`]+)`, behind the line `(.+)`:$"
      local kind = new and "new" or path and "row" or label == "Then:" and "script" or "unknown"
      list[#list + 1] = { kind = kind, label = label, path = new or path, place = place, code = code }
      block, label = nil, nil
    elseif block then block[#block + 1] = line
    elseif line:find "%S" then label = line end
  end
  return list
end

-- a copy of the tree and of its objects with their times, so that only what must is compiled again
local root = os.tmpname()
os.remove(root)
local function copy()
  local objects = [[find . \( -name '*.[od]' -o -name config.mk -o -name flags -o -name '*.a' -o -name dmlua \) ]]
    .. "-not -path './tests/*' -not -path './san/*' -not -path './bench/*' -print0"
  return house.output(([[mkdir -p '%s/build' && cp -a Makefile .ci src lua examples '%s' && cd '%s' &&
    %s | tar --format=posix --null -T - -cf - | tar -C '%s/build' -xf - &&
    find '%s/build' -name '*.d' -exec sed -i 's,%s/,build/,g' {} +]])
    :format(root, root, house.build, objects, root, root, house.build:gsub("%p", "\\%0")))
end

local function write(path, text)
  house.output(("mkdir -p '%s'"):format((root .. "/" .. path):match "^(.*)/"))
  local f <close> = assert(io.open(root .. "/" .. path, "w"))
  f:write(text)
end

-- carries a block out; a sentence where that cannot be done
local function apply(block)
  if block.kind == "new" then write(block.path, block.code) end
  if block.kind == "unknown" then return "what is this block for? " .. tostring(block.label) end
  if block.kind ~= "row" then return end
  local text = house.read(root .. "/" .. block.path)
  local _, last = text:find("\n[^\n]*" .. block.place:gsub("%p", "%%%0") .. "[^\n]*\n")
  if not last then return ("%s has no line %s"):format(block.path, block.place) end
  write(block.path, text:sub(1, last) .. block.code .. text:sub(last + 1))
end

-- the whole section; what went wrong
local function carry_out(part)
  local wrong, scripts, count = {}, {}, { new = 0, row = 0, script = 0 }
  for _, block in ipairs(blocks(part.body)) do
    count[block.kind] = (count[block.kind] or 0) + 1
    if block.kind == "script" then scripts[#scripts + 1] = block.code else wrong[#wrong + 1] = apply(block) end
  end
  if #wrong > 0 then return wrong end
  local log, built = house.output(("cd '%s' && make --no-print-directory -o build/flags B=build V= build/dmlua"):format(root))
  if not built then return { log } end
  local most, objects = MOST[part.title] or { 0, 0, 0 }, select(2, log:gsub(" cc +src/", ""))
  if count.new > most[1] or count.row > most[2] or objects > most[3] then
    wrong[1] = ("%d files, %d rows, %d objects compiled"):format(count.new, count.row, objects)
  end
  if #scripts == 0 then wrong[#wrong + 1] = "nothing is run" end
  for i, script in ipairs(scripts) do
    write("script.lua", script)
    local text, ran = house.output(("cd '%s' && build/dmlua script.lua"):format(root))
    if not ran then wrong[#wrong + 1] = ("script %d: %s"):format(i, text) end
  end
  return wrong
end

local said, fine = copy()
house.check("the tree can be copied", fine and {} or { said })
local there = {}
for _, part in ipairs(sections(house.read "docs/extending.md")) do
  there[part.title] = true
  house.check(part.title .. ": added as docs/extending.md says, it does what is asserted there", carry_out(part))
end
local missing = {}
for title in pairs(MOST) do if not there[title] then missing[#missing + 1] = title end end
house.check("docs/extending.md has them all", missing)
house.output(("rm -rf '%s'"):format(root))
house.finish()
