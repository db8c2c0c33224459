#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""udev_rules.py ROOT: packaging/udev/*.rules are rules, give nothing to everyone, and match before they do anything."""

import pathlib
import re
import sys

TOKEN = re.compile(r'^([A-Z_]+)(?:\{([^}]*)\})?\s*(==|!=|\+=|-=|:=|=)\s*"((?:[^"\\]|\\.)*)"$')
# Keys that may stand with == or !=, and those that may be set (udev(7)). No rule of ours runs a program.
MATCHES = {"ACTION", "DEVPATH", "KERNEL", "KERNELS", "NAME", "SYMLINK", "SUBSYSTEM", "SUBSYSTEMS", "DRIVER", "DRIVERS", "ATTR",
           "ATTRS", "ENV", "TAG", "TAGS", "TEST", "PROGRAM", "RESULT"}
SETS = {"NAME", "SYMLINK", "OWNER", "GROUP", "MODE", "ATTR", "ENV", "TAG", "LABEL", "GOTO", "OPTIONS"}
NEEDS_NO_MATCH = {"LABEL"}


def rules(text):
    """Number and text of each rule, continuation lines joined."""
    number, pending = 0, ""
    for at, line in enumerate(text.splitlines(), 1):
        if not pending:
            number = at
        if not pending and (not line.strip() or line.lstrip().startswith("#")):
            continue
        if line.endswith("\\"):
            pending += line[:-1]
            continue
        yield number, (pending + line).strip()
        pending = ""
    if pending:
        yield number, pending.strip()


def split(rule):
    """The tokens between commas outside of quotes."""
    return [part.strip() for part in re.findall(r'(?:[^,"]|"(?:[^"\\]|\\.)*")+', rule)]


def check_token(key, operator, value):
    matches = operator in ("==", "!=")
    if matches and key not in MATCHES:
        yield f"{key} cannot be matched"
    if not matches and key not in SETS:
        yield f"{key} cannot be set" + ("" if key not in MATCHES else ': did you mean "=="?')
    if key == "MODE" and not matches:
        if not re.fullmatch(r"0[0-7]{3}", value):
            yield f'MODE "{value}" is not four octal digits'
        elif int(value[-1]) & 2:
            yield f'MODE "{value}" lets everyone write'


def check_rule(rule):
    tokens = []
    for part in split(rule):
        token = TOKEN.match(part)
        if not token:
            yield f"cannot be read: {part}"
            continue
        key, _, operator, value = token.groups()
        tokens.append((key, operator))
        yield from check_token(key, operator, value)
    keys = {key for key, _ in tokens}
    if not keys <= NEEDS_NO_MATCH and not any(operator == "==" for _, operator in tokens):
        yield "has no match: it would act on every device"


def check(text):
    found, labels, gotos = [], set(), []
    for number, rule in rules(text):
        found += [f"{number}: {what}" for what in check_rule(rule)]
        labels |= set(re.findall(r'\bLABEL="([^"]*)"', rule))
        gotos += [(number, name) for name in re.findall(r'\bGOTO="([^"]*)"', rule)]
    found += [f"{number}: GOTO {name}, and no such LABEL" for number, name in gotos if name not in labels]
    return found


def main():
    found = []
    files = sorted(pathlib.Path(sys.argv[1], "packaging/udev").glob("*.rules"))
    for file in files:
        found += [f"{file}:{line}" for line in check(file.read_text(encoding="utf-8"))]
    print("\n".join(found) or f"{len(files)} files of udev rules are sound")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())
