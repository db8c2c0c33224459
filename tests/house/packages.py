#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""packages.py ROOT: every package that install-packages.sh installs has its line in docs/dependencies.md, and no other."""

import pathlib
import re
import sys


def installed(script):
    lists = re.findall(r"^(?:[a-z]+_)?packages='([^']*)'", script, re.MULTILINE)
    return {package for words in lists for package in words.split()}


def explained(page):
    return set(re.findall(r"^\| `([a-z0-9.+-]+)` \|", page, re.MULTILINE))


def check(root):
    root = pathlib.Path(root)
    have = installed((root / "packaging/install-packages.sh").read_text(encoding="utf-8"))
    told = explained((root / "docs/dependencies.md").read_text(encoding="utf-8"))
    return [f"{name}: installed, but no line in docs/dependencies.md" for name in sorted(have - told)] + [
        f"{name}: in docs/dependencies.md, but not installed" for name in sorted(told - have)
    ]


def main():
    found = check(sys.argv[1])
    print("\n".join(found) or "every package is explained")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
