/* pty PROGRAM ARGUMENT ... - runs a program on a terminal of 80 x 24 and plays the lines of stdin:
 *   send TEXT    type it; \r \t \e \\ and \ooo are escapes
 *   wait TEXT    until the output since the last match has it; after two minutes: exit code 3
 *   pause MS
 * At the end the terminal is read until the program has ended (two minutes at most); then the whole output
 * is printed, and a line "exit N" or "signal N". */
#define _DEFAULT_SOURCE
#define _XOPEN_SOURCE 700

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PATIENCE = 120000, ROOM = 1 << 20 };

static int terminal;
static pid_t child;
static char output[ROOM];
static size_t length, matched; /* what is before `matched` has been waited for */

static long now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (long)t.tv_sec * 1000 + (long)t.tv_nsec / 1000000;
}

/* print what came, and how the program ended; it is killed when the script went wrong */
static void finish(int code) {
    int status = 0;
    if (code) kill(child, SIGKILL);
    waitpid(child, &status, 0);
    fwrite(output, 1, length, stdout);
    if (WIFSIGNALED(status))
        printf("\nsignal %d\n", WTERMSIG(status));
    else
        printf("\nexit %d\n", WEXITSTATUS(status));
    fflush(stdout);
    exit(code);
}

/* on the child's side: the terminal becomes its controlling one */
static void become(char **command) {
    const struct winsize size = {.ws_row = 24, .ws_col = 80};
    setsid();
    const int fd = open(ptsname(terminal), O_RDWR);
    if (fd < 0) _exit(9);
    ioctl(fd, TIOCSWINSZ, &size);
    dup2(fd, 0), dup2(fd, 1), dup2(fd, 2);
    close(terminal);
    execvp(command[0], command);
    _exit(9);
}

static int start(char **command) {
    terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || grantpt(terminal) || unlockpt(terminal)) return 0;
    child = fork();
    if (child == 0) become(command);
    return child > 0;
}

/* read what there is for at most `ms`; 0 when the terminal is closed */
static int listen(long ms) {
    struct pollfd input = {.fd = terminal, .events = POLLIN};
    if (poll(&input, 1, (int)ms) <= 0) return 1;
    const ssize_t n = read(terminal, output + length, ROOM - 1 - length);
    if (n <= 0) return 0;
    length += (size_t)n;
    output[length] = '\0';
    return 1;
}

/* escapes of `text` in place; its length */
static size_t unescape(char *text) {
    char *out = text;
    for (char *in = text; *in; in++) {
        if (*in != '\\' || !in[1]) {
            *out++ = *in;
            continue;
        }
        in++;
        if (*in >= '0' && *in <= '7') {
            char *end;
            char digits[4] = {in[0], in[1], in[1] ? in[2] : '\0', '\0'};
            *out++ = (char)strtol(digits, &end, 8);
            in += end - digits - 1;
        } else {
            *out++ = (char)(*in == 'r' ? '\r' : *in == 't' ? '\t' : *in == 'e' ? 27 : *in);
        }
    }
    *out = '\0';
    return (size_t)(out - text);
}

static void wait_for(const char *text) {
    const long until = now() + PATIENCE;
    const char *found;
    while (!(found = strstr(output + matched, text))) {
        if (now() > until || !listen(100)) {
            printf("no '%s' came in:\n", text);
            finish(3);
        }
    }
    matched = (size_t)(found - output) + strlen(text);
}

static void play(char *line) {
    line[strcspn(line, "\n")] = '\0';
    char *text = line + 5;
    if (strncmp(line, "send ", 5) == 0) {
        const size_t n = unescape(text);
        if (write(terminal, text, n) != (ssize_t)n) finish(4);
    } else if (strncmp(line, "wait ", 5) == 0) {
        unescape(text);
        wait_for(text);
    } else if (strncmp(line, "pause ", 6) == 0) {
        for (const long until = now() + atol(line + 6); now() < until;) listen(10);
    } else {
        printf("no command: %s\n", line);
        finish(5);
    }
}

int main(int argc, char **argv) {
    char line[4096];
    if (argc < 2 || !start(argv + 1)) return 2;
    while (fgets(line, sizeof line, stdin)) {
        if (*line != '\n') play(line);
    }
    const long until = now() + PATIENCE;
    while (listen(100)) {
        if (now() > until) finish(6);
    }
    finish(0);
}
