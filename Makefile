# SPDX-License-Identifier: GPL-3.0-or-later
# A thin face on CMakePresets.json. JOBS=4 make ... to build with four compilers at once.
JOBS ?= $(shell nproc)
export CTEST_PARALLEL_LEVEL ?= $(JOBS)

.PHONY: all packages build demo test test-long test-powercut test-asan fuzz bench lint clean

all: build

packages:
	@packaging/install-packages.sh

build: packages
	@cmake --preset dev >/dev/null
	@cmake --build --preset dev -j $(JOBS)

demo: build
	@packaging/demo.sh

test: build
	@ctest --preset dev -j $(JOBS)

test-long: build
	@ctest --preset long

# 5,000 power cuts on ext4 and XFS under the program itself: root, /dev/fuse and loop devices.
test-powercut: build
	@ctest --preset long -L '^powercut$$' -V

# SECONDS=900 make fuzz: each reader of others' bytes so long under libFuzzer.
SECONDS ?= 60
fuzz:
	@packaging/install-packages.sh fuzz
	@cmake --preset fuzz >/dev/null
	@cmake --build --preset fuzz -j $(JOBS)
	@packaging/fuzz.sh $(SECONDS)

# The rooms that guard the archive, under AddressSanitizer and UndefinedBehaviorSanitizer.
test-asan: packages
	@cmake --preset asan-ubsan >/dev/null
	@cmake --build --preset asan-ubsan -j $(JOBS) --target tests-db tests-capture
	@ctest --preset asan-ubsan -j $(JOBS) -L '^(db|capture)$$'

bench: packages
	@cmake --preset release >/dev/null
	@cmake --build --preset release -j $(JOBS) --target patina_bench
	@build-release/patina_bench

lint: packages
	@packaging/lint.sh

clean:
	@cmake -E rm -rf build build-release build-asan build-tsan build-fuzz out
