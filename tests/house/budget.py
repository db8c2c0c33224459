#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""budget.py ROOT BUILD: time, size and completeness of the tree. Over a budget warns; over 1.5 times a size
or twice a time it fails (docs/decisions/0009)."""

import json
import os
import pathlib
import re
import sys

BUILD_MINUTES, UNIT_SECONDS = 20, 10
TESTS_MINUTES, CASE_SECONDS = 14, 20
HEADER_LINES, SOURCE_LINES, README_LINES = 150, 400, 40
RED_SIZE, RED_TIME = 1.5, 2
# A hit of the compiler cache takes less than this and says nothing about the unit: its last real compilation counts.
CACHE_HIT_SECONDS = 0.3
ROOMS = ["processing", "calibration", "devices", "db", "capture"]
# main() only hands over to verbs; the tests of tests/system run it.
NEEDS_NO_TEST = ["capture/app/main.cpp"]


class Findings:
    def __init__(self):
        self.warnings, self.errors = [], []

    def incomplete(self, text):
        """What is not there yet. PATINA_STRICT=0, for a tree where several rooms are being moved in, only warns of it."""
        (self.warnings if os.environ.get("PATINA_STRICT") == "0" else self.errors).append(text)

    def measure(self, what, value, budget, unit):
        if value > budget:
            text = f"{what}: {value:.1f} {unit}, budget {budget} {unit}"
            red = RED_SIZE if unit == "lines" else RED_TIME
            (self.errors if value > red * budget else self.warnings).append(text)


def last_seconds(log):
    """name -> user CPU seconds, of a log written by packaging/cmake/timed.sh."""
    seconds = {}
    if not log.exists():
        return seconds
    for line in log.read_text(encoding="utf-8").splitlines():
        value, _, name = line.partition(" ")
        try:
            value = float(value)
        except ValueError:
            continue  # two jobs wrote at once, or the disk was full: no reason to fail a build
        if value >= CACHE_HIT_SECONDS or name not in seconds:
            seconds[name] = value
    return seconds


def check_build(findings, root, build):
    known = set()
    commands = build / "compile_commands.json"
    if commands.exists():
        known = {entry["file"] for entry in json.loads(commands.read_text(encoding="utf-8"))}
    total = 0
    for name, seconds in sorted(last_seconds(build / "compile_times.log").items()):
        if name.endswith(".cpp") and name not in known:
            continue  # deleted or renamed since
        total += seconds
        if name.endswith(".cpp"):
            findings.measure("compiling " + name.removeprefix(f"{root}/"), seconds, UNIT_SECONDS, "CPU s")
    findings.measure("building everything", total / 60, BUILD_MINUTES, "CPU min")
    return total


def check_tests(findings, build, entries):
    """`entries`: the CTest names that exist, or None for all in the log. Returns CPU seconds, cases and skipped cases."""
    seconds = {name: s for name, s in last_seconds(build / "test_times.log").items() if entries is None or name in entries}
    cases = skipped = 0
    for name, cpu in seconds.items():
        report = build / "test_reports" / f"{name}.json"
        try:
            suites = json.loads(report.read_text(encoding="utf-8"))["testsuites"]
        except (OSError, ValueError):
            continue  # an entry that crashed has told CTest so already
        for case in (case for suite in suites for case in suite["testsuite"]):
            cases += case["status"] == "RUN"
            skipped += case["result"] == "SKIPPED"
            # A case's own time is by the wall; a busy machine must not turn it red, so the entry's CPU time bounds it.
            took = min(float(case["time"].rstrip("s")), cpu)
            findings.measure(f"test {suite_name(case)}", took, CASE_SECONDS, "s")
    findings.measure("running all tests", sum(seconds.values()) / 60, TESTS_MINUTES, "CPU min")
    return sum(seconds.values()), cases, skipped


def suite_name(case):
    return f"{case['classname']}.{case['name']}"


def check_sizes(findings, root):
    for top in [*ROOMS, "tests"]:
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            lines = path.read_text(encoding="utf-8").count("\n")
            budget = HEADER_LINES if path.suffix == ".h" else SOURCE_LINES
            findings.measure(path.relative_to(root).as_posix(), lines, budget, "lines")


def registered(path, root):
    """Is the source named in the CMakeLists.txt of its folder, or (as verbs/x.cpp) of one above?"""
    for folder in path.parents:
        lists = folder / "CMakeLists.txt"
        if lists.exists():
            name = re.escape(path.relative_to(folder).as_posix())
            return re.search(rf"(?<![\w./-]){name}(?![\w.-])", lists.read_text(encoding="utf-8")) is not None
        if folder == root:
            return False
    return False


def check_registered(findings, root):
    tested = {path.name for path in (root / "tests").rglob("*_test.cpp")}
    for top in [*ROOMS, "tests"]:
        for path in sorted((root / top).rglob("*.cpp")):
            name = path.relative_to(root).as_posix()
            if not registered(path, root):
                findings.errors.append(f"{name}: in no CMakeLists.txt, so it is never built")
            if top != "tests" and name not in NEEDS_NO_TEST and f"{path.stem}_test.cpp" not in tested:
                findings.incomplete(f"{name}: no {path.stem}_test.cpp under tests/")


def check_readmes(findings, root):
    for top in [*ROOMS, "tests"]:
        for lists in sorted((root / top).rglob("CMakeLists.txt")):
            folder = lists.parent
            has_target = re.search(r"^patina_(library|program|test)\(", lists.read_text(encoding="utf-8"), re.MULTILINE)
            mirrors = top == "tests" and (root / folder.relative_to(root / top)).is_dir()
            if not has_target or mirrors:
                continue  # the tests of a room are explained by the room's page
            readme, name = folder / "README.md", folder.relative_to(root).as_posix()
            if not readme.exists():
                findings.incomplete(f"{name}: has a target but no README.md")
            else:
                findings.measure(f"{name}/README.md", readme.read_text(encoding="utf-8").count("\n"), README_LINES, "lines")


def main():
    root, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    entries = None
    if len(sys.argv) > 3:
        entries = set(pathlib.Path(sys.argv[3]).read_text(encoding="utf-8").split())
    findings = Findings()
    compiled = check_build(findings, root, build)
    tested, cases, skipped = check_tests(findings, build, entries)
    check_sizes(findings, root)
    check_registered(findings, root)
    check_readmes(findings, root)
    report = [f"build {compiled / 60:.1f} CPU min, tests {tested / 60:.1f} CPU min, {cases} cases, {skipped} skipped"]
    report += [f"warning: {text}" for text in findings.warnings]
    report += [f"FAILED: {text}" for text in findings.errors]
    (build / "budget.txt").write_text("\n".join(report) + "\n", encoding="utf-8")
    print("\n".join(report))
    return 1 if findings.errors else 0


if __name__ == "__main__":
    sys.exit(main())
