#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks of the house must reject what is planted, and pass what is clean."""

import json
import os
import pathlib
import stat
import subprocess
import tempfile
import unittest

import budget
import layering
import packages
import udev_rules

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPDX = "// SPDX-License-Identifier: GPL-3.0-or-later\n"


class Planted(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def plant(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        return file


class Layering(Planted):
    def found(self, path, body):
        self.plant(path, SPDX + body)
        return layering.check(self.root)

    def assertRejected(self, path, body, why):
        found = self.found(path, body)
        self.assertEqual(len(found), 1, found)
        self.assertIn(why, found[0])
        self.assertTrue(found[0].startswith(f"{path}:2:"), found[0])

    def assertAllowed(self, path, body):
        self.assertEqual(self.found(path, body), [])

    def test_rejects_an_arrow_upwards(self):
        self.assertRejected("processing/image/a.cpp", '#include "devices/camera.h"\n', "may not include devices")

    def test_rejects_an_arrow_between_siblings(self):
        self.assertRejected("db/a.h", '#include "calibration/dark.h"\n', "db may not include calibration")

    def test_rejects_a_backend_in_capture(self):
        self.assertRejected("capture/a.cpp", '#include "devices/twin/world.h"\n', "may not include devices/twin")
        self.assertRejected("capture/a.cpp", '#include "devices/usb/relay.h"\n', "may not include devices/usb")

    def test_rejects_one_backend_in_another(self):
        self.assertRejected("devices/fault/a.cpp", '#include "devices/twin/world.h"\n', "may not include devices/twin")

    def test_rejects_one_synthesis_method_in_another(self):
        self.assertRejected("processing/synthesis/quilting/a.cpp", '#include "processing/synthesis/field_driven/f.h"\n',
                            "may not include")

    def test_rejects_tests_in_a_room(self):
        self.assertRejected("db/a.cpp", '#include "tests/support/matchers.h"\n', "may not include tests")

    def test_rejects_the_program_in_a_room(self):
        self.assertRejected("capture/workflow/a.cpp", '#include "capture/app/main.h"\n', "may not include capture/app")

    def test_rejects_an_include_that_hides_in_angle_brackets(self):
        self.assertRejected("db/a.cpp", "#include <devices/camera.h>\n", "may not include devices")

    def test_rejects_a_folder_that_is_no_room(self):
        found = self.found("processing/utils/a.cpp", "")
        self.assertIn("no room", found[0])

    def test_rejects_an_include_not_named_from_the_top(self):
        self.assertRejected("db/a.cpp", '#include "catalog.h"\n', "top of the tree")

    def test_rejects_a_heavy_header_in_a_header(self):
        self.assertRejected("db/a.h", "#include <sqlite3.h>\n", "stay in .cpp files")

    def test_rejects_the_cv_bridge_in_a_header(self):
        self.assertRejected("calibration/a.h", '#include "processing/image/cv_bridge.h"\n', "only .cpp files")

    def test_rejects_cli11_and_json_in_one_file(self):
        found = self.found("capture/app/a.cpp", "#include <CLI/CLI.hpp>\n#include <nlohmann/json.hpp>\n")
        self.assertIn("both CLI11 and JSON", found[0])

    def test_follows_permissions_through_rooms(self):
        self.assertAllowed("processing/patch/a.cpp", '#include "processing/image/image.h"\n')
        self.assertAllowed("capture/a.cpp", '#include "processing/image/units.h"\n#include "devices/camera.h"\n')
        self.assertAllowed("capture/workflow/a.cpp", '#include "processing/synthesis/quilting/quilting.h"\n'
                           '#include "processing/render/chart.h"\n#include "processing/decomposition/svd.h"\n')
        self.assertAllowed("capture/app/verbs/a.cpp", '#include "devices/twin/world.h"\n#include "devices/fault/camera.h"\n'
                           '#include "capture/session.h"\n#include "capture/app/options.h"\n')
        self.assertAllowed("devices/twin/a.cpp", '#include "processing/brdf/ggx.h"\n#include "devices/clock.h"\n')
        self.assertAllowed("tests/db/a_test.cpp", '#include "db/catalog.h"\n#include "tests/support/temp_folder.h"\n')

    def test_rejects_every_banned_word(self):
        words = ["std::chrono::steady_clock::now()", "clock_gettime(0, 0)", "gettimeofday(0, 0)", "usleep(1)", "nanosleep(0, 0)",
                 "std::this_thread::sleep_for(x)", "std::this_thread::sleep_until(x)", "cv.wait_for(l, x)", "std::rand()",
                 "std::random_device d"]
        for word in words:
            with self.subTest(word):
                self.assertRejected("capture/a.cpp", f"auto x = {word};\n", "comes")
                self.assertRejected("capture/a.cpp", f"int n = 1'000; char c = '\"'; {word};\n", "comes")

    def test_lets_only_the_clock_read_the_clock(self):
        self.assertAllowed("devices/clock.cpp", "auto x = std::chrono::system_clock::now();\n")
        self.assertRejected("devices/clock.cpp", "int x = std::rand();\n", "random")

    def test_lets_comments_and_strings_name_a_banned_word(self):
        self.assertAllowed("db/a.cpp", '// never usleep\n/* nor\n sleep_for */\nauto s = "usleep"; auto r = R"(usleep)";\n')

    def test_rejects_cv_in_a_header(self):
        self.assertRejected("processing/image/a.h", "cv::Mat view();\n", "cv:: in a header")
        self.plant("processing/image/a.h", SPDX)
        self.assertAllowed("processing/image/cv_bridge.h", "#include <opencv2/core.hpp>\ncv::Mat view();\n")
        self.assertAllowed("processing/image/a.cpp", "cv::Mat view();\n")

    def test_rejects_a_file_without_its_licence_line(self):
        self.plant("db/a.cpp", "int x;\n")
        self.assertIn("SPDX", layering.check(self.root)[0])


class Budget(Planted):
    def setUp(self):
        super().setUp()
        self.findings = budget.Findings()
        self.build = self.root / "build"

    def compiled(self, *lines):
        units = sorted({line.split()[1] for line in lines})
        self.plant("build/compile_commands.json", json.dumps([{"file": unit} for unit in units]))
        self.plant("build/compile_times.log", "".join(f"{line}\n" for line in lines))
        return budget.check_build(self.findings, self.root, self.build)

    def ran(self, cpu, seconds, entry="x_test", result="COMPLETED"):
        case = {"name": "C", "classname": "S", "status": "RUN", "result": result, "time": f"{seconds}s"}
        self.plant(f"build/test_reports/{entry}.json", json.dumps({"testsuites": [{"testsuite": [case]}]}))
        self.plant("build/test_times.log", f"{cpu} {entry}\n")
        return budget.check_tests(self.findings, self.build, None)

    def test_warns_of_a_unit_over_budget_and_fails_over_twice_that(self):
        self.compiled("9.9 a.cpp", "19.9 b.cpp", "20.1 c.cpp")
        self.assertEqual([w.split(":")[0] for w in self.findings.warnings], ["compiling b.cpp"])
        self.assertEqual([e.split(":")[0] for e in self.findings.errors], ["compiling c.cpp"])

    def test_counts_the_last_real_compilation_and_not_a_cache_hit(self):
        self.assertEqual(self.compiled("30 a.cpp", "4 a.cpp", "0.01 a.cpp", "garbage a.cpp"), 4)
        self.assertEqual(self.findings.errors, [])

    def test_forgets_a_unit_that_is_gone(self):
        self.plant("build/compile_commands.json", "[]")
        self.plant("build/compile_times.log", "99 gone.cpp\n")
        self.assertEqual(budget.check_build(self.findings, self.root, self.build), 0)

    def test_fails_a_build_of_more_than_forty_minutes(self):
        self.compiled(*[f"9 {n}.cpp" for n in range(267)])
        self.assertIn("building everything", self.findings.errors[0])

    def test_fails_a_slow_test_and_warns_of_a_slowish_one(self):
        self.ran(40, 21)
        self.assertEqual((len(self.findings.warnings), self.findings.errors), (1, []))
        self.ran(50, 41)
        self.assertIn("test S.C", self.findings.errors[0])

    def test_does_not_blame_a_test_for_a_busy_machine(self):
        self.ran(2, 99)
        self.assertEqual(self.findings.errors, [])

    def test_fails_tests_of_more_than_twenty_eight_minutes(self):
        self.ran(28.1 * 60, 1)
        self.assertIn("running all tests", self.findings.errors[0])

    def test_counts_skipped_cases(self):
        self.assertEqual(self.ran(1, 1, result="SKIPPED"), (1, 1, 1))

    def test_fails_a_header_of_226_and_a_source_of_601_lines(self):
        for path, lines in [("db/a.h", 150), ("db/b.h", 151), ("db/c.h", 226), ("db/d.cpp", 401), ("db/e.cpp", 601)]:
            self.plant(path, "\n" * lines)
        budget.check_sizes(self.findings, self.root)
        self.assertEqual([w.split(":")[0] for w in self.findings.warnings], ["db/b.h", "db/d.cpp"])
        self.assertEqual([e.split(":")[0] for e in self.findings.errors], ["db/c.h", "db/e.cpp"])

    def test_fails_a_source_that_no_list_names(self):
        self.plant("db/CMakeLists.txt", "patina_library(x SOURCES catalog.cpp)")
        self.plant("db/log.cpp", "")
        self.plant("tests/db/CMakeLists.txt", "patina_test(x SOURCES log_test.cpp)")
        self.plant("tests/db/log_test.cpp", "")
        self.plant("tests/db/forgotten_test.cpp", "")
        budget.check_registered(self.findings, self.root)
        self.assertEqual([e.split(":")[0] for e in self.findings.errors], ["db/log.cpp", "tests/db/forgotten_test.cpp"])

    def test_fails_a_source_without_a_test_of_its_name(self):
        self.plant("db/CMakeLists.txt", "patina_library(x SOURCES catalog.cpp)")
        self.plant("db/catalog.cpp", "")
        budget.check_registered(self.findings, self.root)
        self.assertEqual(self.findings.errors, ["db/catalog.cpp: no catalog_test.cpp under tests/"])

    def test_fails_a_target_without_a_readme(self):
        self.plant("db/CMakeLists.txt", "patina_library(x)")
        self.plant("tests/db/CMakeLists.txt", "patina_test(x)")
        self.plant("tests/sim/CMakeLists.txt", "patina_test(x)")
        budget.check_readmes(self.findings, self.root)
        self.assertEqual(self.findings.errors, [f"{n}: has a target but no README.md" for n in ("db", "tests/sim")])


class Timed(Planted):
    def timed(self, name, *command):
        log = self.root / "log"
        done = subprocess.run([ROOT / "packaging/cmake/timed.sh", log, name, *command], capture_output=True, text=True, check=False)
        return done, log.read_text(encoding="utf-8").split() if log.exists() else None

    def test_passes_output_and_status_through(self):
        done, logged = self.timed("x", "sh", "-c", "echo out; echo err >&2; exit 7")
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("out\n", "err\n", 7))
        self.assertEqual(logged[1], "x")

    def test_counts_the_user_seconds_of_the_command(self):
        _, logged = self.timed("x", "sh", "-c", "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done")
        self.assertGreater(float(logged[0]), 0.0)

    def test_names_a_compilation_by_its_source_and_a_link_by_its_output(self):
        self.assertEqual(self.timed("-", "true", "-o", "x.o", "-c", "a.cpp")[1][1], "a.cpp")
        (self.root / "log").unlink()
        self.assertEqual(self.timed("-", "true", "x.o", "-o", "tests/x")[1][1], "tests/x")


class Packages(Planted):
    def test_rejects_a_package_nobody_explains_and_a_line_without_package(self):
        self.plant("packaging/install-packages.sh", "packages='\n  a-dev b-dev'\nlint_packages='c'\n")
        self.plant("docs/dependencies.md", "| `a-dev` | why |\n| `c` | why |\n| `d` | why |\n")
        found = packages.check(self.root)
        self.assertEqual([line.split(":")[0] for line in found], ["b-dev", "d"])


class UdevRules(unittest.TestCase):
    def assertRejected(self, rule, why):
        found = udev_rules.check(rule)
        self.assertEqual(len(found), 1, found)
        self.assertIn(why, found[0])

    def test_rejects_what_everyone_may_write(self):
        self.assertRejected('SUBSYSTEM=="usb", MODE="0666"', "lets everyone write")
        self.assertRejected('SUBSYSTEM=="usb", MODE="0662"', "lets everyone write")
        self.assertRejected('SUBSYSTEM=="usb", MODE="660"', "four octal digits")

    def test_rejects_a_rule_for_every_device(self):
        self.assertRejected('GROUP="patina", MODE="0660"', "no match")
        self.assertRejected('KERNEL!="x", GROUP="patina"', "no match")

    def test_rejects_what_is_no_rule(self):
        self.assertRejected('SUBSYSTEM=="usb", MODE=0660', "cannot be read")
        self.assertRejected('SUBSYSTEM=="usb", ATTRS{idVendor}="16c0"', "cannot be set")
        self.assertRejected('GROUP=="patina", SUBSYSTEM=="usb"', "cannot be matched")
        self.assertRejected('SUBSYSTEM=="usb", RUN+="/bin/sh"', "cannot be set")
        self.assertRejected('ACTION=="remove", GOTO="end"', "no such LABEL")

    def test_reads_comments_continued_lines_and_commas_in_values(self):
        self.assertEqual(udev_rules.check('# MODE="0666"\n\nSUBSYSTEM=="usb", \\\n  SYMLINK+="a,b", MODE="0660"\nLABEL="x"\n'), [])
        self.assertIn("2:", udev_rules.check('# one\nMODE="0660"')[0])


class InstallPackages(Planted):
    """The script under fake dpkg-query, id and apt-get; nothing is installed."""

    def run_script(self, missing="", uid=0):
        present = packages.installed((ROOT / "packaging/install-packages.sh").read_text(encoding="utf-8")) - {missing}
        self.fake("dpkg-query", "printf '%s=installed ' " + " ".join(sorted(present)))
        self.fake("id", f"echo {uid}")
        self.fake("apt-get", f'echo "apt-get $*" >>{self.root}/calls; [ -t 0 ] && exit 1; exit 0')
        environment = {**os.environ, "PATH": f"{self.root}:{os.environ['PATH']}"}
        return subprocess.run([ROOT / "packaging/install-packages.sh"], env=environment, capture_output=True, text=True, check=False)

    def fake(self, name, body):
        file = self.plant(name, f"#!/bin/sh\n{body}\n")
        file.chmod(file.stat().st_mode | stat.S_IXUSR)

    def calls(self):
        log = self.root / "calls"
        return log.read_text(encoding="utf-8").splitlines() if log.exists() else []

    def test_is_silent_when_all_is_there(self):
        done = self.run_script()
        self.assertEqual((done.returncode, done.stdout, done.stderr, self.calls()), (0, "", "", []))

    def test_installs_only_what_is_missing(self):
        self.assertEqual(self.run_script(missing="libtiff-dev").returncode, 0)
        self.assertEqual(self.calls()[-1], "apt-get install -y -q --no-install-recommends libtiff-dev")

    def test_prints_the_command_and_exits_69_without_root(self):
        done = self.run_script(missing="libtiff-dev", uid=1000)
        self.assertEqual((done.returncode, self.calls()), (69, []))
        self.assertIn("apt-get install -y --no-install-recommends libtiff-dev", done.stderr)


if __name__ == "__main__":
    unittest.main()
