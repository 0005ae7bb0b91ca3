--- help, apropos, who: what the docs of the registration rows say, asked from a session.
local blame = require "dm.base.blame"
local core = require "dm.core"
local layout = require "dm.session.text"
local pager = require "dm.session.pager"
local search = require "dm.session.apropos"

local M = { apropos = search.apropos }

local docs = core.docs

local first_line, write, wrapped = layout.first_line, layout.write, layout.wrapped
local text_width, sorted = layout.width, layout.sorted

-- a doc, and below it the example that belongs to it
local function shown_doc(doc, name)
  local example = require "dm.session.example".of_doc(doc, name)
  if not example then return layout.doc(doc) end
  return layout.doc(doc) .. "\n\n  Example:\n    " .. example:gsub("\n+$", "")
    :gsub("\n%f[^\n]", "\n    ")
end

---- names of the standard library ----

local SECTIONS = { string = "6.4", utf8 = "6.5", table = "6.6", math = "6.7", io = "6.8",
  os = "6.9",
  debug = "6.10", coroutine = "6.2", package = "6.3", _G = "6.1" }
local standard = {}
for library, section in pairs(SECTIONS) do
  for name, value in pairs(_G[library] or {}) do
    local full = library == "_G" and name or library .. "." .. name
    if type(value) == "function" and not docs[value] then standard[value] = { full, section } end
  end
end

---- help on a value ----

-- those of every object of the class first, then those of some: field:modes of a dm.system
local function list_methods(class, methods)
  local own, some = {}, {}
  local object = "^" .. class:match "[%w_]+$" .. ":"
  for name, f in pairs(methods) do
    local line = docs[f] and first_line(docs[f]) or class .. ":" .. name
    local lines = (line:find(object) or not docs[f]) and own or some
    lines[#lines + 1] = "  " .. line
  end
  own, some = sorted(own), sorted(some)
  table.move(some, 1, #some, #own + 1, own)
  if #own > 0 then write("methods:\n", table.concat(own, "\n")) end
end

local function help_class(class)
  local methods = require "dm.session.complete".methods_of(class)
  if not docs[class] and not methods then return false end
  if docs[class] then write(shown_doc(docs[class])) end
  if methods then list_methods(class, methods) end
  return true
end

local function help_function(f, name)
  if docs[f] then return write(shown_doc(docs[f], name)) end
  if standard[f] then
    return write(("%s: standard Lua, reference manual section %s")
      :format(table.unpack(standard[f])))
  end
  local info = debug.getinfo(f, "Su")
  if info.what == "C" then return write "a C function without a doc" end
  write(("a function of %d argument%s%s, defined at %s:%d"):format(info.nparams,
    info.nparams == 1 and "" or "s", info.isvararg and " and more" or "", info.short_src,
    info.linedefined))
end

local function load_all(t)
  local meta = getmetatable(t)
  if type(meta) == "table" and meta.load_all then meta.load_all() end
end

-- what a table has, one line each; undocumented names together at the end
local function help_table(t)
  load_all(t)
  local lines, rest = {}, {}
  for name, value in pairs(t) do
    local doc = type(value) == "function" and docs[value]
    if doc then
      lines[#lines + 1] = "  " .. first_line(doc)
    elseif type(name) == "string" then
      rest[#rest + 1] = name
    end
  end
  if #lines > 0 then write(table.concat(sorted(lines), "\n")) end
  if #rest > 0 then
    write(wrapped("other fields: " .. table.concat(sorted(rest), ", "), text_width(), "  "))
  end
  if #lines + #rest == 0 then write(("a table of %d entries without names"):format(#t)) end
end

---- topics ----

local function rows(title, list)
  local lines, widest = { title }, 0
  for _, row in ipairs(list) do widest = math.max(widest, #row.name + #row.argument + 1) end
  for _, row in ipairs(list) do
    local name = row.name .. (row.argument ~= "" and " " .. row.argument or "")
    lines[#lines + 1] = ("  %-" .. math.min(widest, 24) .. "s  %s"):format(name, row.what)
  end
  write(table.concat(lines, "\n"))
end

-- the rows of the command line; nothing under a stock lua5.4
local function manual()
  local found, module = blame.try(require, "dm.manual")
  return found and module or nil
end

local topics = {}

function topics.keys() rows("in a session:", manual() and manual().keys or {}) end

function topics.options()
  local m = manual()
  if not m then return write "dmlua's options: see dmlua --help" end
  rows("usage: dmlua [options] [script [args]]", m.options)
  rows("environment:", m.variables)
  rows("files:", m.files)
end

function topics.rules()
  local list = core.rules and core.rules() or {}
  local lines = {}
  for _, rule in ipairs(list) do
    lines[#lines + 1] = ("  %-24s %s"):format(rule.signature or rule.name,
      first_line(rule.doc or ""))
  end
  write("rules of dm.solver{ rule = }:\n", table.concat(lines, "\n"))
end

function topics.classes()
  load_all(require "dm")
  local lines = {}
  for class, doc in pairs(docs) do
    if type(class) == "string" then lines[#lines + 1] = "  " .. first_line(doc) end
  end
  write("classes:\n", table.concat(sorted(lines), "\n"))
end

function topics.demos() search.demos() end

function topics.examples()
  if search.examples() == 0 then
    write "the examples did not come with this dmlua: docs/examples.md of its source has them"
  end
end

function topics.failures()
  search.failures()
  write "?dm.failure has its fields; ensemble:failures() lists the members that failed"
end

function topics.topics()
  write [[
?x or help(x)      on a function, value, class or name: ?dm.solver, ?path.drift, ?dm.path
help(dm)           everything that dm has
?classes ?rules    the kinds of values; the rules of solvers
?demos ?examples   what can be run to see how things are done
?failures          what the codes of a dm.failure mean, and what to try
?keys ?options     keys and commands of a session; the command line
apropos "word"     every doc, demonstration, example and failure that mentions the word
who()              the globals of this session
demo()             guided demonstrations]]
end

---- help ----

-- "path.drift", "solver:run", "dm.path.drift": the method of a class, also before there is a value
-- of it
local function method_of_class(name)
  local class, method = name:gsub("^dm%.", ""):match "^([%w_]+)[.:]([%w_]+)$"
  local methods = class and require "dm.session.complete".methods_of("dm." .. class)
  return methods and methods[method]
end

-- "routh", "plot": the functions and methods of that name: their docs, where they are few, else
-- their signatures; or nothing
local function of_name(name)
  local found, lines, MOST = {}, {}, 3
  for line, doc in pairs(name:find "^[%a_][%w_]*$" and search.docs() or {}) do
    local owner, own = line:match "^([%a_]+)[.:]([%w_]+)[%({]"
    if own == name and owner ~= "core" then
      found[#found + 1], lines[#lines + 1] = shown_doc(doc), line
    end
  end
  return #found > 0 and table.concat(sorted(#found <= MOST and found or lines), "\n") or nil
end

-- "solver.multiplier", "path.plott" of an object or a class: that it has no such name, and the
-- nearest that it has; or nothing
local function not_there(name)
  local complete = require "dm.session.complete"
  local owner, key = name:match "^(.+)[.:]([%a_][%w_]*)$"
  local object = owner and complete.look_up(owner)
  local class = object and (object.class or complete.class_of(object.value))
    or owner and "dm." .. owner:gsub("^dm%.", "")
  return class and complete.methods_of(class)
    and require "dm.session.missing".of(class, key) or nil
end

local explain  -- what x is

local function help_name(name)
  load_all(require "dm")
  if topics[name] then return topics[name]() end
  local same_name = docs[name] and require "dm.session.complete".look_up(name)
  if same_name and docs[same_name.value or name] then
    write(shown_doc(docs[same_name.value or name]))
  end
  if help_class(name) then return end
  local object = require "dm.session.complete".look_up(name)
    or require "dm.session.complete".look_up("dm." .. name)
  if object and object.class and object.value == nil then return help_class(object.class) end
  if object and object.value ~= nil and type(object.value) ~= "string" then
    return explain(object.value)
  end
  local method = method_of_class(name)
  if method and docs[method] then return help_function(method, (name:gsub("^dm%.", ""))) end
  for _, rule in ipairs(core.rules and core.rules() or {}) do
    if rule.name == name:match "^[%w_]*" then
      return write(rule.signature or name, "\n", wrapped(rule.doc or "", text_width(), "  "))
    end
  end
  local written = search.as_written(name)
  if written then return write(shown_doc(written)) end
  if docs["dm." .. name] then return help_name("dm." .. name) end
  local same = of_name(name)
  if same then write(same) end
  if search.about(name) or same then return end
  local why = not_there(name)
  if why then return write(why) end
  search.first_mentions(name)
end

-- a group: what its elements look like
local function help_elements(space)
  local kit = require "dm.group".kit(space)
  if kit.manifold then
    return write(("%s: a manifold of dimension %d"):format(tostring(space), space.dimension))
  end
  local maker = tostring(space):match "^(%a+)%(%d+%)$"
  local order = core[maker] and (", in the order that help(dm.%s) gives"):format(maker) or ""
  write(wrapped(("%s: a group of dimension %d. An element is %s; an element of its algebra is a "
    .. "vector of %d numbers%s."):format(tostring(space),
    space.dimension, require "dm.group.starts".form(kit), space.dimension, order),
    text_width(), ""))
end

local doc_help = [[
help(x)
What x is: the doc of a function, the class and methods of a value, the content of a table; for a
string a topic ("keys", "options", "rules", "classes", "demos", "examples", "failures"), a class
("dm.path"), a name ("solver.run"), a rule, a code of a failure ("no_convergence"), a demonstration
or an example.]]

function explain(x)
  local kind, class = type(x), require "dm.session.complete".class_of(x)
  if kind == "string" then return help_name(x) end
  if kind == "function" then return help_function(x) end
  if class == "dm.space" then help_elements(x) end
  if (kind == "userdata" or kind == "table") and class and help_class(class) then return end
  if kind == "table" then return help_table(x) end
  if kind == "userdata" then return write(tostring(x)) end
  local asked = x == nil and require "dm.session.missing".asked()
  if asked then return help_name(asked) end
  local of = math.type(x) or kind
  write(("%s: %s %s of Lua"):format(tostring(x), of == "integer" and "an" or "a", of))
end

M.help = pager.paged(function(...)
  if select("#", ...) == 0 then return topics.topics() end
  explain((...))
end)

--- ?text of a session.
M.ask = pager.paged(function(text)
  text = text:match "^%s*(.-)[%s;]*$"
  if text == "" then return topics.topics() end
  help_name(text:match "^[\"'](.*)[\"']$" or text)
end)

---- who ----

local at_start = {}

local function described(value)
  local kind = type(value)
  if kind == "table" and not (getmetatable(value) or {}).__tostring then
    local n = 0
    for _ in next, value do n = n + 1 end
    return ("table of %d"):format(n)
  end
  if kind == "function" then
    local info = debug.getinfo(value, "S")
    return ("function at %s:%d"):format(info.short_src, info.linedefined)
  end
  local text = first_line(tostring(value))
  return #text > 70 and text:sub(1, 67) .. "..." or text
end

local doc_who = [[
who()
The globals that were made in this session, with what they are.]]

function M.who()
  local names, widest = {}, 0
  for name, value in next, _G do
    if type(name) == "string" and name ~= "_" and at_start[name] ~= value then
      names[#names + 1] = name
    end
  end
  for _, name in ipairs(sorted(names)) do widest = math.max(widest, #name) end
  for _, name in ipairs(names) do
    write(("%-" .. math.min(widest, 30) .. "s  %s"):format(name, described(_G[name])))
  end
  if #names == 0 then write "no globals yet" end
end

-- more arguments than the doc says raise
M.help, M.who = blame.caller(M.help), blame.caller(M.who)
docs[M.help], docs[M.who] = doc_help, doc_who

--- The globals of a session; names that are taken stay. who() tells of what comes later.
function M.open()
  require "dm.session.globals".open()
  for name, value in next, _G do at_start[name] = value end
end

return M
