#include "integ/method/rule.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *at; /* what is left of the text */
    dm_rule *nodes;
    int used;          /* of DM_RULE_NODES */
    const char *wrong; /* the first thing that is */
} reader;

/* Blanks may stand between all words and signs. */
static void skip_blanks(reader *r) {
    while (isspace((unsigned char)*r->at)) r->at++;
}

/* step over c when it comes next */
static int accept(reader *r, char c) {
    skip_blanks(r);
    if (*r->at != c) return 0;
    r->at++;
    return 1;
}

/* Only the first mistake is told: what follows may come of it. */
static void fail(reader *r, const char *sentence) {
    if (!r->wrong) r->wrong = sentence;
}

/* Letters of a name behind the first. */
static int is_name(char c) {
    return isalnum((unsigned char)c) || c == '_' || c == '-';
}

/* Into the node, which was zeroed: the name ends there. */
static void read_name(reader *r, dm_rule *rule) {
    size_t length = 0;
    skip_blanks(r);
    if (!isalpha((unsigned char)*r->at)) {
        fail(r, *r->at ? "the name of a rule must begin with a letter"
                       : "the name of a rule is missing");
        return;
    }
    while (is_name(r->at[length])) length++;
    if (length >= DM_RULE_NAME) {
        fail(r, "the name of a rule is longer than 31 letters");
        return;
    }
    memcpy(rule->name, r->at, length);
    r->at += length;
}

/* Decimal, finite, and no name behind it: 2x is no argument. */
static double read_number(reader *r) {
    char *end;
    const double number = strtod(r->at, &end);
    if (end == r->at || !isfinite(number) || is_name(*end))
        fail(r, "an argument must be a number or another rule");
    r->at = end;
    return number;
}

static const dm_rule *read_rule(reader *r);

/* A name begins a nested rule, anything else must be a number. */
static void read_argument(reader *r, dm_rule *rule) {
    skip_blanks(r);
    if (rule->count == DM_RULE_ARGS) {
        fail(r, "a rule has at most 4 arguments");
    } else if (*r->at == ',' || *r->at == ')' || *r->at == '\0') {
        fail(r, *r->at ? "an argument is missing" : "a closing parenthesis is missing");
    } else if (isalpha((unsigned char)*r->at)) {
        rule->arg[rule->count].rule = read_rule(r);
        rule->count++;
    } else {
        rule->arg[rule->count].number = read_number(r);
        rule->count++;
    }
}

/* Nodes are taken in the order of the text: the outermost is nodes[0]. */
static const dm_rule *read_rule(reader *r) {
    if (r->used == DM_RULE_NODES) {
        fail(r, "more than 8 rules are nested");
        return NULL;
    }
    dm_rule *rule = r->nodes + r->used++;
    *rule = (dm_rule){.count = 0};
    read_name(r, rule);
    if (r->wrong || !accept(r, '(')) return rule;
    do read_argument(r, rule);
    while (!r->wrong && accept(r, ','));
    if (!r->wrong && !accept(r, ')')) {
        skip_blanks(r);
        fail(r, *r->at ? "a comma or a closing parenthesis is missing"
                       : "a closing parenthesis is missing");
    }
    return rule;
}

/* Static sentences: nobody has to free what is told. */
const char *dm_rule_parse(dm_rule nodes[DM_RULE_NODES], const char *text) {
    reader r = {.at = text, .nodes = nodes};
    memset(nodes, 0, DM_RULE_NODES * sizeof *nodes); /* the names of unused ones are looked at */
    read_rule(&r);
    skip_blanks(&r);
    if (!r.wrong && *r.at)
        fail(&r, "there is something after the rule; its name is one word, and arguments "
                 "stand in "
                 "parentheses, as in gauss(2)");
    return r.wrong;
}
