/*
** interrupt [ROUNDS] - sends SIGINT at random moments to a dmlua that runs a busy script. It must
** end by itself with exit code 0 or 1, or by that very signal when it came before the handler stood
** or came twice; never by another signal, and never hang.
*/
#define _DEFAULT_SOURCE
#include "check.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static int rounds = 60;
static unsigned seed = 12345;

static unsigned below(unsigned n) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % n;
}

static void nap(unsigned milliseconds) {
    const struct timespec t = {.tv_sec = milliseconds / 1000,
                               .tv_nsec = 1000000L * (milliseconds % 1000)};
    nanosleep(&t, NULL);
}

static pid_t start(const char *dmlua, const char *script) {
    const pid_t child = fork();
    if (child == 0) {
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
            _exit(9);
        execl(dmlua, dmlua, script, (char *)NULL);
        _exit(9);
    }
    return child;
}

/* wait status of the child; after `limit` ms it is killed, which the caller sees as SIGKILL */
static int end_of(pid_t child, unsigned limit) {
    int status = 0;
    for (unsigned waited = 0; waitpid(child, &status, WNOHANG) == 0; waited += 5) {
        if (waited > limit) kill(child, SIGKILL);
        nap(5);
    }
    return status;
}

static void random_moments(void) {
    const char *dmlua = getenv("DMLUA");
    long ended = 0, by_signal = 0;
    for (int i = 0; i < rounds; i++) {
        const pid_t child = start(dmlua ? dmlua : "build/dmlua", "tests/lua/busy.lua");
        const unsigned signals = 1 + below(2), moment = below(200);
        nap(moment);
        kill(child, SIGINT);
        if (signals == 2) nap(below(3)), kill(child, SIGINT);
        const int status = end_of(child, 20000);
        const int fine = (WIFEXITED(status) && WEXITSTATUS(status) <= 1) ||
                         (WIFSIGNALED(status) && WTERMSIG(status) == SIGINT &&
                          (signals == 2 || moment < 50));
        if (!CHECK(fine))
            printf("# round %d, %u signals after %u ms: wait status %d\n", i, signals,
                   moment, status);
        if (WIFEXITED(status))
            ended++;
        else
            by_signal++;
    }
    printf("# %d rounds: %ld ended by themselves, %ld by the signal\n", rounds, ended,
           by_signal);
}

int main(int argc, char **argv) {
    if (argc > 1) rounds = atoi(argv[1]);
    RUN(random_moments, "Ctrl-C at random moments ends a script in order");
    return check_finish();
}
