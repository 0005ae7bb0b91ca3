// odeint FOLDER [KEY] - Boost odeint: fehlberg78 (fixed steps and error control) and McLachlan's
// symplectic Runge-Kutta-Nystroem methods
#include "forces.h"
#include "search.h"

#include <array>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/odeint/stepper/symplectic_rkn_sb3a_m4_mclachlan.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

namespace odeint = boost::numeric::odeint;

// one type per problem: dimension, length of time, start, acceleration
template <int tenths> struct Kepler {
    enum { n = 2, separable = 1 };
    static double T() { return 628.31853071795864769; }
    static void start(double *q, double *v) { kepler_start(q, v, tenths / 10.0); }
    static void force(double *a, const double *q, const double *) { kepler(a, q); }
    static void positions(double *) {}
};
struct Satellite {
    enum { n = 3, separable = 1 };
    static double T() { return 628.31853071795864769; }
    static void start(double *q, double *v) { satellite_start(q, v); }
    static void force(double *a, const double *q, const double *) { satellite(a, q); }
    static void positions(double *) {}
};
struct Planets {
    enum { n = 18, separable = 1 };
    static double T() { return 200000.0; }
    static void start(double *q, double *v) { planets_start(q, v); }
    static void force(double *a, const double *q, const double *) { planets(a, q); }
    static void positions(double *) {}
};
struct Pendulum {
    enum { n = 6, separable = 0 };
    static double T() { return 10.0; }
    static void start(double *q, double *v) { pendulum_start(q, v); }
    static void force(double *a, const double *q, const double *v) { pendulum(a, q, v); }
    static void positions(double *out) { pendulum_positions(out); }
};
template <int k> struct Spring {
    enum { n = 2, separable = 1 };
    static double T() { return 16.0; }
    static void start(double *q, double *v) { spring_start(q, v); }
    static void force(double *a, const double *q, const double *) { spring(a, q, k); }
    static void positions(double *) {}
};
template <int N> struct Toda {
    enum { n = N, separable = 1 };
    static double T() { return N > 100 ? 16.0 : 100.0; }
    static void start(double *q, double *v) { chain_start(q, v, N); }
    static void force(double *a, const double *q, const double *) { toda(a, q, N); }
    static void positions(double *) {}
};
template <int N> struct Fpu : Toda<N> {
    static void force(double *a, const double *q, const double *) { fpu(a, q, N); }
};

// no (q, v): seven numbers, of which the nine of an output are made
template <int top> struct Body {
    enum { n = 9, separable = 0 };
    static double T() { return 100.0; }
    static void start(double *y, double *) { body_start(y, top); }
    static void force(double *, const double *, const double *) {} // of no method that splits
    static void positions(double *) {}
};

// y = (q, v), steps of a general method
template <class P> struct Slope {
    typedef std::array<double, 2 * P::n> state;
    void operator()(const state &y, state &f, double) const {
        for (int i = 0; i < P::n; i++) f[i] = y[P::n + i];
        P::force(f.data() + P::n, y.data(), y.data() + P::n);
    }
};

template <int top> struct Slope<Body<top>> {
    typedef std::array<double, 7> state;
    void operator()(const state &y, state &f, double) const { body(f.data(), y.data(), top); }
};

template <class P> void put_row(double *out, const double *y, P) {
    for (int j = 0; j < P::n; j++) out[j] = y[j];
}
template <int top> void put_row(double *out, const double *y, Body<top>) { body_row(out, y); }

template <class P> void fixed(double *out, const bench_method *, long steps) {
    typedef typename Slope<P>::state state;
    odeint::runge_kutta_fehlberg78<state> stepper;
    const double row = P::T() / BENCH_OUTPUTS, h = row / double(steps);
    state y;
    P::start(y.data(), y.data() + P::n);
    for (int i = 0; i < BENCH_OUTPUTS; i++) {
        for (long k = 0; k < steps; k++)
            stepper.do_step(Slope<P>(), y, row * i + h * double(k), h);
        put_row(out + i * P::n, y.data(), P());
    }
    P::positions(out);
}

// error control at the tolerance 10^(-steps/16)
template <class P> void controlled(double *out, const bench_method *, long steps) {
    typedef typename Slope<P>::state state;
    typedef odeint::runge_kutta_fehlberg78<state> stepper;
    const double row = P::T() / BENCH_OUTPUTS,
                 tolerance = std::pow(10.0, -double(steps) / 16);
    auto control = odeint::make_controlled<stepper>(tolerance, tolerance);
    state y;
    P::start(y.data(), y.data() + P::n);
    for (int i = 0; i < BENCH_OUTPUTS; i++) {
        if (steps > 240)
            y.fill(NAN);
        else
            odeint::integrate_adaptive(control, Slope<P>(), y, row * i, row * (i + 1),
                                       row / 64);
        put_row(out + i * P::n, y.data(), P());
    }
    P::positions(out);
}

template <class P, template <class> class Method>
void symplectic(double *out, const bench_method *, long steps) {
    typedef std::array<double, P::n> half;
    Method<half> stepper;
    const double h = P::T() / BENCH_OUTPUTS / double(steps);
    std::pair<half, half> y;
    P::start(y.first.data(), y.second.data());
    auto force = [](const half &q, half &a) { P::force(a.data(), q.data(), nullptr); };
    for (int i = 0; i < BENCH_OUTPUTS; i++) {
        for (long k = 0; k < steps; k++) stepper.do_step(force, y, 0.0, h);
        for (int j = 0; j < P::n; j++) out[i * P::n + j] = y.first[j];
    }
}

template <class half> using Sb3a = odeint::symplectic_rkn_sb3a_mclachlan<half>;
template <class half> using Sb3aM4 = odeint::symplectic_rkn_sb3a_m4_mclachlan<half>;

template <class P> bench_problem problem(const char *key) {
    static const bench_method all[] = {
        {"odeint sb3a", symplectic<P, Sb3a>, nullptr, 0},
        {"odeint sb3a_m4", symplectic<P, Sb3aM4>, nullptr, 0},
        {"odeint fehlberg78, fixed step", fixed<P>, nullptr, 0},
        {"odeint fehlberg78", controlled<P>, nullptr, 0},
        {nullptr, nullptr, nullptr, 0}};
    return {key, P::n, P::separable ? all : all + 2};
}

int main(int argc, char **argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: odeint FOLDER [KEY]\n");
        return 2;
    }
    const bench_problem problems[] = {problem<Kepler<6>>("P1-0.6"),
                                      problem<Kepler<9>>("P1-0.9"),
                                      problem<Satellite>("P2"),
                                      problem<Planets>("P3"),
                                      problem<Pendulum>("P4"),
                                      problem<Body<0>>("P5-body"),
                                      problem<Body<1>>("P5-top"),
                                      problem<Spring<100>>("P6-1e2"),
                                      problem<Spring<10000>>("P6-1e4"),
                                      problem<Spring<1000000>>("P6-1e6"),
                                      problem<Toda<3>>("P8-toda-3"),
                                      problem<Toda<32>>("P8-toda-32"),
                                      problem<Toda<1024>>("P8-toda-1024"),
                                      problem<Fpu<3>>("P8-fpu-3"),
                                      problem<Fpu<32>>("P8-fpu-32"),
                                      problem<Fpu<1024>>("P8-fpu-1024"),
                                      {nullptr, 0, nullptr}};
    return bench_search("peer", problems, argv[1], argc > 2 ? argv[2] : "");
}
