-- The floors of the house, from the ground up: a folder asks only folders that stand before it
-- here, by the symbols of the objects and by #include (C), by require (Lua). So there is no cycle,
-- neither between folders nor between the rooms of the first level with all that is in them. A new
-- folder gets its place here.
local floors = {}

floors.src = {
  "base", "numbers", "linalg", "linalg/solve", "linalg/sparse", "sparse", "graph", "algebra",
  "code", "code/implicit", "code/tape", "code/native", "code/loops", "level",
  "geom", "geom/action", "chain", "mech", "dec", "dec/homology",
  "dec/named", "dec/levi_civita", "dec/transfer", "delaunay",
  "field/avi", "field/flow", "field/line",
  "integ/method", "integ/split", "integ/constrained", "integ/stage/workspace", "integ/stage/sweep",
  "integ/phase", "integ/stage/lanes", "integ/stage",
  "integ/rules/explicit", "integ/curve", "integ/rules", "integ/rules/compositions",
  "integ/multiscale", "integ/trial", "integ/sem", "integ/lie", "integ",
  "wave", "fft",
  "run/inertia", "run", "run/ensemble",
  "mpi",
  "bind/core", "bind/value", "bind/trace", "bind/model", "bind/dec", "bind/field", "bind/line", "bind/rule",
  "bind/trial", "bind/wave", "bind/run", "bind/ensemble", "bind/avi", "bind/sem", "bind/sweep",
  "bind",
  "cli",
}

floors.lua = {
  "base", "group/trivialization", "group", "group/methods", "group/own", "group/discrete", "action", "frame", "frame/calculus", "connection", "show", "show/animate", "data",
  "wave", "wave/pictures", "elements",
  "dec/files", "dec", "dec/homology", "dec/equations", "dec/curvature", "dec/fields",
  "dec/flow", "dec/pictures",
  "dec/dynamics", "line", "mpi", "sweep", "reference",
  "chart", "measure", "sem", "trial", "stability",
  "reduce/routh", "reduce/discrete", "reduce/equilibria", "reduce/run", "reduce/lagrange_poincare", "reduce/mechanical",
  "reduce", "scene", "demos/line", "demos", "session/transcripts", "session", "notebook",
  "cite",
}

-- Arrows that point up nevertheless: how it is seen, from, to, why. One that is no longer needed
-- fails.
floors.up = {
}

return floors
