-- the Lua files are for 5.4; dmlua preloads these globals
std = "lua54"
read_globals = { "dm", "help", "apropos", "who", "out" }
max_line_length = 120
files["examples"] = { globals = { "arg" } }
