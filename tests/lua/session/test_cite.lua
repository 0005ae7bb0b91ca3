-- dm.cite: BibTeX behind every rule, and what else is asked for; the packages' own data
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

-- every entry has its kind, key, author, title, year; braces are balanced
local function is_bibtex(text)
  local depth, least = 0, 0
  for c in text:gsub("\\[{}]", ""):gmatch "[{}]" do
    depth = depth + (c == "{" and 1 or -1)
    least = math.min(least, depth)
  end
  for entry in (text .. "\n\n"):gmatch "(@.-)\n\n" do
    for _, field in ipairs { "author", "title", "year" } do
      if not entry:find("  " .. field .. " = {", 1, true) then return false end
    end
    if not entry:find "^@%a+{[%w-]+,\n" then return false end
  end
  return depth == 0 and least == 0 and text:find "^@" ~= nil
end

local missing = {}
for _, rule in ipairs(dm.rules()) do
  local fine, text = pcall(dm.cite, rule.name)
  if not fine or not is_bibtex(text) then missing[#missing + 1] = rule.name end
end
ok(#missing == 0, "every rule has its paper", table.concat(missing, " "))
local papers = require "dm.cite.papers"
local bad = {}
for _, key in ipairs(papers.keys) do
  if not is_bibtex(papers.bibtex(key)) then bad[#bad + 1] = key end
end
ok(#bad == 0 and #papers.keys > 40, "every entry is BibTeX", table.concat(bad, " "))
ok(dm.cite():find "dmlua", "dmlua itself")
ok(dm.cite "gauss(2)":find "year = {2006}", "a rule")
local both = dm.cite "kahan-li(6, midpoint)"
ok(both:find "kahan%-li%-1997" and both:find "marsden%-west", "a composition and its base")
local solver = dm.system { Q = dm.R(1), L = function(q, v) return v[1] ^ 2 / 2 - q[1] ^ 2 / 2 end }:solver { rule = "rattle", h = 0.1 }
ok(dm.cite(solver):find "andersen%-1983", "a solver")
ok(dm.cite(dm.moving_frame):find "fels%-olver" and dm.cite "system:routh":find "jalnapurkar", "functions and methods")
ok(dm.cite "action":find "fels%-olver", "actions")
raises("nothing is known", function() dm.cite "nono" end)
raises("nothing is known", function() dm.cite {} end)
raises("argument", function() dm.cite("gauss(2)", 3) end)

-- one version everywhere
local function text_of(name)
  local f <close> = assert(io.open(name))
  return f:read "a"
end
local version = text_of "Makefile":match "\nVERSION = (%S+)"
ok(text_of "docs/CITATION.cff":find('version: "' .. version .. '"', 1, true), "version of CITATION.cff")
ok(text_of ".packaging/debian/changelog":find("(" .. version .. ")", 1, true), "version of the Debian package")
ok(dm.cite():find("version = {" .. version .. "}", 1, true), "version of dm.cite")
local rock = {}
assert(load(text_of(".packaging/dmlua-" .. version .. "-1.rockspec"), "rockspec", "t", rock))()
ok(rock.version == version .. "-1", "version of the rock")

tap.done()
