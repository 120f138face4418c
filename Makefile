# Tosui: one Makefile, no recursion but for the set-up.
#   make         build the three programs into build/bin; MPI=1: sphsolve-mpi too
#   make help    what else there is
BUILD ?= build
# The same folder by its full name is the same build: nothing is made again.
override BUILD := $(patsubst $(CURDIR)/%,%,$(BUILD))
PREFIX ?= /usr/local
# Two names to make, of which `clean` and `uninstall` would remove both.
$(foreach n,BUILD PREFIX DESTDIR,$(if $(word 2,$($(n))),$(error $(n)="$($(n))": make takes no name with a space in it)))
MPI ?= 0
V ?= 0
Q := $(if $(filter 1,$(V)),,@)
# One goal is built on all processors; several are made one after another, as they were asked for.
ifeq ($(word 2,$(MAKECMDGOALS))$(findstring -j,$(MAKEFLAGS)),)
MAKEFLAGS += --jobs=$(shell nproc)
endif
say = $(if $(filter 1,$(V)),,@printf '  %-8s %s\n' $(1) $(2))

CC = gcc
CXX = g++
OPT ?= -O3 -g1
WARN = -Werror=implicit-function-declaration -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Wvla
WARNXX = -Wall -Wextra -Wshadow
SANITIZE ?=
# Errno and traps of libm are never looked at; values stay exactly IEEE (no fast-math), and no
# operation is fused behind our back but in the variants that say so (ISA_FLAGS).
MATH = -fno-math-errno -fno-trapping-math -ffp-contract=off
CFLAGS_ALL = -std=gnu11 $(OPT) $(MATH) -fopenmp $(WARN) -I. -I$(BUILD) $(DEP_CFLAGS) $(SANITIZE) $(CFLAGS)
CXXFLAGS_ALL = -std=c++17 $(OPT) -fopenmp $(WARNXX) -I. -isystem /usr/include/opencv4 $(SANITIZE) $(CXXFLAGS)
LDFLAGS_ALL = -fopenmp $(SANITIZE) $(LDFLAGS)

MODULES = ct2model sphsolve analyze
PROGRAMS = $(foreach p,$(MODULES),$(if $(wildcard $(p)/$(p).c),$(p)))
SOURCES_common = $(sort $(wildcard common/*.c))
SOURCES_ct2model = $(sort $(foreach e,c cc,$(wildcard ct2model/*.$(e) ct2model/*/*.$(e))))
# The pair loops of wcsph are one source, compiled for each kernel and each instruction set: for all, but in make check,
# where MPI=1 does not ask for the whole, for this machine's alone and for those that are there already.
PAIR_SOURCE = sphsolve/wcsph/engine/pair_loops.c
PAIR_HEADERS = $(wildcard sphsolve/wcsph/kernels/*.h)
ISA_NAMES = baseline avx2 avx512
ISA_HERE = $(or $(shell grep -m1 '^flags' /proc/cpuinfo | awk '{ for (i = 1; i <= NF; i++) f[$$i] = 1 } \
  END { print f["avx512f"] && f["avx512vl"] && f["avx512dq"] && f["avx512bw"] ? "avx512" : f["avx2"] && f["fma"] ? "avx2" : "baseline" }'),baseline)
ISA_THERE = $(foreach i,$(ISA_NAMES),$(if $(wildcard $(patsubst %.h,$(BUILD)/obj/%.$(i).c.o,$(firstword $(PAIR_HEADERS)))),$(i)))
ISAS := $(if $(filter check/0,$(MAKECMDGOALS)/$(MPI)),$(sort $(ISA_HERE) $(ISA_THERE)),all)
override ISAS := $(if $(filter all,$(ISAS)),$(ISA_NAMES),$(filter $(ISA_NAMES),$(ISAS)))
ISA_MASK = $(if $(filter baseline,$(ISAS)),1,0)$(if $(filter avx2,$(ISAS)),+2)$(if $(filter avx512,$(ISAS)),+4)
PAIR_LOOPS = $(foreach k,$(PAIR_HEADERS),$(foreach i,$(ISAS),$(k:.h=.$(i).c)))
SOURCES_sphsolve = $(sort $(filter-out $(PAIR_SOURCE),$(wildcard sphsolve/*.c sphsolve/*/*.c sphsolve/*/*/*.c)) $(PAIR_LOOPS))
SOURCES_analyze = $(sort $(wildcard analyze/*.c analyze/*/*.c))
SOURCES_generator = $(sort $(wildcard data-samples/*.c))
SOURCES_unit = $(sort $(wildcard tests/unit/test_*.c))
SOURCES_long = $(sort $(wildcard tests/verify/verify_*.c tests/hard/hard_*.c tests/bench/bench_*.c))

object = $(patsubst %,$(BUILD)/obj/%.o,$(1))
main_of = $(BUILD)/obj/$(1)/$(1).c.o
library = $(BUILD)/lib/lib$(1).a
LIBRARIES = $(call library,ct2model) $(call library,sphsolve) $(call library,analyze) $(call library,common)
LIBS_OPENCV = -lopencv_photo -lopencv_imgproc -lopencv_core -lstdc++
BINARIES = $(PROGRAMS:%=$(BUILD)/bin/%) $(if $(filter 1,$(MPI)),$(BUILD)/bin/sphsolve-mpi) $(if $(SOURCES_generator),$(BUILD)/bin/generate_sand)
UNIT_TESTS = $(patsubst tests/unit/%.c,$(BUILD)/tests/%,$(SOURCES_unit))
LONG_TESTS = $(foreach s,$(SOURCES_long),$(BUILD)/tests/$(basename $(notdir $(s))))

.PHONY: help scan-quality package fuzz all check long demo debug deps s06 m15 scans verify tradeoff hard scenes bench clean install uninstall lint format format-check asan ubsan tsan valgrind coverage dist tests
all: $(BINARIES) ## the programs, in build/bin; with MPI=1 sphsolve-mpi, too
# Every target with a line of its own below, `target: ... ## what it does`.
help: ## this list
	@sed -n 's/^\([a-z0-9.][a-z0-9_.-]*\):.*## \(.*\)/  make \1|\2/p' Makefile | awk -F'|' '{ printf "%-30s %s\n", $$1, $$2 }'
	@echo 'Variables: MPI=1 (sphsolve-mpi, and the tests of ranks), T="NAME ..." (of check and long: these files of tests alone,'
	@echo '  as T=resume), V=1 (commands in full), BUILD=FOLDER, OPT=FLAGS, PREFIX=FOLDER'

# ---- set-up: pkg-config is asked once; make demo and make check install what is missing first ----
NEEDS_NOTHING = help clean format format-check debug deps dist uninstall package asan ubsan tsan
INSTALLS = $(filter demo check long s06 m15 scans verify tradeoff hard scenes bench,$(MAKECMDGOALS))
PACKAGES = hdf5-serial libtiff-4 libpng libconfig jansson libxxhash
# HDF5 from its archive where there is one: Debian's shared library loads curl, Kerberos and GnuTLS with it, and a program
# that needs none of them takes four times as long to start.
HDF5_ARCHIVE = if test -e "$$(pkg-config --libs-only-L hdf5-serial | sed 's/^-L//; s/ *$$//')/libhdf5.a"; then sed 's/-lhdf5\b/-l:libhdf5.a -lsz -ldl/'; else cat; fi
ifneq ($(filter-out $(NEEDS_NOTHING),$(or $(MAKECMDGOALS),all)),)
-include $(BUILD)/config.mk $(if $(filter 1,$(MPI)),$(BUILD)/config-mpi.mk)
endif
$(BUILD)/config.mk: Makefile scripts/install-deps
	$(Q)scripts/install-deps $(if $(INSTALLS),,--check)
	$(Q)mkdir -p $(@D)
	$(Q)printf 'DEP_CFLAGS = %s\nDEP_LIBS = %s -lm -lz -lpthread\n' "$$(pkg-config --cflags $(PACKAGES))" \
	  "$$(pkg-config --libs $(PACKAGES) | $(HDF5_ARCHIVE))" > $@
# sphsolve-mpi takes parallel HDF5 instead; the headers of libraries are not ours to be warned about.
MPI_PACKAGES = hdf5-openmpi ompi-c PETSc $(filter-out hdf5-serial,$(PACKAGES))
$(BUILD)/config-mpi.mk: Makefile scripts/install-deps
	$(Q)scripts/install-deps $(if $(INSTALLS),,--check) --mpi
	$(Q)mkdir -p $(@D)
	$(Q)printf 'MPI_CFLAGS = %s\nMPI_LIBS = %s -lm -lz -lpthread\n' \
	  "$$(pkg-config --cflags $(MPI_PACKAGES) | sed 's/-I/-isystem /g') -isystem /usr/include/trilinos" \
	  "$$(pkg-config --libs $(MPI_PACKAGES)) -ltrilinos_zoltan" > $@
deps: ## install what is built and tested with
	scripts/install-deps $(if $(filter 1,$(MPI)),--mpi)

# ---- a changed flag rebuilds what it concerns ----
FLAGS_NOW = $(CC) $(CXX) $(CFLAGS_ALL) $(CXXFLAGS_ALL) $(LDFLAGS_ALL) $(DEP_LIBS)
$(BUILD)/flags: FORCE
	@mkdir -p $(@D); echo '$(FLAGS_NOW)' | cmp -s - $@ || echo '$(FLAGS_NOW)' > $@
FORCE:
.PHONY: FORCE

# ---- compile ----
# Of an object: its instruction set and, of pair loops, its kernel (sphsolve/wcsph/kernels/KERNEL.ISA.c.o).
isa_flags = $(if $(findstring .avx512.,$(1)),-ffp-contract=fast -mavx512f -mavx512vl -mavx512dq -mavx512bw -mavx2 -mfma -mprefer-vector-width=512)$(if $(findstring .avx2.,$(1)),-ffp-contract=fast -mavx2 -mfma) $(if $(findstring wcsph/kernels/,$(1)),-include sphsolve/wcsph/kernels/$(firstword $(subst ., ,$(notdir $(1)))).h)$(if $(findstring engine/pairs.,$(1)),-DPAIR_ISAS="($(ISA_MASK))")
ISA_FLAGS = $(call isa_flags,$@)
# Unit tests themselves are not what takes long to run, but half of their compiler's time.
TEST_FLAGS = $(if $(filter $(BUILD)/obj/tests/unit/%,$@),$(if $(findstring -O3,$(OPT)),-O1))
define compile
	$(call say,CC,$*.c)
	$(Q)mkdir -p $(@D) && $(CC) $(CFLAGS_ALL) $(TEST_FLAGS) $(ISA_FLAGS) -MMD -MP -c $< -o $@
endef
$(BUILD)/obj/%.c.o: %.c $(BUILD)/flags
	$(compile)
$(BUILD)/obj/sphsolve/wcsph/kernels/%.c.o: $(PAIR_SOURCE) $(BUILD)/flags
	$(compile)
$(BUILD)/isas: FORCE
	@mkdir -p $(@D); echo '$(ISAS)' | cmp -s - $@ || echo '$(ISAS)' > $@
$(BUILD)/obj/sphsolve/wcsph/engine/pairs.c.o $(BUILD)/fuzz/obj/sphsolve/wcsph/engine/pairs.o: $(BUILD)/isas
$(BUILD)/obj/%.cc.o: %.cc $(BUILD)/flags
	$(call say,CXX,$<)
	$(Q)mkdir -p $(@D) && $(CXX) $(CXXFLAGS_ALL) -MMD -MP -c $< -o $@
-include $(shell test -d $(BUILD)/obj && find $(BUILD)/obj -name '*.d')
.PRECIOUS: $(BUILD)/obj/%.c.o $(BUILD)/obj-mpi/%.c.o

# What editors and clang's tools ask for.
compile_entry = {"directory": "$(CURDIR)", "file": "$(2)", "command": "$(CC) $(CFLAGS_ALL) $(call isa_flags,$(call object,$(1))) -c $(2) -o $(call object,$(1))"}
COMPILED = $(filter %.c,$(foreach p,common $(MODULES) generator unit long,$(SOURCES_$(p))))
comma := ,
compile_commands.json: Makefile $(BUILD)/config.mk ## how each file is compiled, for editors
	$(file >$@,[)$(foreach s,$(COMPILED),$(file >>$@,$(call compile_entry,$(s),$(if $(filter $(s),$(PAIR_LOOPS)),$(PAIR_SOURCE),$(s)))$(if $(filter $(s),$(lastword $(COMPILED))),,$(comma))))$(file >>$@,])
	$(call say,WROTE,$@)

# ---- what pages are made of: their styles and scripts, and Debian's libraries, empty where absent ----
JAVASCRIPT = /usr/share/javascript
PAGE = $(addprefix common/page,.css _charts.js _maps.js _scan.js) $(addprefix $(JAVASCRIPT)/dygraphs/dygraph.min,.js .css)
ASSETS_analyze = $(PAGE) $(addprefix analyze/report/page,.html .js _solid.js _words.js) $(addprefix $(JAVASCRIPT)/three/,three.min.js examples/js/controls/OrbitControls.js)
ASSETS_ct2model = $(PAGE) $(addprefix ct2model/survey_page.,html js)
define asset_rule
$(BUILD)/assets/$(notdir $(1)): $(wildcard $(1))
	$$(Q)mkdir -p $$(@D) && { cat $$^ /dev/null; } > $$@
endef
$(foreach a,$(sort $(ASSETS_analyze) $(ASSETS_ct2model)),$(eval $(call asset_rule,$(a))))
PAGES = $(addprefix $(BUILD)/obj/,analyze/report/page.c.o ct2model/survey_page.c.o)
$(word 1,$(PAGES)): $(foreach a,$(ASSETS_analyze),$(BUILD)/assets/$(notdir $(a)))
$(word 2,$(PAGES)) $(BUILD)/fuzz/obj/ct2model/survey_page.o: $(foreach a,$(ASSETS_ct2model),$(BUILD)/assets/$(notdir $(a)))
# ccache does not see what the assembler includes.
$(PAGES): export CCACHE_DISABLE = 1

# ---- MPI=1: sphsolve once more, from the same source, beside the other; the pair loops know of no ranks ----
mpi_object = $(patsubst %,$(BUILD)/obj-mpi/%.o,$(1))
MPI_LIBRARY = $(BUILD)/lib/libsphsolve-mpi.a
# Nothing changes where neither the source nor a header of it asks for ranks or includes HDF5: one object serves both.
$(BUILD)/obj-mpi/%.c.o: %.c $(BUILD)/obj/%.c.o
	$(Q)mkdir -p $(@D); if grep -qE 'TOSUI_MPI|<hdf5\.h>' $< $$(sed -n 's/:$$//p' $(BUILD)/obj/$*.c.d); \
	  then $(if $(filter 1,$(V)),,printf '  %-8s %s\n' MPICC $< &&) $(CC) $(filter-out $(DEP_CFLAGS),$(CFLAGS_ALL)) $(MPI_CFLAGS) -DTOSUI_MPI \
	    $(ISA_FLAGS) -MMD -MP -c $< -o $@; \
	  else rm -f $(@:.o=.d) && cp $(BUILD)/obj/$*.c.o $@; fi
-include $(shell test -d $(BUILD)/obj-mpi && find $(BUILD)/obj-mpi -name '*.d')
$(MPI_LIBRARY): $(call mpi_object,$(filter-out sphsolve/sphsolve.c $(PAIR_LOOPS),$(SOURCES_common) $(SOURCES_sphsolve))) $(call object,$(PAIR_LOOPS))
	$(call say,AR,$@)
	$(Q)mkdir -p $(@D) && rm -f $@ && ar qcs $@ $^
$(BUILD)/bin/sphsolve-mpi: $(call mpi_object,sphsolve/sphsolve.c) $(MPI_LIBRARY)
	$(call say,LINK,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(LDFLAGS_ALL) -o $@ $^ $(MPI_LIBS)

# Programs that tests run with and without MPI.
RANK_TESTS = $(patsubst tests/ranks/%.c,$(BUILD)/tests/%,$(wildcard tests/ranks/*.c))
$(BUILD)/tests/ranks_%-mpi: $(BUILD)/obj-mpi/tests/ranks/ranks_%.c.o $(MPI_LIBRARY)
	$(call say,LINK,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(LDFLAGS_ALL) -o $@ $^ $(MPI_LIBS)
$(BUILD)/tests/ranks_%: $(BUILD)/obj/tests/ranks/ranks_%.c.o $(BUILD)/lib/libsphsolve.a $(BUILD)/lib/libcommon.a
	$(call say,LINK,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(LDFLAGS_ALL) -o $@ $^ $(DEP_LIBS)

# What keeps ranks from spinning; a sanitizer wants to be loaded first.
RANK_IDLE = $(if $(findstring fsanitize,$(SANITIZE)),,$(BUILD)/tests/idle.so)
$(BUILD)/tests/idle.so: tests/ranks/preload/idle.c
	$(call say,LINK,$@)
	$(Q)mkdir -p $(@D) && $(CC) -O2 $(WARN) -shared -fPIC -o $@ $<

# ---- libraries (everything but the mains) and programs ----
define library_rule
$(call library,$(1)): $(filter-out $(call main_of,$(1)),$(call object,$(SOURCES_$(1))))
	$$(call say,AR,$$@)
	$$(Q)mkdir -p $$(@D) && rm -f $$@ && ar qcs $$@ $$(filter %.o,$$^)
endef
$(foreach p,common $(MODULES),$(eval $(call library_rule,$(p))))

define program_rule
$(BUILD)/bin/$(1): $(call main_of,$(1)) $(call library,$(1)) $(call library,common)
	$$(call say,LINK,$$@)
	$$(Q)mkdir -p $$(@D) && $$(CC) $$(LDFLAGS_ALL) -o $$@ $$^ $(if $(filter ct2model,$(1)),$(LIBS_OPENCV)) $$(DEP_LIBS)
endef
$(foreach p,$(PROGRAMS),$(eval $(call program_rule,$(p))))

$(BUILD)/bin/generate_sand: $(call object,$(SOURCES_generator)) $(call library,common)
	$(call say,LINK,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(LDFLAGS_ALL) -o $@ $^ $(DEP_LIBS)

# ---- tests ----
define test_rule
$(BUILD)/tests/$(basename $(notdir $(1))): $(call object,$(1)) $(LIBRARIES)
	$$(call say,LINK,$$@)
	$$(Q)mkdir -p $$(@D) && $$(CC) $$(LDFLAGS_ALL) -o $$@ $$< $(LIBRARIES) $(LIBS_OPENCV) -lcmocka $$(DEP_LIBS)
endef
$(foreach s,$(SOURCES_unit) $(SOURCES_long),$(eval $(call test_rule,$(s))))
tests: $(UNIT_TESTS) $(LONG_TESTS)

# Each fuzz target over its corpus, as a test.
REPLAYS = $(patsubst tests/fuzz/fuzz_%.c,$(BUILD)/tests/replay_%,$(wildcard tests/fuzz/fuzz_*.c))
replay_libraries = $(call library,$(if $(filter run hdf5,$(1)),analyze,ct2model)) $(if $(filter run hdf5,$(1)),,$(call library,sphsolve)) $(call library,common)
define replay_rule
$(BUILD)/tests/replay_$(1): $(call object,tests/fuzz/fuzz_$(1).c tests/fuzz/replay.c) $(call replay_libraries,$(1))
	$$(call say,LINK,$$@)
	$$(Q)mkdir -p $$(@D) && $$(CC) $$(LDFLAGS_ALL) -o $$@ $$^ $(LIBS_OPENCV) $$(DEP_LIBS)
endef
$(foreach t,$(REPLAYS:$(BUILD)/tests/replay_%=%),$(eval $(call replay_rule,$(t))))

# What tests of tests/cli run beside the three programs.
CLI_TESTS = $(if $(filter 1,$(MPI)),$(RANK_TESTS) $(RANK_TESTS:%=%-mpi) $(RANK_IDLE))
CLI_TESTS_LONG = $(CLI_TESTS) $(BUILD)/tests/hard_engine $(BUILD)/tests/bench_engine
# Of the tests given, those that T names, all where it is empty: T="resume stack" are resume.bats and test_stack.
T ?=
named = $(filter tests/cli/$(2:.bats=).bats $(BUILD)/tests/$(2) $(BUILD)/tests/test_$(2) $(BUILD)/tests/replay_$(2),$(1))
chosen = $(if $(T),$(foreach t,$(T),$(or $(call named,$(1),$(t)),$(error T=$(t): no such test; names are those of tests/cli/NAME.bats, tests/unit/test_NAME.c, tests/fuzz/fuzz_NAME.c))),$(1))
TESTS_LONG = $(if $(filter long verify,$(MAKECMDGOALS)),$(shell grep -l 'bats test_tags=long' tests/cli/*.bats) \
  $(patsubst tests/unit/%.c,$(BUILD)/tests/%,$(shell grep -l 'unit_test.long_test_' tests/unit/*.c)))
CHECKED = $(if $(filter check,$(MAKECMDGOALS)),$(call chosen,$(sort $(wildcard tests/cli/*.bats)) $(UNIT_TESTS) $(REPLAYS)))
check: all $(filter $(BUILD)/%,$(CHECKED)) $(if $(filter %.bats,$(CHECKED)),$(CLI_TESTS)) ## install what is missing, build, and run the tests of every day
	$(Q)BUILD=$(BUILD) scripts/run-tests $(CHECKED)
# What check leaves out.
long: all $(filter $(BUILD)/%,$(TESTS_LONG)) $(CLI_TESTS_LONG) ## the long tests, which check leaves out
	$(Q)BUILD=$(BUILD) LONG=1 scripts/run-tests $(call chosen,$(TESTS_LONG))

# ---- the main job ----
demo: all ## install what is missing, build, and go from CT slices to k with plots
	$(Q)BUILD=$(BUILD) scripts/demo

# ---- studies ----
s06: all ## study: the six cases of Saomoto et al. (2006); others: m15, scans, scan-quality, tradeoff
	$(Q)BUILD=$(BUILD) scripts/studies/s06
m15: all $(BUILD)/tests/verify_m15
	$(Q)BUILD=$(BUILD) scripts/studies/m15
# ct2model against true geometries, by noise: the sample sand and one it was not looked at with.
scans: all
	$(Q)BUILD=$(BUILD) /usr/bin/python3 scripts/studies/scan-study --output $(BUILD)/scans
	$(Q)BUILD=$(BUILD) /usr/bin/python3 scripts/studies/scan-study --output $(BUILD)/scans/other --seed 77 --void-ratio 0.942 --voxel-size 8.745um

# How far blur and noise move k: new sands, and the picture of those in docs/.
scan-quality: all
	$(Q)BUILD=$(BUILD) scripts/studies/scan-quality --output $(BUILD)/scan-quality
docs/figures/scan-quality.png: docs/figures/scan-quality.csv scripts/studies/scan-quality
	$(Q)scripts/studies/scan-quality --output docs/figures --redraw

# The tables, and the tests that make check leaves out; both run, whichever fails.
verify: all $(filter $(BUILD)/tests/verify_%,$(LONG_TESTS)) $(filter $(BUILD)/%,$(TESTS_LONG)) $(CLI_TESTS_LONG) ## tables of exact and independent solutions, then the long tests
	$(Q)BUILD=$(BUILD) scripts/verify; code=$$?; \
	  BUILD=$(BUILD) LONG=1 scripts/run-tests $(TESTS_LONG) && exit $$code
package: ## a Debian package
	$(Q)BUILD=$(BUILD) scripts/package
tradeoff: all
	$(Q)BUILD=$(BUILD) scripts/studies/tradeoff
hard: all $(BUILD)/tests/hard_engine ## the hard cases of the engine
	$(Q)BUILD=$(BUILD) scripts/hard
scenes: all ## every sample scene
	$(Q)BUILD=$(BUILD) scripts/hard --scenes
bench: all $(BUILD)/tests/bench_engine $(BUILD)/tests/bench_isph $(BUILD)/tests/bench_walk $(BUILD)/tests/bench_scan ## timings
	$(Q)BUILD=$(BUILD) scripts/bench

clean: ## remove what was built
	rm -rf $(BUILD)
format: ## clang-format over all sources
	clang-format -i $$(git ls-files '*.c' '*.h' '*.cc')
format-check: ## whether that would change anything
	clang-format --dry-run -Werror $$(git ls-files '*.c' '*.h' '*.cc')
# Programs to step through, in a build folder of their own.
debug: ## the programs for a debugger, in BUILD-debug/bin
	$(MAKE) all BUILD=$(BUILD)-debug OPT="-Og -g3"
lint: $(BUILD)/config.mk ## clang-tidy, cppcheck and gcc's analyser
	BUILD=$(BUILD) scripts/lint
# A part of these runs the part of the tests: make asan PART=2/3.
all_tests = $(1) $(MAKE) check ISAS=all $(2) && $(1) $(MAKE) long $(2)
asan: ## check and long with the address sanitizer; ubsan, tsan: the other two
	+$(call all_tests,ASAN_OPTIONS=allocator_may_return_null=1 LSAN_OPTIONS=suppressions=$(CURDIR)/tests/leaks.supp,BUILD=$(BUILD)-asan OPT="-O1 -g" SANITIZE="-fsanitize=address -fno-omit-frame-pointer")
ubsan:
	+$(call all_tests,,BUILD=$(BUILD)-ubsan OPT="-O1 -g" SANITIZE="-fsanitize=undefined -fno-sanitize-recover=undefined")
# GNU's OpenMP synchronises unseen by the sanitizer, which then cries wolf; archer tells it of that of LLVM's (clang, libomp-dev).
ARCHER = $(firstword $(wildcard /usr/lib/llvm-*/lib/libarcher.so))
tsan:
	+$(call all_tests,OMP_NUM_THREADS=2 OMP_TOOL_LIBRARIES=$(ARCHER) TSAN_OPTIONS="ignore_noninstrumented_modules=1 allocator_may_return_null=1",BUILD=$(BUILD)-tsan CC=clang CXX=clang++ OPT="-O1 -g" WARN=-Wall WARNXX=-Wall SANITIZE="-fsanitize=thread")
# Memcheck over the unit tests, one thread (it knows no AVX-512); those of faults, which run programs a thousand times, are asan's.
valgrind: $(UNIT_TESTS) ## the unit tests under memcheck
	$(Q)BUILD=$(BUILD) LONG=all TEST_SECONDS=3600 OMP_NUM_THREADS=1 TOSUI_ISA=avx2 WITH="valgrind -q --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite" \
	  scripts/run-tests $(foreach t,$(UNIT_TESTS),$(if $(findstring faults,$(t)),,$(t)))
# With the ranks, whose code is there to be covered too; the parts add up on one build.
coverage: ## check and long, and which lines they reached
	+$(call all_tests,,MPI=1 BUILD=$(BUILD)-coverage OPT="-O1 -g" SANITIZE="--coverage -DTOSUI_COVERAGE")
	scripts/coverage $(BUILD)-coverage

# ---- fuzzing: FUZZ_SECONDS of processor time each, with address and undefined behaviour sanitizers (needs clang) ----
# `make fuzz FUZZ=png` runs one target. The corpora under tests/fuzz/corpus are replayed by `make check`.
FUZZ_SECONDS ?= 1200
FUZZ ?= $(patsubst tests/fuzz/fuzz_%.c,%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_SOURCES = $(filter %.c,$(SOURCES_common) $(foreach p,ct2model sphsolve,$(filter-out $(p)/$(p).c,$(SOURCES_$(p)))))
FUZZ_FLAGS = -std=gnu11 -g -O1 $(MATH) -fopenmp -fsanitize=address,undefined -fno-sanitize-recover=undefined
define compile_fuzz
	$(call say,FUZZ,$*.c)
	$(Q)mkdir -p $(@D) && clang $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link $(ISA_FLAGS) -I. -I$(BUILD) -Itests/fuzz $(DEP_CFLAGS) -MMD -MP -c $< -o $@
endef
$(BUILD)/fuzz/obj/%.o: %.c $(BUILD)/flags
	$(compile_fuzz)
$(BUILD)/fuzz/obj/sphsolve/wcsph/kernels/%.o: $(PAIR_SOURCE) $(BUILD)/flags
	$(compile_fuzz)
-include $(shell test -d $(BUILD)/fuzz/obj && find $(BUILD)/fuzz/obj -name '*.d')
$(BUILD)/fuzz/libtosui.a: $(FUZZ_SOURCES:%.c=$(BUILD)/fuzz/obj/%.o) $(call object,$(filter %.cc,$(SOURCES_ct2model)))
	$(Q)rm -f $@ && ar qcs $@ $^
$(BUILD)/fuzz/%: $(BUILD)/fuzz/obj/tests/fuzz/fuzz_%.o $(BUILD)/fuzz/libtosui.a
	$(call say,LINK,$@)
	$(Q)clang $(FUZZ_FLAGS) -fsanitize=fuzzer -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBS_OPENCV) $(DEP_LIBS)
$(BUILD)/fuzz/run $(BUILD)/fuzz/hdf5: $(BUILD)/fuzz/obj/analyze/run_file.o
fuzz: $(FUZZ:%=$(BUILD)/fuzz/%) ## fuzz the readers
	$(Q)for n in $(FUZZ); do scripts/fuzz $(BUILD)/fuzz $$n $(FUZZ_SECONDS) || exit 1; done
.SECONDARY: $(FUZZ:%=$(BUILD)/fuzz/obj/tests/fuzz/fuzz_%.o)

# Man pages come from the option tables of the programs themselves.
MAN = $(PROGRAMS:%=$(BUILD)/man/%.1)
$(BUILD)/man/%.1: $(BUILD)/bin/%
	$(Q)mkdir -p $(@D) && $< --man > $@
COMPLETIONS = $(DESTDIR)$(PREFIX)/share/bash-completion/completions
PYTHON_DIR = $(DESTDIR)$(PREFIX)/lib/python3/dist-packages
install: all $(MAN) ## into PREFIX
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/share/man/man1 $(COMPLETIONS)
	install -m 755 $(PROGRAMS:%=$(BUILD)/bin/%) $(if $(filter 1,$(MPI)),$(BUILD)/bin/sphsolve-mpi) $(DESTDIR)$(PREFIX)/bin
	install -m 644 $(MAN) $(DESTDIR)$(PREFIX)/share/man/man1
	for p in $(PROGRAMS); do install -m 644 scripts/tosui-completion.bash $(COMPLETIONS)/$$p; done
	install -d $(PYTHON_DIR) && install -m 644 python/tosui.py $(PYTHON_DIR)
uninstall: ## what install put there
	rm -f $(PYTHON_DIR)/tosui.py $(DESTDIR)$(PREFIX)/bin/sphsolve-mpi $(foreach p,$(MODULES),$(DESTDIR)$(PREFIX)/bin/$(p) $(DESTDIR)$(PREFIX)/share/man/man1/$(p).1 $(COMPLETIONS)/$(p))
dist:
	git archive --prefix=tosui-0.1.0/ -o tosui-0.1.0.tar.gz HEAD
