-- What the kernels call, read from their objects: nothing that allocates, prints, exits, jumps or
-- knows Lua.  What they export is named dm_, what the bindings export dml_.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"

-- calls that the kernels may make besides each other and besides GSL
local allowed = {}
for name in ([[
  sin cos tan asin acos atan atan2 sinh cosh tanh exp expm1 log log1p log10 log2 sqrt cbrt pow fabs fmax fmin
  fmod floor ceil round trunc lround copysign ldexp frexp hypot fma nextafter sincos modf
  memcpy memset memmove memcmp bcmp strcmp strncmp strlen strchr strcpy strstr qsort snprintf vsnprintf strtod strtol
  memchr sinl cosl sincosl fabsl sqrtl __isoc99_sscanf __ctype_b_loc __ctype_tolower_loc
  __assert_fail __stack_chk_fail _GLOBAL_OFFSET_TABLE_ clock_gettime
  __cpu_indicator_init __cpu_model __cpu_features2
]]):gmatch "%S+" do allowed[name] = true end
-- exceptions: object, symbol, why
local exceptions = {}
for _, row in ipairs(require "exceptions".calls) do exceptions[row[1] .. " " .. row[2]] = row[3] end

local library = house.build .. "/libdm.a"
local defined = {}
for _, line in ipairs(house.lines("nm -g --defined-only " .. library)) do
  local name = line:match "^%x+ %u (%S+)$"
  if name then defined[name] = true end
end

local calls, object, used = {}, "", {}
for _, line in ipairs(house.lines("nm -u " .. library)) do
  object = line:match "^(%S+)%.o:$" or object
  local name = line:match "^%s+[Uw] (%S+)$"
  if name and not defined[name] and not allowed[name] and not name:find "^gsl_" and not name:find "^__%w*san_" then
    local key = object .. " " .. name
    used[key] = true
    if not exceptions[key] then calls[#calls + 1] = object .. ".c calls " .. name end
  end
end

local function misnamed(files, ...)
  local list = {}
  for _, line in ipairs(house.lines("nm -g --defined-only " .. files)) do
    local name = line:match "^%x+ %u (%S+)$"
    local fine = not name or name:find "^__" or name == "main"
    for _, prefix in ipairs { ... } do fine = fine or name:find("^" .. prefix) end
    if not fine then list[#list + 1] = name end
  end
  return list
end

local unused = {}
for key, why in pairs(exceptions) do
  if not used[key] then unused[#unused + 1] = key .. ": " .. why end
end
house.check("there is a library to look at", next(defined) and {} or { library })
if house.under == "" then
  house.check("the kernels allocate, print, exit, jump and know Lua nowhere", calls)
  house.check("every exception to that is needed", unused)
end
house.check("the kernels export only dm_ names", misnamed(library, "dm_"))
house.check("the bindings export only dml_ names", misnamed(house.build .. "/bind/*.o", "dml_", "DML_", "luaopen_dm"))
house.finish()
