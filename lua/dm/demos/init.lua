--- The demonstrations, in the order in which they are best seen: each name is a file of this room.
return { "lagrangian", "noether", "symplectic", "order", "chart", "curve", "constraint", "rolling",
  "stiff", "scales", "sem", "chaos", "ensemble", "chain", "drift", "routh", "frame", "elastica",
  "stability", "wrong", "scene", "top", "polhode", "holonomy", "forms", "holes", "sweep", "waves",
  "fields" }
