-- the Lua files are for 5.4; dmlua preloads these globals
std = "lua54"
read_globals = { "dm", "help", "apropos", "who", "out", "demo" }
max_line_length = false
unused_args = false -- L(q, v, t) names what it is given
ignore = { "4..", "512", "581", "311" } -- an inner q is another q; not (x < y) also holds for NaN; misuse is tested
files["tests/lua/value/test_missing_keys.lua"] = { ignore = { "113", "221" } } -- names that are not there
files["tests/lua/run/test_failures.lua"] = { ignore = { "113" } } -- a global that goes
files["examples"] = { globals = { "arg" } }
