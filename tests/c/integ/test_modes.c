/* eigenvectors of the coefficients of Gauss' rules, and complex systems of equations. */
#include "check.h"
#include "integ/phase/phase_modes.h"
#include "linalg/complex_lu.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

enum { MOST = 16, SIZE = 24 };

static dm_phase_modes modes_of(dm_quadrature *q, dm_stage_table *t, double *memory[2]) {
    dm_galerkin g = {.s = q->r};
    const size_t r = (size_t)q->r;
    dm_phase_modes m;
    dm_galerkin_collocation(&g, q);
    memory[0] = malloc(dm_stage_table_size(r, r) * sizeof **memory);
    memory[1] = malloc(dm_phase_modes_size((uint32_t)r) * sizeof **memory);
    dm_stage_table_fill(t, &g, memory[0]);
    dm_phase_modes_find(&m, t, memory[1]);
    return m;
}

/* x = (1 - z A)^-1 (1, 2, ...) by the eigenvectors: how far (1 - z A) x is off */
static double worst_of(const dm_phase_modes *m, const dm_stage_table *t, double z) {
    double x[MOST] = {0}, worst = 0.0;
    const uint32_t r = t->r;
    for (uint32_t i = 0; i < r; i++)
        for (uint32_t k = 0; k < m->count; k++) {
            const double complex value = m->value[2 * k] + m->value[2 * k + 1] * _Complex_I;
            double complex down = 0.0;
            for (uint32_t j = 0; j < r; j++) {
                const double *w = m->down + 2 * (k * r + j);
                down += (w[0] + w[1] * _Complex_I) * (j + 1.0);
            }
            const double *u = m->up + 2 * (k * r + i);
            const double complex up = u[0] + u[1] * _Complex_I;
            x[i] += (cimag(value) > 0.0 ? 2.0 : 1.0) * creal(up * down / (1.0 - z * value));
        }
    for (uint32_t i = 0; i < r; i++) {
        double rest = x[i] - (i + 1.0);
        for (uint32_t j = 0; j < r; j++) rest -= z * dm_weight_double(t->a[i * r + j]) * x[j];
        worst = fmax(worst, fabs(rest));
    }
    return worst;
}

static void gauss_falls_apart(void) {
    for (int r = 2; r <= MOST; r++) {
        dm_quadrature q;
        dm_stage_table t;
        double *memory[2];
        dm_quadrature_gauss(&q, r);
        const dm_phase_modes m = modes_of(&q, &t, memory);
        CHECK(m.count == (uint32_t)(r + 1) / 2);
        const double enough = 1e-14 * pow(6.0, r); /* vectors are the nearer to one another */
        CHECK_NEAR(worst_of(&m, &t, 0.7), 0.0, fmin(enough, 0.1));
        CHECK_NEAR(worst_of(&m, &t, -30.0), 0.0, fmin(30.0 * enough, 1.0));
        free(memory[0]);
        free(memory[1]);
    }
}

/* the eigenvalues of two stages are (3 +- i sqrt(3))/12 */
static void values_are_known(void) {
    dm_quadrature q;
    dm_stage_table t;
    double *memory[2];
    dm_quadrature_gauss(&q, 2);
    const dm_phase_modes m = modes_of(&q, &t, memory);
    CHECK_NEAR(m.value[0], 0.25, 1e-16);
    CHECK_NEAR(m.value[1], sqrt(3.0) / 12.0, 1e-16);
    free(memory[0]);
    free(memory[1]);
}

static void others_do_not(void) {
    for (int r = 2; r <= 6; r++) {
        dm_quadrature q;
        dm_stage_table t;
        double *memory[2];
        dm_quadrature_lobatto(&q, r);
        CHECK(modes_of(&q, &t, memory).count == 0);
        free(memory[0]);
        free(memory[1]);
        dm_quadrature_radau(&q, r);
        CHECK(modes_of(&q, &t, memory).count == 0);
        free(memory[0]);
        free(memory[1]);
    }
}

static uint64_t seed = 1;

/* uniform in [-1, 1) */
static double random_number(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

static void complex_systems(void) {
    double re[SIZE * SIZE], im[SIZE * SIZE], x[SIZE], y[SIZE];
    double complex A[SIZE * SIZE], b[SIZE];
    uint32_t pivot[SIZE];
    for (uint32_t n = 1; n <= SIZE; n++) {
        for (uint32_t k = 0; k < n * n; k++) {
            re[k] = random_number();
            im[k] = random_number();
            A[k] = re[k] + im[k] * _Complex_I;
        }
        if (n > 1) A[0] = re[0] = im[0] = 0.0; /* rows must change places */
        for (uint32_t k = 0; k < n; k++) {
            x[k] = random_number();
            y[k] = random_number();
            b[k] = x[k] + y[k] * _Complex_I;
        }
        CHECK(dm_complex_lu_factor(re, im, pivot, n) == DM_OK);
        dm_complex_lu_solve(x, y, re, im, pivot, n);
        for (uint32_t i = 0; i < n; i++) {
            double complex rest = -b[i];
            for (uint32_t j = 0; j < n; j++) rest += A[i * n + j] * (x[j] + y[j] * _Complex_I);
            CHECK_NEAR(cabs(rest), 0.0, 1e-12);
        }
    }
    re[0] = im[0] = 0.0;
    CHECK(dm_complex_lu_factor(re, im, pivot, 1) == DM_SINGULAR);
    im[0] = NAN;
    CHECK(dm_complex_lu_factor(re, im, pivot, 1) == DM_NOT_FINITE);
}

int main(void) {
    RUN(gauss_falls_apart, "I - z A of 2 to 16 stages is solved by its eigenvectors");
    RUN(values_are_known, "the eigenvalues of two stages");
    RUN(others_do_not, "coefficients that are not those of Gauss have none");
    RUN(complex_systems, "complex systems of 1 to 24 unknowns, singular and broken ones");
    return check_finish();
}
