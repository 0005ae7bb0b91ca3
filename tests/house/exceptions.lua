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
    { "src/expr/tape.c", "engine", 76, "the loop of the tape: one label per operation" },
  },
}
