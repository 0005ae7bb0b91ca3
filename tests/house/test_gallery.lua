-- The gallery of charts: every example has its place in it, with a rival that preserves nothing, and what the page names is there.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local core = require "dm.core"

local geometric = {}
for _, row in ipairs(core.rules()) do geometric[row.name] = row.symplectic end

local page = house.read "docs/charts.md"
local missing, alone, unknown, unshown = {}, {}, {}, {}
for _, file in ipairs(house.files "^examples/.*%.lua$") do
  local name = file:match "([%w_]+)%.lua$"
  local place = "tests/bench/gallery/" .. name .. ".lua"
  local chunk = loadfile(place)
  if not chunk then
    if not require "exceptions".charts[name] then missing[#missing + 1] = name end
  else
    local entry, rival = chunk(), false
    for _, options in ipairs(entry) do
      for _, rule in ipairs(options.rules) do
        local fine, why = pcall(function() return options[1]:solver { rule = rule, h = options.h[#options.h] } end)
        if not fine then unknown[#unknown + 1] = ("%s, %s: %s"):format(name, rule, why) end
        rival = rival or geometric[rule:match "^[%w-]+"] == false
      end
    end
    if not rival then alone[#alone + 1] = name end
    local picture = io.open("docs/images/chart-" .. name .. ".png")
    if not (page:find(entry.title, 1, true) and picture) then unshown[#unshown + 1] = name end
    if picture then picture:close() end
  end
end
house.check("every example of rules has a chart in tests/bench/gallery", missing)
house.check("every rule of a chart can be had", unknown)
house.check("every chart has a rival that preserves nothing", alone)
house.check("docs/charts.md, made by `make charts`, shows them all", unshown)
house.finish()
