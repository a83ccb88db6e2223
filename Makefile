# SPDX-License-Identifier: BSD-3-Clause
# make demo    install what is missing, build, correct our NAND2
# make test    install what is missing, build, run every test
# make program  all but the programs of tests
# make bench   the benchmarks; results in build/bench/NAME.json
# make sanitize [SUITES="eda plugins"]  tests under AddressSanitizer and UBSan, all by default
#
# make coverage [FOLDERS=core/run]  lines that the unit tests of a folder execute
# make mutants [COUNT=100] [SEED=1] [JOBS=1] [FOLDERS=core/run]  undetected changes of lines
#
# make fuzz [TARGET=gds] [RUNS=10000000]  libFuzzer on the parsers, with clang
# make lint    clang-format and clang-tidy over all code
# make site    the documents as web pages, in build/site (mkdocs)
# make deb     Debian packages of the last commit, in build/deb, checked by lintian
# make install [PREFIX=/usr/local] [DESTDIR=]  says where things went

BUILD ?= build
MESON_FLAGS ?=
export MESONFLAGS =

# Suites of tests that `make test` and `make sanitize` run; empty: all. Programs that passed
# without a skipped case in the build folder EXCEPT do not run again. Programs of other tests are
# not built.
SUITES ?=
EXCEPT ?=

.PHONY: demo test bench sanitize coverage mutants fuzz lint site deb install build program clean

demo: build
	$(BUILD)/opcflow run flows/demo.yaml

build: $(BUILD)/build.ninja
	@ninja -C $(BUILD) --quiet

program: $(BUILD)/build.ninja
	@ninja -C $(BUILD) --quiet build.ninja >/dev/null
	@ninja -C $(BUILD) --quiet $$(tools/targets $(BUILD))

$(BUILD)/build.ninja:
	@tools/install-packages
	@meson setup $(BUILD) $(addprefix --prefix=,$(abspath $(PREFIX))) $(MESON_FLAGS) >$(BUILD).log 2>&1 || { cat $(BUILD).log; exit 1; }
	@rm -f $(BUILD).log

test: $(BUILD)/build.ninja
	@tools/install-packages zsh groff qemu-user python3-jsonschema ngspice iverilog python3-numpy mkdocs python3-pip python3-wheel
	@tools/run-tests $(BUILD) $(addprefix --except ,$(EXCEPT)) $(SUITES)

bench: build
	ninja -C $(BUILD) bench

# Leaks are looked for as well; libraries that keep memory for their whole life
# are listed in tools/leaks. With -O2 and full debug information, the build takes
# 3.7 times as long, and the tests save a quarter. Warnings are errors here as
# well: .ci/run compiles most tests in this build only.
sanitize:
	@$(MAKE) --no-print-directory test BUILD=build-sanitize \
	  MESON_FLAGS="--buildtype plain -Doptimization=g -Dc_args=-g1 \
	  -Db_sanitize=address,undefined -Db_lundef=false"

FOLDERS ?=
COUNT ?= 100
SEED ?= 1
JOBS ?= 1
coverage:
	@tools/install-packages
	@[ -f build-coverage/build.ninja ] || meson setup build-coverage --buildtype plain \
	  -Doptimization=0 -Dc_args=-w -Db_coverage=true >build-coverage.log 2>&1 || \
	  { cat build-coverage.log; exit 1; }
	@rm -f build-coverage.log
	@tools/coverage build-coverage $(FOLDERS)

mutants:
	@tools/install-packages
	@tools/mutants build-mutants --count $(COUNT) --seed $(SEED) --jobs $(JOBS) $(FOLDERS)

TARGET ?= all
RUNS ?= 10000000
fuzz:
	@tools/install-packages clang libclang-rt-14-dev
	@tools/fuzz build-fuzz $(TARGET) $(RUNS)

lint: build
	@tools/install-packages clang-format clang-tidy
	@tools/format --check
	@tools/lint $(BUILD)

site:
	@tools/install-packages mkdocs
	@tools/site $(BUILD)/site

deb:
	@tools/install-packages debhelper dh-python dpkg-dev lintian
	@tools/deb $(abspath $(BUILD))/deb

install: build
	@tools/install $(BUILD) $(abspath $(PREFIX))

clean:
	rm -rf build build-sanitize build-fuzz build-coverage build-mutants
