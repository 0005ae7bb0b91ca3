-- the Lua files are for 5.4; dmlua preloads these globals
std = "lua54"
read_globals = { "dm", "help", "apropos", "who", "out" }
max_line_length = 130
unused_args = false -- L(q, v, t) names what it is given
ignore = { "4.." } -- an inner q is another q
files["examples"] = { globals = { "arg" } }
