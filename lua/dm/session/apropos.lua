--- apropos: where a word is spoken of, in the docs, the demonstrations, the examples and the codes
-- of failures.
local blame = require "dm.base.blame"
local core = require "dm.core"
local examples = require "dm.session.examples"
local pager = require "dm.session.pager"
local text = require "dm.session.text"

local M = {}

local docs, first_line, write = core.docs, text.first_line, text.write

--- Signature -> doc of everything documented.
function M.docs()
  getmetatable(require "dm").load_all()
  local found = {}
  for _, doc in pairs(docs) do
    if type(doc) == "string" then found[first_line(doc)] = doc end
  end
  local replaced = {}  -- docs of methods that were replaced by what can do more: "line   or more"
  for other in pairs(found) do
    for at in other:gmatch "()   " do replaced[#replaced + 1] = other:sub(1, at - 1) end
  end
  for _, line in ipairs(replaced) do found[line] = nil end
  return found
end

--- The doc that writes itself "shape.lift", "rho:check" or "core.crc32", where the word before the
-- dot is no class; or nil.
function M.as_written(name)
  local owner, method = name:match "^([%a_]+)[.:]([%w_]+)$"
  if not owner then return nil end
  if owner == "core" then return docs[require "dm.session.reference".for_modules()[name] or 1] end
  local start, second = owner .. ":" .. method, nil  -- second: behind an "or" of the signature
  for line, doc in pairs(M.docs()) do
    if line:sub(1, #start) == start and line:find("^[%({]", #start + 1) then return doc end
    local other = line:find("   or   " .. start, 1, true)
    if other and line:find("^[%({]", other + 8 + #start) and (not second or doc < second) then
      second = doc
    end
  end
  return second
end

-- a sentence in at most `width` characters, whole words of it
local function cut(sentence, width)
  if #sentence <= width then return sentence end
  return sentence:sub(1, width - 3):match "^(.*%S)%s+%S*$" .. " ..."
end

-- "name   what" for each row { name, what }, cut to the width
local function write_rows(title, rows)
  if #rows == 0 then return end
  local widest = 0
  for _, row in ipairs(rows) do widest = math.max(widest, #row[1]) end
  write(title)
  for _, row in ipairs(rows) do
    write(("  %-" .. widest .. "s  %s"):format(row[1], cut(row[2], text.width() - widest - 4)))
  end
end

local function always() return true end

---- rules ----

--- The rules of whose doc `has` is true; returns how many.
function M.rules(has)
  local rows = {}
  for _, rule in ipairs(core.rules()) do
    if has(rule.signature .. "\n" .. rule.doc) then
      rows[#rows + 1] = { rule.name, rule.doc:match "^.-%.%f[%s\0]" or rule.doc }
    end
  end
  write_rows("rules of dm.solver{ rule = }, ?name says more:", rows)
  return #rows
end

---- demonstrations ----

local function spoken(demo)
  local parts = { demo.title, demo.about }
  for _, step in ipairs(demo.steps) do parts[#parts + 1] = step[1] .. "\n" .. step[2] end
  return table.concat(parts, "\n")
end

--- The demonstrations of whose text `has` is true; returns how many.
function M.demos(has)
  local demo, rows = require "dm.session.demo", {}
  for _, name in ipairs(demo.names()) do
    local one = demo.find(name)
    if (has or always)(name .. "\n" .. spoken(one)) then rows[#rows + 1] = { name, one.title } end
  end
  write_rows('demonstrations, demo "name" runs one:', rows)
  return #rows
end

---- examples ----

--- The examples of whose text `has` is true; returns how many.
function M.examples(has)
  local rows = {}
  for _, name in ipairs(examples.names) do
    local whole = examples.text(name)
    if whole and (has or always)(name .. "\n" .. whole) then
      rows[#rows + 1] = { name, examples.title(examples.head(whole)) }
    end
  end
  local place = examples.file "name"
  write_rows(place and (
    "examples, ?name says more; dmlua %s . runs one and leaves its picture here:")
    :format(place) or "", rows)
  return #rows
end

---- failures ----

--- The codes of failures of whose text `has` is true; returns how many.
function M.failures(has)
  local rows = {}
  for _, row in ipairs(require "dm.session.failures") do
    if (has or always)(table.concat(row, "\n")) then rows[#rows + 1] = row end
  end
  write_rows("codes of a dm.failure, ?code says what to try:", rows)
  return #rows
end

--- ?name of a code, a demonstration or an example; returns whether it is one.
function M.about(name)
  for _, row in ipairs(require "dm.session.failures") do
    if row[1] == name then
      return true, write(row[1], ": ", row[2], "\n", text.wrapped(row[3], text.width(), "  "))
    end
  end
  local found = false
  for _, known in ipairs(require "dm.session.demo".names()) do
    if known == name then
      local demo = require "dm.session.demo".find(name)
      found = true
      write(demo.title, "\n", text.wrapped(demo.about, text.width(), "  "), '\n  demo "', name,
        '" runs it.')
    end
  end
  for _, known in ipairs(examples.names) do
    local whole = known == name and examples.text(name)
    if whole then
      found = true
      write("example ", name, "\n", text.wrapped(examples.head(whole), text.width(), "  "),
        ("\n  From a shell: dmlua %s . runs it and leaves its picture here.")
        :format(examples.file(name)))
    end
  end
  return found
end

---- apropos ----

local doc_apropos = [[
apropos(word)
List what mentions the word, capitals or not: documented names, rules, demonstrations, examples and
codes of failures, with how to open them.]]

local NAMES = 24  -- characters of their column

-- name and first sentence, in one line where it is to be `brief`
local function entry(doc, brief)
  local name, sentence = text.headline(doc)
  if sentence == "" then return name end
  local width, begins = text.width(), ("%-" .. NAMES .. "s  "):format(name)
  if brief then return begins .. cut(sentence, width - #begins) end
  return text.wrapped(sentence, width, (" "):rep(NAMES + 2), begins)
end

-- the docs of which `has` is true; returns how many
local function documented(has, brief)
  local lines = {}
  for line, doc in pairs(M.docs()) do
    -- core: for modules, not for sessions
    if not line:find "^core%." and has(doc) then
      lines[#lines + 1] = entry(doc, brief)
    end
  end
  if #lines > 0 then write(table.concat(text.sorted(lines), "\n")) end
  return #lines
end

-- what others call it -> what the docs say
local OTHER_WORDS = { damping = "friction", damped = "friction", dissipation = "friction",
  dissipative = "friction", drag = "friction", coulomb = "friction",
  adaptive = "eccentric", ["variable step"] = "eccentric", ["step size"] = "step h",
  ["time step"] = "step h", timestep = "step h",
  animation = "animate", movie = "animate", video = "animate", parallel = "threads",
  multithread = "threads", noise = "random", ["n-body"] = "bodies", nbody = "bodies",
  ["phase portrait"] = "plot", ["phase space"] = "plot", gyroscope = "rotation", graph = "plot",
  figure = "plot", picture = "plot", export = "csv",
  collision = "encounter", integrator = "rule", scheme = "rule", error = "drift",
  ["parallel transport"] = "holonomy", casimir = "coadjoint", stormer = "stoermer",
  ["generating function"] = "legendre transform",
  conserved = "noether", invariant = "noether", ["error message"] = "failure" }

-- and how it is written here
local CHAIN = "masses on springs are a chain: the examples ?chain, ?pendulum_chain; ?dm.sum_over"
local CHARGE = "a charge in a magnetic field is L = v:dot(v)/2 + v:dot(A(q)) - V(q), A its vector "
  .. "potential, which gauss(s), midpoint and others step: the examples ?charged_particle, "
  .. "?guiding_centre"
local SKATES = "what rolls or skates has rolling = beside L: the examples ?chaplygin_sleigh, "
  .. "?link_chain, ?rolling_disk"
local NOTEBOOKS = "dmlua --jupyter, in a shell, makes it a kernel of notebooks"
local PYTHON = "path:npy and path:csv write what others read; dmlua --where python is the folder "
  .. "of a module that reads it and calls emitted C; dmlua --jupyter makes a kernel of notebooks"
local ANGLES = "rotations are elements of dm.SO(3), which no angle describes: the examples "
  .. "?heavy_top, ?free_body"
local LIGHT = "light is a field of 1-forms, the vector potential, with L = V:dot(V)/2 - "
  .. "A:d():dot(A:d())/2: ?K.field, the example ?cavity"
local NONLINEAR = "it is dm.schroedinger with g =, the factor of |psi|^2 psi: the example ?soliton"
local WRITTEN = { maxwell = LIGHT, electromagnetic = LIGHT, electromagnetism = LIGHT,
  electrodynamics = LIGHT, yee = LIGHT, ["gross-pitaevskii"] = NONLINEAR, nls = NONLINEAR,
  jupyter = NOTEBOOKS, ipython = NOTEBOOKS, python = PYTHON, numpy = PYTHON,
  ["euler angles"] = ANGLES, fpu = CHAIN, fput = CHAIN, fermi = CHAIN, boris = CHARGE,
  lorentz = CHARGE, snake = SKATES, snakeboard = SKATES }

local PLAIN = { ["é"] = "e", ["è"] = "e", ["ö"] = "oe", ["ä"] = "ae", ["ü"] = "ue" }

-- everything of whose text `has` is true; returns how many
local function mentions(has, brief)
  return documented(has, brief) + M.rules(has) + M.demos(has) + M.examples(has) + M.failures(has)
end

local FEW = 8

local look_for  -- what apropos does

local LISTED = 3  -- names that have one last word

-- what is documented or has a name of its own, by its last word: "cross" -> { "v:cross" }
local function by_last_word()
  local out = {}
  local function add(word, name)
    out[word] = out[word] or {}
    table.insert(out[word], name)
  end
  for line in pairs(M.docs()) do
    local name = line:match "^[%a_][%w_.:]*"
    if name and not name:find "^core%." then add(name:match "[%w_]*$", name) end
  end
  for _, rule in ipairs(core.rules()) do add(rule.name, rule.name) end
  for _, name in ipairs(require "dm.session.demo".names()) do add(name, name) end
  for _, name in ipairs(examples.names) do add(name, name) end
  return out
end

-- names whose last word is nearly that of this one, joined, or nil; of a member those of its owner
-- first
local function nearest(word)
  local known, words = by_last_word(), {}
  for last in pairs(known) do words[#words + 1] = last end
  table.sort(words)
  local near = core.nearest(word:match "[^.:]*$", words)
  if not near then return nil end
  local owner, names = word:match "^(.+)[.:]", known[near]
  table.sort(names, function(a, b)
    local first, second = a:match "^(.-)[.:]" == owner, b:match "^(.-)[.:]" == owner
    if first ~= second then return first end
    return a < b
  end)
  return table.concat(names, ", ", 1, math.min(#names, owner and 1 or LISTED))
end

--- ?word of what has no doc: the first of the places that mention the word, and how many there are.
function M.first_mentions(word)
  local pattern = "%f[%w_]" .. word:lower():gsub("%p", "%%%0") .. "%f[^%w_]"
  local function has(what) return what:lower():find(pattern) end
  local found, count = text.collected(mentions, has, true)
  if count == 0 then return look_for(word) end
  local lines = {}
  for line in found:gmatch "[^\n]+" do lines[#lines + 1] = line end
  write(("%q has no doc of its own; it is mentioned in:"):format(word))
  for i = 1, math.min(#lines, FEW) do write(lines[i]) end
  if #lines > FEW then write(("and %d more lines: apropos %q"):format(#lines - FEW, word)) end
end

function look_for(word)
  if type(word) ~= "string" or word == "" then
    error(("apropos: a word is needed, apropos \"energy\" (got %s)")
      :format(word == "" and "none" or type(word)), 0)
  end
  local plain = word:gsub("[\xc3][\x80-\xbf]", PLAIN):lower()
  local function has(what) return what:lower():find(plain, 1, true) end
  if mentions(has) > 0 then return end
  local other = OTHER_WORDS[plain] or OTHER_WORDS[plain:match "^(.-)s?$"]
  if WRITTEN[plain] then
    return write(text.wrapped(("nothing mentions %q; "):format(word) .. WRITTEN[plain],
      text.width(), "  ", ""))
  end
  if other then
    write(("nothing mentions %q, but %q is spoken of:"):format(word, other))
    return mentions(function(what) return what:lower():find(other, 1, true) end)
  end
  local near = nearest(word)
  write(("nothing mentions %q; %s"):format(word, near and ("did you mean %s?"):format(near)
    or "?topics lists where to look"))
end

M.apropos = blame.caller(pager.paged(look_for))

docs[M.apropos] = doc_apropos

return M
