-- luarocks make .packaging/dmlua-0.1-1.rockspec, in the project's folder
package = "dmlua"
version = "0.1-1"
source = { url = "." }
description = {
  summary = "Discrete mechanics: Lagrangians in Lua, structure-preserving integrators in C",
  detailed = "An interpreter and a module dm for Lua 5.4. A Lagrangian is a Lua function; it is "
    .. "traced once and stepped by variational integrators in C.",
  license = "GPL-3.0-or-later",
}
dependencies = { "lua ~> 5.4" }
external_dependencies = { GSL = { header = "gsl/gsl_errno.h" } }
build = {
  type = "make",
  build_target = "all",
  install_target = "rock",
  install_variables = { BINDIR = "$(BINDIR)", LIBDIR = "$(LIBDIR)", LUADIR = "$(LUADIR)" },
}
