/* bound FOLDER [KEY]: search every hand-written method on the problems whose key begins with KEY */
#include "bound.h"

#include <stdio.h>

int main(int argc, char **argv) {
    const bench_problem *all[] = {bench_kepler, bench_satellite, bench_planets, bench_pendulum,
                                  bench_body,   bench_spring,    bench_chain};
    if (argc < 2) {
        fprintf(stderr, "usage: bound FOLDER [KEY]\n");
        return 2;
    }
    bench_make_splittings();
    bench_make_gauss();
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (bench_search("bound", all[i], argv[1], argc > 2 ? argv[2] : "")) return 1;
    return 0;
}
