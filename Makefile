# dmlua - see README.md. Everything that is built goes to $(B); `make help` lists the targets.
B = build
CC ?= cc
CFLAGS ?= -O2 -g
READLINE = yes
READLINE_LIBS = -lreadline
PREFIX = /usr/local
DESTDIR =
WARN = -std=c17 -Wall -Wextra -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Werror
# no contraction: every backend must give the same bits
FLOAT = -ffp-contract=off
VERSION = 0.1

# the files of a pattern in a folder and all below it
below = $(sort $(wildcard $(foreach stars,/ /*/ /*/*/ /*/*/*/,$(addsuffix $(stars)$(2),$(1)))))
BIND = $(call below,src/bind,*.c)
CLI = $(call below,src/cli,*.c)
SPARSE = $(call below,src/sparse,*.c)
DELAUNAY = $(call below,src/delaunay,*.c)
FFT = $(call below,src/fft,*.c)
MPI = $(call below,src/mpi,*.c)
KERNEL = $(filter-out $(BIND) $(CLI) $(SPARSE) $(DELAUNAY) $(FFT) $(MPI),$(call below,src,*.c))
LUA_FILES = $(call below,lua/dm,*.lua)
EXAMPLES = $(sort $(wildcard examples/*.lua))
C_SOURCES = $(KERNEL) $(BIND) $(CLI) $(if $(SPARSE_LIBS),$(SPARSE)) $(if $(QHULL_LIBS),$(DELAUNAY)) \
  $(if $(FFTW_LIBS),$(FFT)) \
  $(call below,tests/c,*.c)
comma = ,
objects = $(patsubst src/%.c,$(B)/%.o,$(1))
export B

all: $(B)/dmlua $(B)/dm/core.so modules $(B)/modules.luac

# what the machine offers: made by .ci/setup, which installs what is missing for these goals,
# after which make reads this file again
INSTALLING = demo test setup san tsan valgrind bench docs
QUIET_GOALS = clean help format uninstall
ifneq ($(or $(filter-out $(QUIET_GOALS),$(MAKECMDGOALS)),$(if $(MAKECMDGOALS),,all)),)
include $(B)/config.mk
endif
INSTALL_MISSING = $(if $(filter $(INSTALLING),$(MAKECMDGOALS)),--install)
$(B)/config.mk: .ci/setup
	@mkdir -p $(B)
	@CC="$(CC)" READLINE=$(READLINE) .ci/setup $(INSTALL_MISSING) build >$@.new && mv $@.new $@
setup: $(B)/config.mk
	@.ci/setup --install pictures test

# one short line a file; V=1 shows the commands
say = $(if $(V),,@printf '  %-4s %s\n' $(1) $(2);)

# objects are made again when the compiler or its flags change
COMPILE = $(CC) $(WARN) $(CFLAGS) $(FLOAT) -fPIC -MMD -MP -Isrc -D_POSIX_C_SOURCE=200809L
READLINE_FLAGS = $(if $(filter yes,$(READLINE)),-DDM_READLINE,-UDM_READLINE)
# what asks Lua calls it through its address: math.sqrt takes 1.16 of lua5.4's time, not 1.21
CALLS_LUA = -fno-plt $(LUA_CFLAGS)
SAME = $(COMPILE) $(CALLS_LUA) $(LUA_LIBS) $(SPARSE_LIBS) $(QHULL_LIBS) $(FFTW_LIBS)$(LANES)
$(B)/flags: now = $(SAME)
$(B)/readline: now = $(READLINE_FLAGS) $(VERSION)
$(B)/flags $(B)/readline: always
	@mkdir -p $(B)
	@echo '$(now)' | cmp -s - $@ || echo '$(now)' >$@
$(call objects,$(CLI)): $(B)/readline
$(B)/%.o: src/%.c $(B)/flags
	@mkdir -p $(@D)
	$(call say,cc,$<)$(COMPILE) $(if $(findstring lanes,$*),$(LANES)) $(if $(filter bind/% cli/%,$*),$(CALLS_LUA)) \
	  $(if $(filter cli/%,$*),$(READLINE_FLAGS) -DDM_VERSION='"$(VERSION)"') -c $< -o $@

$(B)/libdm.a: $(call objects,$(KERNEL))
	@rm -f $@
	$(call say,ar,$@)ar rcs $@ $^
# the interpreter looks for ../lua and ../../lua beside its own folder
$(B)/dmlua: $(call objects,$(CLI) $(BIND)) $(B)/libdm.a
	@[ -e $(B)/../lua/dm ] || [ -e $(B)/../../lua/dm ] || ln -sfn $(CURDIR)/lua $(B)/../lua
	$(call say,link,$@)$(CC) $(CFLAGS) $(LDFLAGS) -rdynamic -o $@ $^ $(LUA_LIBS) $(GSL_LIBS) $(if $(filter yes,$(READLINE)),$(READLINE_LIBS)) -lm
# the modules in Lua, compiled: the interpreter reads them faster, and does without them as well, as
# where another machine is built for
compiled = $(B)/dmlua -e 'require "dm.session.compiled".write("$(1)", "$(LUA_FILES)"$(2))' || \
  echo "modules are read as texts"
$(B)/modules.luac: $(B)/dmlua $(LUA_FILES)
	$(call say,lua,$@)$(call compiled,$@)
# for a stock lua5.4, which brings the lua_ functions itself
$(B)/dm/core.so: $(call objects,$(BIND)) $(B)/libdm.a
	@mkdir -p $(@D)
	$(call say,link,$@)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-z,now -o $@ $^ $(GSL_LIBS) -lm

# modules of libraries that not everybody has: the core opens them at first use
modules: $(if $(SPARSE_LIBS),$(B)/dm/sparse.so) $(if $(QHULL_LIBS),$(B)/dm/delaunay.so) \
  $(if $(FFTW_LIBS),$(B)/dm/fft.so)
$(B)/dm/sparse.so: $(call objects,$(SPARSE)) $(B)/libdm.a
	@mkdir -p $(@D)
	$(call say,link,$@)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-z,now -o $@ $^ $(SPARSE_LIBS) -lm
$(B)/dm/delaunay.so: $(call objects,$(DELAUNAY)) $(B)/libdm.a
	@mkdir -p $(@D)
	$(call say,link,$@)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-z,now -o $@ $^ $(QHULL_LIBS) -lm

$(B)/dm/fft.so: $(call objects,$(FFT)) $(B)/libdm.a
	@mkdir -p $(@D)
	$(call say,link,$@)$(CC) $(CFLAGS) -shared -Wl,-z,now -o $@ $^ $(FFTW_LIBS) -lm

# for runs under mpirun, asked for by name: `make mpi`
mpi: all $(B)/dm/mpi.so
MPICC = mpicc
$(B)/dm/mpi.so: $(MPI) src/mpi/ranks.h
	@.ci/setup $(if $(filter mpi,$(MAKECMDGOALS)),--install) mpi
	@mkdir -p $(@D)
	$(call say,link,$@)OMPI_CC="$(CC)" $(MPICC) $(WARN) $(CFLAGS) $(FLOAT) -fPIC -Isrc -shared -o $@ $(MPI) -ldl

# tests/c/test_*.c know only libdm.a; the other programs there drive an interpreter
C_TESTS = $(patsubst tests/c/%.c,$(B)/tests/%,$(call below,tests/c,test_*.c))
DRIVERS = $(patsubst tests/c/%.c,$(B)/tests/%,$(sort $(wildcard tests/c/*.c)))
STATE_TESTS = $(addprefix $(B)/tests/,refuse interrupt)
LUA_TESTS = $(call below,tests/lua,test_*.lua)
HOUSE_TESTS = $(sort $(wildcard tests/house/test_*.lua))
$(C_TESTS): $(B)/tests/%: tests/c/%.c $(B)/libdm.a
	@mkdir -p $(@D)
	$(call say,cc,$<)$(COMPILE) -Itests/c $< $(B)/libdm.a $(GSL_LIBS) -lm -o $@
# they read modules as dmlua does
DRIVEN = $(call objects,$(BIND) src/cli/compiled.c)
$(DRIVERS): $(B)/tests/%: tests/c/%.c $(DRIVEN) $(B)/libdm.a
	@mkdir -p $(@D)
	$(call say,cc,$<)$(COMPILE) -Itests/c $(LUA_CFLAGS) $< $(DRIVEN) $(B)/libdm.a $(LUA_LIBS) $(GSL_LIBS) -lm -o $@

programs: all $(C_TESTS) $(DRIVERS)
# long ones first, so that no core waits for the last
TEST_FILES = $(EXAMPLES) $(STATE_TESTS) $(C_TESTS) $(LUA_TESTS)
test: programs
	@.ci/setup --install pictures test
	@tests/run $(HOUSE_TESTS) $(TEST_FILES)
house: all
	@tests/run $(HOUSE_TESTS)
# what another compiler may change: the kernels, and the steps that scripts make with them; and what
# tries random models, of which SAMPLES=1 are all
SAMPLED = $(shell grep -ls 'tap[.]samples' $(LUA_TESTS))
steps: programs
	@tests/run $(C_TESTS) $(sort $(SAMPLED) \
	  $(foreach room,rule run inertia ensemble,$(call below,tests/lua/$(room),test_*.lua)))

demo: all
	@.ci/setup --install pictures
	@tests/demo $(EXAMPLES)

# null pointers, ends of objects and addresses that wrap are what the address sanitizer sees, too
# (sums of pointers that are looked at make a factorization of 72 rows 3 times as slow, and a third
# of what compiling takes); lines, for its stacks, are all of the debug data that is wanted
SAN = -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined \
  -fno-sanitize=null,object-size,pointer-overflow -fno-sanitize-recover=all
# lanes call what looks at addresses: in line it takes twice as long to compile, and runs no faster
SAN_LANES = $(if $(findstring clang,$(CC)),-mllvm -,--param )asan-instrumentation-with-call-threshold=0
san:
	+@$(MAKE) --no-print-directory B=$(B)/san CFLAGS="$(SAN)" LANES="$(SAN_LANES)" sanitized
# without the examples, which show what the tests try
sanitized: programs
	@UNDER=san tests/run $(STATE_TESTS) $(C_TESTS) $(LUA_TESTS)
TSAN = -O1 -g -fno-omit-frame-pointer -fsanitize=thread
THREADS = $(shell grep -ls threads $(LUA_TESTS))
tsan:
	+@$(MAKE) --no-print-directory B=$(B)/tsan CFLAGS="$(TSAN)" threaded
threaded: programs
	@UNDER=tsan setarch -R tests/run $(THREADS)
valgrind: programs
	@.ci/setup --install valgrind test
	@UNDER=valgrind tests/run $(C_TESTS) $(LUA_TESTS)
bench: programs
	@tests/bench/run
# docs/benchmarks/drifts.md; DRIFTS = steps a start and rows, as "1e6 Kepler"
DRIFTS =
drifts: all
	@for level in plain fma avx512; do \
	  DMLUA_PROCESSOR=$$level nice $(B)/dmlua tests/bench/dm/long_runs.lua $(DRIFTS); done
	@$(CC) -O2 -o $(B)/drifts tests/bench/c/by_hand/drifts.c -lm && nice $(B)/drifts

format:
	clang-format -i $(foreach tree,src tests,$(call below,$(tree),*.[ch]))
lint: $(B)/config.mk
	@.ci/lint $(C_SOURCES) -- $(LUA_CFLAGS)

docs: all
	@mkdir -p docs/completion docs/images docs/meta
	$(B)/dmlua -e 'require "dm.session.man".write "docs"' \
	  -e 'assert(io.open("docs/reference.md", "w")):write(require "dm.session.reference".text(dm))' \
	  -e 'require "dm.session.meta".write "docs/meta"'
	for example in $(EXAMPLES); do $(B)/dmlua $$example docs/images >/dev/null || exit 1; done

# the gallery of work-precision charts, measured again: two minutes of a quiet machine
charts: all
	@.ci/setup --install pictures
	$(B)/dmlua tests/bench/dm/charts.lua docs $(sort $(wildcard tests/bench/gallery/*.lua))

# the docs for a browser, in $(B)/site
site: all
	@.ci/setup --install pictures site
	$(B)/dmlua docs/site/build.lua $(B)/site
	$(B)/dmlua docs/site/check.lua $(B)/site

SHARE = $(DESTDIR)$(PREFIX)/share
install: all
	@install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/lua/5.4/dm $(SHARE)/dmlua/lua/dm \
	  $(SHARE)/dmlua/examples $(SHARE)/lua/5.4 $(SHARE)/man/man1 \
	  $(SHARE)/bash-completion/completions $(SHARE)/zsh/site-functions \
	  $(SHARE)/fish/vendor_completions.d $(SHARE)/pkgconfig
	install -m 755 $(B)/dmlua $(DESTDIR)$(PREFIX)/bin/dmlua
	install -m 755 $(wildcard $(B)/dm/*.so) $(DESTDIR)$(PREFIX)/lib/lua/5.4/dm
	@for file in $(LUA_FILES); do install -D -m 644 $$file $(SHARE)/dmlua/$$file || exit 1; done
	@install -d $(DESTDIR)$(PREFIX)/lib/dmlua
	$(call compiled,$(DESTDIR)$(PREFIX)/lib/dmlua/modules.luac,$(comma) "$(PREFIX)/bin/../share/dmlua/lua")
	install -D -m 644 -t $(SHARE)/dmlua/lua/python $(wildcard lua/python/*.py)
	install -D -m 644 -t $(SHARE)/dmlua/meta docs/meta/dm.lua
	install -m 644 $(EXAMPLES) $(SHARE)/dmlua/examples
	@ln -sfn ../../dmlua/lua/dm $(SHARE)/lua/5.4/dm
	install -m 644 docs/dmlua.1 $(SHARE)/man/man1/dmlua.1
	install -m 644 docs/completion/dmlua.bash $(SHARE)/bash-completion/completions/dmlua
	install -m 644 docs/completion/_dmlua $(SHARE)/zsh/site-functions/_dmlua
	install -m 644 docs/completion/dmlua.fish $(SHARE)/fish/vendor_completions.d/dmlua.fish
	sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' .packaging/dmlua.pc >$(SHARE)/pkgconfig/dmlua.pc
uninstall:
	rm -rf $(SHARE)/dmlua $(DESTDIR)$(PREFIX)/lib/dmlua $(DESTDIR)$(PREFIX)/lib/lua/5.4/dm
	rm -f $(DESTDIR)$(PREFIX)/bin/dmlua $(SHARE)/lua/5.4/dm $(SHARE)/man/man1/dmlua.1 \
	  $(SHARE)/bash-completion/completions/dmlua $(SHARE)/zsh/site-functions/_dmlua \
	  $(SHARE)/fish/vendor_completions.d/dmlua.fish $(SHARE)/pkgconfig/dmlua.pc

# for luarocks, which says where its folders are
rock: all
	@install -d $(BINDIR) $(LIBDIR)/dm
	install -m 755 $(B)/dmlua $(BINDIR)/dmlua
	install -m 755 $(wildcard $(B)/dm/*.so) $(LIBDIR)/dm
	@for file in $(LUA_FILES); do install -D -m 644 $$file $(LUADIR)/$${file#lua/} || exit 1; done

# a Debian package in $(B)/deb, from a copy of the tree; it runs the tests unless
# DEB_BUILD_OPTIONS=nocheck; lintian must have nothing to say against it
DEB = $(B)/deb/dmlua-$(VERSION)
deb:
	@.ci/setup --install deb
	@rm -rf $(B)/deb && mkdir -p $(DEB)
	@tar cf - --exclude=./build --exclude=./.git . | tar xf - -C $(DEB)
	@cp -r .packaging/debian $(DEB)
	cd $(DEB) && unset MAKEFLAGS MAKELEVEL B && dpkg-buildpackage -us -uc -b
	lintian --fail-on error,warning $(B)/deb/*.changes

clean:
	rm -rf $(B)

help:
	@echo "make            build $(B)/dmlua and $(B)/dm/core.so (for stock lua5.4)"
	@echo "make setup      install what is missing (Debian and its kin; elsewhere: say what)"
	@echo "make demo       set up, build, run examples/ and leave their pictures in $(B)/pictures"
	@echo "make test       set up, build, run every test; the last line counts them"
	@echo "make san        the tests under the address and undefined-behaviour sanitizers"
	@echo "make tsan       the tests of threads under the thread sanitizer"
	@echo "make valgrind   the tests under valgrind"
	@echo "make house      only the checks of structure: floors, symbols, docs, sizes"
	@echo "make bench      measured times"
	@echo "make drifts     slopes of momentum and energy over long runs (hours; DRIFTS=1e5)"
	@echo "make charts     measure the gallery of docs/charts.md again"
	@echo "make docs       write docs/reference.md, the man page and the completions again"
	@echo "make format, make lint"
	@echo "make install, make uninstall   PREFIX=$(PREFIX) DESTDIR="
	@echo "make site       the docs as pages for a browser in $(B)/site"
	@echo "make deb        a Debian package in $(B)/deb"
	@echo "make clean"
	@echo "options: CC=clang  CFLAGS='$(CFLAGS)'  READLINE=no  B=folder  V=1 (show commands)  SAMPLES=1 (tests try all)"

.PHONY: all modules setup programs test house steps demo san sanitized tsan threaded valgrind bench drifts charts format lint docs \
  install uninstall rock deb site clean help always
-include $(shell find $(B) -name '*.d' -type f -not -path '$(B)/san/*' -not -path '$(B)/tsan/*' -not -path '$(B)/deb/*' 2>/dev/null)
