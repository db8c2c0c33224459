# SPDX-License-Identifier: GPL-3.0-or-later
# A thin face on CMakePresets.json. JOBS=4 make ... to build with four compilers at once.
JOBS ?= $(shell nproc)
export CTEST_PARALLEL_LEVEL ?= $(JOBS)

.PHONY: all packages build demo test test-long test-powercut test-guest test-asan test-tsan fuzz bench lint clean

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

# Real kernel drivers on simulated hardware, in an emulated machine. The first run fetches a kernel (70 MB) and its source
# (140 MB) into build/guest.
test-guest: build
	@packaging/install-packages.sh guest
	@cmake --build --preset dev -j $(JOBS) --target guest-programs
	@ctest --preset guest

# SECONDS=900 make fuzz: each reader of others' bytes for so much processor time under libFuzzer.
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

# What has threads of its own, under ThreadSanitizer: camera workers, the daemon, its front door, what it tells people.
test-tsan: packages
	@cmake --preset tsan >/dev/null
	@cmake --build --preset tsan -j $(JOBS) --target capture_tests sim_tests http_test daemon_test notify_tests
	@ctest --preset tsan -j $(JOBS) -R '^(capture_tests|sim_tests|http_test|daemon_test|notify_tests)'

bench: packages
	@cmake --preset release >/dev/null
	@cmake --build --preset release -j $(JOBS) --target patina_bench
	@build-release/patina_bench

lint: packages
	@packaging/lint.sh

clean:
	@cmake -E rm -rf build build-release build-asan build-tsan build-fuzz out
