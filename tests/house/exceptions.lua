-- What the house checks let pass, and why.
return {
  -- calls of a kernel object: object, symbol, why
  calls = {
    { "ensemble", "pthread_create", "members of an ensemble are shared out to threads" },
    { "ensemble", "pthread_join", "and waited for" },
    { "code_memory", "mmap", "native code lives in pages of its own" },
    { "code_memory", "mprotect", "which are written first, then executed" },
    { "code_memory", "munmap", "and given back" },
  },
  -- functions over the limit: file, name, lines, why
  functions = {
    { "src/code/tape/tape.c", "engine", 76, "the loop of the tape: one label per operation" },
  },
  -- examples without a chart of rules: name, why
  charts = {
    slack_rope = "a force that is read off a run; how well rules know it is in its picture",
    sliding_plate = "what a symmetry keeps, asked of one rule",
    runge_lenz = "one discrete Lagrangian and its invariantization, no rules of the table",
    elastica = "a variational problem in invariants, stepped by dm.invariant_problem",
    schwarzian = "a variational problem in invariants, stepped by dm.invariant_problem",
    space_elastica = "a variational problem in invariants, stepped by dm.invariant_problem",
  },
}
