--- What the codes of dm.failure mean and what to try, for ?failures and apropos. The codes are
-- those of src/base/status.h, then the reasons of reduced systems (reduce/run/failure.lua).
return {
  { "no_convergence", "the step equation did not converge",
    "Newton's method found no solution: the step is too long, or there is none. Take a smaller h; "
      .. "solver:fold says up to which step there is a solution." },
  { "singular", "the matrix of the step equation is singular",
    "d2L/dv2 or D1D2 Ld loses rank, or constraints depend on each other (failure.constraint, "
      .. ".rolling: which): a pole of the coordinates, a degenerate L, a singular configuration. "
      .. "solver:singularities finds such places." },
  { "not_finite", "a value became NaN or infinite",
    "The state left the domain of L or grew without bound: smaller h, another start. "
      .. "dm.stability_limit(rule) and system:linearize{q=} say where a rule grows." },
  { "inertia", "the step goes over a change of inertia of d2L/dv2",
    "A value of d2L/dv2 passes through zero, where the momentum no longer determines the velocity, "
      .. "or grows without bound: the motion ends. solver:singularities shows how it comes near." },
  { "callback", "a function of the script failed",
    "L, an event or a watched quantity raised, and the message is that of the function; or `next` "
      .. "of dm.step gave what cannot be a state, and the message says why." },
  { "stopped", "stopped on request", "Ctrl-C: what was computed is in failure.path." },
  { "no_memory", "not enough memory",
    "Record fewer rows: every =, rows =, watch = or file = of solver:run." },
  { "too_large", "the expression graph grew too large",
    "A traced function with too many operations: write a loop over bodies or sites as "
      .. "dm.sum_over, which stays a loop. Rules that take derivatives of derivatives (Taylor "
      .. "segments of dm.curve, degenerate(s)) grow with their order: take a lower one, or rk4." },
  { "no_native", "native code is not possible here",
    "The same bits come from the tape: leave backend = out, or set DMLUA_BACKEND=tape." },
  { "not_written", "a file could not be written",
    "Is the folder there, is the disk full? The path so far is in failure.path." },
  { "no_start", "the run could not start",
    "A member of an ensemble whose parameters (vary =) leave no equations of motion, or a start "
      .. "outside of the domain of L; the message says why." },
  { "out_of_time", "the seconds or steps allowed were over",
    "The run was given seconds =, or control = without at =, and its steps became shorter and "
      .. "shorter: more seconds, a larger tolerance; the path so far is in failure.path." },
  { "too_short", "the steps of controlled length became too short",
    "control = keeps no tolerance there, however short the step: a collision, a pole of the "
      .. "coordinates, a force too narrow to be seen, or a tolerance below the round-off of stiff "
      .. "forces. A larger tolerance, or another start; the path so far is in failure.path." },
  { "blow_up", "the energy has outgrown the start, of which nothing is left",
    "A field on a line beyond the limit of stability of its cells: field:stability_limit says up "
      .. "to which height of a slab they are stable; the run so far is in failure.path." },
  { "no_value", "a recorded column is NaN",
    "A function of watch =, record = or events = left its domain: dm.where(c, a, b) gives it a "
      .. "value there, gaps = true keeps NaN in columns; the rows before are in failure.path." },
  { "collapse", "a reduced system: the locked inertia vanishes there",
    "The shape comes near, or a step jumped over, one at which the group does not act freely (r = "
      .. "0): smaller steps there, or no reduction." },
  { "pole", "a reduced system: the mass of the shape vanishes there",
    "A pole of the coordinates: with constraint = in coordinates without one, or no section." },
  { "edge", "a reduced system: the mass of the shape grows without bound there",
    "An edge of the coordinates: with constraint = in coordinates without one, or another "
      .. "section." },
}
