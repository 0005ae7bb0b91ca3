/* names of rules: what is read, what is refused and with which words; the table of methods. */
#include "check.h"
#include "integ/method/method.h"
#include "integ/registry.h"

#include <string.h>

static void reads_names_and_arguments(void) {
    dm_rule nodes[DM_RULE_NODES];
    memset(nodes, 'x', sizeof nodes);
    CHECK(dm_rule_parse(nodes, "verlet") == NULL);
    CHECK(nodes[1].name[0] == 0 && nodes[DM_RULE_NODES - 1].name[0] == 0); /* unused */
    CHECK(strcmp(nodes[0].name, "verlet") == 0 && nodes[0].count == 0);
    CHECK(dm_rule_parse(nodes, " gauss ( 2 ) ") == NULL);
    CHECK(strcmp(nodes[0].name, "gauss") == 0 && nodes[0].count == 1);
    CHECK(nodes[0].arg[0].number == 2.0 && !nodes[0].arg[0].rule);
    CHECK(dm_rule_parse(nodes, "kahan-li(-1.5e1,.25)") == NULL);
    CHECK(nodes[0].arg[0].number == -15.0 && nodes[0].arg[1].number == 0.25);
}

static void reads_nested_rules(void) {
    dm_rule nodes[DM_RULE_NODES];
    CHECK(dm_rule_parse(nodes, "galerkin(3, lobatto(4), gauss)") == NULL);
    const dm_rule *lobatto = nodes[0].arg[1].rule, *gauss = nodes[0].arg[2].rule;
    CHECK(nodes[0].count == 3 && nodes[0].arg[0].number == 3.0);
    CHECK(lobatto && strcmp(lobatto->name, "lobatto") == 0 && lobatto->arg[0].number == 4.0);
    CHECK(gauss && strcmp(gauss->name, "gauss") == 0 && gauss->count == 0);
}

static void says_what_is_wrong(void) {
    static const struct {
        const char *text, *wrong;
    } cases[] = {
        {"", "the name of a rule is missing"},
        {"   ", "the name of a rule is missing"},
        {"2", "the name of a rule must begin with a letter"},
        {"(2)", "the name of a rule must begin with a letter"},
        {"gauss(", "a closing parenthesis is missing"},
        {"gauss(2", "a closing parenthesis is missing"},
        {"gauss(2,", "a closing parenthesis is missing"},
        {"gauss(2 3)", "a comma or a closing parenthesis is missing"},
        {"gauss()", "an argument is missing"},
        {"gauss(,2)", "an argument is missing"},
        {"gauss(2)x", "there is something after the rule; its name is one word, and "
                      "arguments stand in "
                      "parentheses, as in gauss(2)"},
        {"gauss 2", "there is something after the rule; its name is one word, and "
                    "arguments stand in "
                    "parentheses, as in gauss(2)"},
        {"gauss(*)", "an argument must be a number or another rule"},
        {"gauss(2x)", "an argument must be a number or another rule"},
        {"gauss(1e999)", "an argument must be a number or another rule"},
        {"a(1,2,3,4,5)", "a rule has at most 4 arguments"},
        {"a(b(c(d(e(f(g(h(i))))))))", "more than 8 rules are nested"},
        {"a_name_that_is_much_longer_than_allowed", "the name of a rule is longer than 31 letters"},
    };
    dm_rule nodes[DM_RULE_NODES];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *got = dm_rule_parse(nodes, cases[i].text);
        if (!CHECK(got && strcmp(got, cases[i].wrong) == 0))
            printf("# '%s': %s\n", cases[i].text, got ? got : "accepted");
    }
}

static void survives_any_bytes(void) {
    static const char letters[] = "ab(),(2.-e \x80\xff*";
    dm_rule nodes[DM_RULE_NODES];
    unsigned seed = 1;
    int refused = 0;
    for (int trial = 0; trial < 20000; trial++) {
        char text[24];
        for (size_t i = 0; i < sizeof text - 1; i++) {
            seed = seed * 1664525u + 1013904223u;
            text[i] = letters[(seed >> 16) % (sizeof letters - 1)];
        }
        text[sizeof text - 1] = '\0';
        refused += dm_rule_parse(nodes, text) != NULL;
    }
    CHECK(refused > 15000);
}

static void finds_every_method_and_the_nearest_name(void) {
    static const char *const wrong[][2] =
        {{"verlot", "verlet"},         {"Gauss", "gauss"},   {"mid-point", "midpoint"},
         {"labatto", "lobatto"},       {"rk8dp", "rk8pd"},   {"trapezoid", "trapezoidal"},
         {"leapfrog", "verlet"},       {"strang", "verlet"}, {"rk45", "rkf45"},
         {"euler", "symplectic-euler"}};
    for (const dm_method *const *m = dm_methods; *m; m++) {
        CHECK(dm_method_find((*m)->name, NULL) == *m);
        CHECK((*m)->doc && (*m)->signature && (*m)->orders && (*m)->stages && (*m)->cost);
        const dm_engine *e = (*m)->engine;
        CHECK((*m)->instances && e && e->wants && e->work && e->open && e->step);
        CHECK(strncmp((*m)->signature, (*m)->name, strlen((*m)->name)) == 0);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *nearest = NULL;
        CHECK(dm_method_find(wrong[i][0], &nearest) == NULL);
        CHECK(nearest && strcmp(nearest, wrong[i][1]) == 0);
    }
    const char *none = "verlet";
    CHECK(dm_method_find("foo", &none) == NULL && none == NULL);
}

/* 1 when the method refuses the arguments of this rule */
static int refuses(const char *text) {
    dm_rule nodes[DM_RULE_NODES];
    if (dm_rule_read(nodes, text, NULL)) return 0;
    const dm_method *m = dm_method_find(nodes[0].name, NULL);
    return m && dm_rule_check(nodes) != NULL;
}

static void methods_check_their_arguments(void) {
    static const char *const bad[] = {"gauss",
                                      "gauss(0)",
                                      "gauss(33)",
                                      "gauss(1.5)",
                                      "gauss(2,0)",
                                      "gauss(2,51)",
                                      "gauss(2,2,2)",
                                      "gauss(rk4)",
                                      "gauss(1e99)",
                                      "gauss(-1)",
                                      "lobatto(1)",
                                      "lobatto(33)",
                                      "lobatto",
                                      "verlet(2)",
                                      "midpoint(1)",
                                      "trapezoidal(1)",
                                      "del(1)",
                                      "rk4(4)",
                                      "yoshida(4, suzuki(3))",
                                      "suzuki(4, gauss(0))",
                                      "blanes-moan(4, midpoint)"};
    static const char *const good[] = {"gauss(1)",   "gauss(2,3)", "gauss(32)",
                                       "lobatto(2)", "verlet",     "del"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (!CHECK(refuses(bad[i]))) printf("# %s\n", bad[i]);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) CHECK(!refuses(good[i]));
}

int main(void) {
    RUN(reads_names_and_arguments, "reads names and arguments");
    RUN(reads_nested_rules, "reads nested rules");
    RUN(says_what_is_wrong, "says what is wrong with a text");
    RUN(survives_any_bytes, "survives any bytes");
    RUN(finds_every_method_and_the_nearest_name, "finds methods, and the nearest name");
    RUN(methods_check_their_arguments, "methods check their arguments");
    return check_finish();
}
