-- What the kernels call, read from their objects: nothing that allocates, prints, exits, jumps or
-- knows Lua.  What they export is named dm_, what the bindings export dml_.
package.path = "tests/house/?.lua;" .. package.path
local house = require "house"
local tree = require "tree"

-- calls that the kernels may make besides each other and besides GSL
local allowed = {}
for name in ([[
  sin cos tan asin acos atan atan2 sinh cosh tanh exp expm1 log log1p log10 log2 sqrt cbrt pow fabs fmax fmin
  fmod floor ceil round trunc lround copysign ldexp frexp frexpl hypot fma nextafter sincos modf
  memcpy memset memmove memcmp bcmp strcmp strncmp strlen strchr strcpy strstr qsort snprintf vsnprintf strtod strtol
  memchr sinl cosl sincosl fabsl sqrtl fmaxl cabsl __mulxc3 __divxc3 __isoc99_sscanf __ctype_b_loc __ctype_tolower_loc
  __assert_fail __stack_chk_fail _GLOBAL_OFFSET_TABLE_ clock_gettime
  __cpu_indicator_init __cpu_model __cpu_features2
]]):gmatch "%S+" do allowed[name] = true end
-- exceptions: object, symbol, why
local exceptions = {}
for _, row in ipairs(require "exceptions".calls) do exceptions[row[1] .. " " .. row[2]] = row[3] end

local rows = tree.symbols(".", house.build)
local function room(row) return row[1]:match "^[^/]+" end
local function kernel(row) return room(row) ~= "bind" and room(row) ~= "cli" end
-- what src/sparse, src/fft and src/delaunay, modules of their own, call besides: their libraries, and the
-- file in memory that qhull writes its errors to
local function of_library(row)
  if room(row) == "delaunay" then
    return row[3]:find "^qh_" or row[3] == "fmemopen" or row[3] == "fclose"
  end
  if room(row) == "fft" then return row[3]:find "^fftw_" end
  return room(row) == "sparse"
    and (row[3]:find "^cholmod_" or row[3]:find "^umfpack_di_" or row[3]:find "^ds[ae]upd_c$"
      or row[3]:find "^omp_" or row[3] == "SuiteSparse_config" or row[3] == "__tls_get_addr")
end

local defined, n_defined = {}, 0
for _, row in ipairs(rows) do
  if kernel(row) and not tree.asks(row) then defined[row[3]], n_defined = true, n_defined + 1 end
end

local calls, used = {}, {}
for _, row in ipairs(rows) do
  local object, name = row[1], row[3]
  if kernel(row) and tree.asks(row) and not defined[name] and not allowed[name] and not name:find "^gsl_"
    and not name:find "^__%w*san_" and not of_library(row) then
    local key = object .. " " .. name
    used[key] = true
    if not exceptions[key] then calls[#calls + 1] = object .. ".c calls " .. name end
  end
end

-- what is exported is named with a prefix of its floor
local function misnamed(which, ...)
  local list = {}
  for _, row in ipairs(rows) do
    if which(row) and row[2]:find "%u" and not tree.asks(row) then
      local fine = row[3]:find "^__" or row[3] == "main"
      for _, prefix in ipairs { ... } do fine = fine or row[3]:find("^" .. prefix) end
      if not fine then list[#list + 1] = ("%s of %s.c"):format(row[3], row[1]) end
    end
  end
  return list
end

local unused = {}
for key, why in pairs(exceptions) do
  if not used[key] then unused[#unused + 1] = key .. ": " .. why end
end
house.check("there are objects to look at", n_defined > 300 and {} or { n_defined .. " symbols" })
if house.under == "" then
  house.check("the kernels allocate, print, exit, jump and know Lua nowhere", calls)
  house.check("every exception to that is needed", unused)
end
house.check("the kernels export only dm_ names", misnamed(kernel, "dm_"))
house.check("the bindings export only dml_ names", misnamed(function(row) return not kernel(row) end, "dml_", "DML_", "luaopen_dm"))
house.finish()
