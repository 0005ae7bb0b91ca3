-- What the house checks let pass, and why.
return {
  -- calls of a kernel object: object, symbol, why
  calls = {
    { "run/ensemble/ensemble", "pthread_create", "members are shared out to threads" },
    { "run/ensemble/ensemble", "pthread_join", "and waited for" },
    { "chain/team", "pthread_create", "the threads of a step" },
    { "chain/team", "pthread_join", "and their end" },
    { "chain/team", "pthread_mutex_init", "they sleep between bursts" },
    { "chain/team", "pthread_mutex_destroy", "they sleep between bursts" },
    { "chain/team", "pthread_mutex_lock", "they sleep between bursts" },
    { "chain/team", "pthread_mutex_unlock", "they sleep between bursts" },
    { "chain/team", "pthread_cond_init", "they sleep between bursts" },
    { "chain/team", "pthread_cond_destroy", "they sleep between bursts" },
    { "chain/team", "pthread_cond_wait", "they sleep between bursts" },
    { "chain/team", "pthread_cond_signal", "they sleep between bursts" },
    { "chain/team", "pthread_cond_broadcast", "they sleep between bursts" },
    { "chain/team", "sched_yield", "at a barrier" },
    { "code/native/code_memory", "mmap", "native code lives in pages of its own" },
    { "code/native/code_memory", "mprotect", "which are written first, then executed" },
    { "code/native/code_memory", "munmap", "and given back" },
    { "sparse/blas_stop", "dlsym", "the BLAS behind the one that looks at stop" },
  },
  -- functions over the limit: file, name, lines, why
  functions = {
    { "src/code/tape/tape.c", "engine", 76, "the loop of the tape: one label per operation" },
  },
  -- files over the limit of length: file, "long", why
  files = {
  },
  -- examples without a chart of rules: name, why
  charts = {
    game_loop = "a deadline, which charts do not know",
    porous_hole = "an equation on a mesh, no rule of time",
    falling_cat = "loops of shapes, no rule of time",
    foucault = "loops of a sphere, no rule of time",
    three_rotors = "loops of shapes; rules on groups are compared in docs/benchmarks/groups.md",
    locked_formation = "controllers, one rule",
    mesh_curvature = "angles of a mesh, no rule of time",
    kinks = "cells of space and time, no rule of systems",
    free_knots = "a least energy, no rule of time",
    cavity = "frequencies on a mesh, no rule of time",
    torus_fields = "forms on a mesh, no rule of time",
    heat_sphere = "modes of a mesh, exact in time",
    escape = "one rule, many members, the potential of henon_heiles",
    bounded_but_wrong = "one rule beside the truth; kepler has the chart",
    tunnel = "a wave, which charts do not know",
    soliton = "a wave, which charts do not know",
    rough_rod = "elements on an interval, no rule of time",
    two_scales = "curves that are fitted, no rule of time",
    potential = "forms on a mesh, no rule of time",
    free_body = "closed forms by rules on groups, which docs/benchmarks/groups.md compares",
    heavy_top = "closed forms by rules on groups, which docs/benchmarks/groups.md compares",
    hante_top = "three ways to write a body down, with orders in its picture",
    gravity_gradient = "closed forms by rules on groups, which docs/benchmarks/groups.md compares",
    two_bodies = "closed forms by rules on groups, which docs/benchmarks/groups.md compares",
    underwater = "closed forms by rules on groups, which docs/benchmarks/groups.md compares",
    link_chain = "lie(s) alone knows constraints on groups",
    turntable = "lie(s) alone knows rolling on groups; orders in its picture",
    chaplygin_sphere = "lie(s) alone knows rolling on groups",
    suslov = "lie(s) alone knows rolling on groups; orders in its picture",
    tilted_disk = "lie(s) alone knows rolling on groups",
    own_forces = "forces of one discrete Lagrangian, no rules of the table",
    taylor_segments = "methods of the script, no rules of the table",
    slack_rope = "a force that is read off a run; how well rules know it is in its picture",
    sliding_plate = "what a symmetry keeps, asked of one rule",
    runge_lenz = "one discrete Lagrangian and its invariantization, no rules of the table",
    elastica = "a variational problem in invariants, stepped by dm.invariant_problem",
    schwarzian = "a variational problem in invariants, stepped by dm.invariant_problem",
    space_elastica = "a variational problem in invariants, stepped by dm.invariant_problem",
  },
  -- types of one name: file, name, why
  types = {
  },
  -- decisions by the name of a rule or a group: file, names, why
  decisions = {
    { "src/bind/run/bind_path.c", "sem", "path.sem is a field: what became of the energy" },
  },
}
