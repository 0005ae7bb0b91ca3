--- The demonstrations, in the order in which they are best seen: each name is a file in this
-- folder.
return { "lagrangian", "noether", "symplectic", "order", "chart", "curve", "constraint", "rolling",
  "stiff", "chaos", "ensemble",
  "chain", "drift", "routh", "frame", "elastica", "stability", "scene" }
