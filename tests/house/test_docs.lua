-- Every public function and method answers help(), with its signature first; the pages that are made
-- from the same texts are the ones that are kept.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local core = require "dm.core"
local dm = require "dm"
local reference = require "dm.session.reference"

local classes = reference.classes()

local silent, unsigned, short, n = {}, {}, {}, 0
local function look(name, doc)
  n = n + 1
  local last = name:match "[^.:]+$"
  if type(doc) ~= "string" then silent[#silent + 1] = name; return end
  if not doc:match("^[^\n]*"):find(last, 1, true) then unsigned[#unsigned + 1] = name .. ": " .. doc:match "^[^\n]*" end
  if not doc:find "\n%s*%S" then short[#short + 1] = name end
end
for name, f in pairs(reference.functions(dm)) do look(name, core.docs[f]) end
for class, methods in pairs(classes) do
  look(class, core.docs[class])
  for name, f in pairs(methods) do look(class .. ":" .. name, core.docs[f]) end
end

-- what ?examples and ?failures list is what there is
local listed, there, codes = {}, {}, {}
for _, name in ipairs(require "dm.session.examples".names) do listed[name] = true end
for _, file in ipairs(house.files "^examples/.*%.lua$") do
  local name = file:match "([%w_]+)%.lua$"
  if not listed[name] then there[#there + 1] = name .. " is not listed" end
  listed[name] = nil
end
for name in pairs(listed) do there[#there + 1] = name .. " is no file" end
house.check("lua/dm/session/examples.lua lists the files of examples/", there)
local known = {}
for _, row in ipairs(require "dm.session.failures") do known[row[1]] = true end
for code in house.read "src/base/status.h":gmatch 'X%(%u[%u_]*, "([%l_]+)"' do
  if code ~= "ok" and not known[code] then codes[#codes + 1] = code end
end
house.check("?failures explains every status", codes)

house.check("there are functions and methods to look at", n > 80 and {} or { n .. " found" })
house.check("each has a doc", silent)
house.check("the first line of a doc is the signature", unsigned)
house.check("a doc says more than the signature", short)

local page = io.open "docs/reference.md"
local kept = page and page:read "a"
house.check("docs/reference.md is what `make docs` writes",
  kept == reference.text(dm) and {} or { "run `make docs` and look at the change" })
local man = require "dm.session.man"
for _, row in ipairs { { "docs/dmlua.1", man.page() }, { "docs/completion/dmlua.bash", man.bash() },
  { "docs/completion/_dmlua", man.zsh() }, { "docs/meta/dm.lua", require "dm.session.meta".text(dm) } } do
  local file, text = row[1], row[2]
  house.check(file .. " is what `make docs` writes", house.read(file) == text and {} or { "run `make docs`" })
end
house.finish()
