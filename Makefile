# dmlua - see README.md. Everything that is built goes to build/.
CC ?= cc
CFLAGS ?= -O2 -g
WARN = -std=c17 -Wall -Wextra -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Werror
# no contraction: every backend must give the same bits
FLOAT = -ffp-contract=off
B = build
KERNEL = $(sort $(wildcard $(addprefix src/,$(addsuffix /*.c,base linalg solve expr geom action mech integ run))))
BIND = $(sort $(wildcard src/bind/*.c))
CLI = $(sort $(wildcard src/cli/*.c))
objects = $(patsubst src/%.c,$(B)/%.o,$(1))
LUA_CFLAGS := $(shell pkg-config --cflags lua5.4 2>/dev/null)
LUA_LIBS := $(shell pkg-config --libs lua5.4 2>/dev/null)
GSL_LIBS := $(shell pkg-config --libs gsl 2>/dev/null)

all: $(B)/dmlua
$(B)/%.o: src/%.c
	@mkdir -p $(@D)
	$(CC) $(WARN) $(CFLAGS) $(FLOAT) -fPIC -MMD -Isrc $(if $(filter bind/% cli/%,$*),$(LUA_CFLAGS)) -D_POSIX_C_SOURCE=200809L -c $< -o $@
$(B)/libdm.a: $(call objects,$(KERNEL))
	rm -f $@; ar rcs $@ $^
$(B)/dmlua: $(call objects,$(CLI) $(BIND)) $(B)/libdm.a
	$(CC) $(CFLAGS) -rdynamic -o $@ $^ $(LUA_LIBS) $(GSL_LIBS) -lreadline -lm
$(B)/tests/%: tests/c/%.c $(B)/libdm.a
	@mkdir -p $(@D)
	$(CC) $(WARN) $(CFLAGS) $(FLOAT) -Isrc -Itests/c $< $(B)/libdm.a $(GSL_LIBS) -lm -o $@
-include $(shell find $(B) -name '*.d' 2>/dev/null)
