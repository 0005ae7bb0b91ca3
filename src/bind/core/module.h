/* module.h - libraries that not everybody has: each is behind a shared object of its own, opened
 * when it is first asked for, so the core links none of them and starts as fast without. */
#ifndef DML_MODULE_H
#define DML_MODULE_H

enum { DML_WHY = 300 };

/* The table `symbol` of dm/<name>.so, or NULL, why[] then being a sentence that names the packages
 * as Debian calls them. It is looked for beside core.so, or where the program and its core are
 * built and installed; it stays open until the program ends, its libraries hidden from other
 * modules. DMLUA_<NAME>=no does without it. */
const void *dml_module(const char *name, const char *symbol, const char *packages,
                       char why[DML_WHY]);

#endif
