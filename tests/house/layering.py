#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""layering.py ROOT: fails on an include arrow the table of rooms does not allow, and on banned words."""

import pathlib
import re
import sys

PROCESSING = "processing"
# A room's direct permissions; what those rooms may include follows. A room named "x/*" stands for every folder in x.
TABLE = {
    "processing/image": [],
    "processing/decomposition": ["processing/image"],
    "processing/patch": ["processing/decomposition"],
    "processing/matte": ["processing/image"],
    "processing/mesh": ["processing/image"],
    "processing/ttf": ["processing/image"],
    "processing/brdf": ["processing/image"],
    "processing/stbrdf": ["processing/brdf"],
    "processing/synthesis/*": ["processing/ttf", "processing/stbrdf", "processing/patch", "processing/mesh"],
    "processing/render": ["processing/synthesis/*", "processing/matte"],
    "processing/exchange": ["processing/render"],
    "calibration": ["processing/image"],
    "calibration/*": ["calibration"],
    "calibration/light": ["calibration"],
    "devices": ["processing/image"],
    "devices/*": ["devices"],
    "devices/twin": ["devices", "processing/brdf", "processing/mesh"],
    "devices/twin/dslr": ["devices/twin"],
    "db": ["processing/image"],
    "db/care": ["db"],
    "capture": ["devices", "db", "calibration/light"],
    "capture/doctor": ["devices", "db"],
    "capture/notify": ["capture"],
    "capture/workflow": ["db", "calibration/*", "processing/exchange"],
    "capture/scene": ["devices", "capture/workflow"],
    "capture/app/http": ["devices"],
    "capture/app": ["capture", "capture/doctor", "capture/notify", "capture/workflow", "capture/scene", "db/care", "devices/*", "devices/twin/dslr", "capture/app/http"],
}
TESTS = "tests"
TOP = ["processing", "calibration", "devices", "db", "capture", TESTS]

CLOCK_WORDS = re.compile(
    r"\w*_clock::now\b|\b(?:clock_gettime|gettimeofday|usleep|nanosleep|sleep_for|sleep_until|wait_for)\b")
CLOCK_HOME = "devices/clock.cpp"
RANDOM_WORDS = re.compile(r"\bstd::rand\b|\brandom_device\b")
CV_WORDS = re.compile(r"\bcv::")
CV_BRIDGE = "processing/image/cv_bridge.h"
# Slow to compile, or with types that must not cross a room: only .cpp files include these.
HEAVY = re.compile(
    r"^(opencv2/|sqlite3|gphoto2/|hdf5|H5|embree|libraw/|exiv2/|toml\+\+/|nlohmann/json\.hpp|CLI/|spdlog/|tiff|Imf|"
    r"libav|libsw|muParser|tiny_|openssl/|curl/|mosquitto|libusb|hidapi|gpiod|libcamera/|umockdev)")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">\n]+)[">]', re.MULTILINE)
# Numbers come first, or the digit separator in 1'000 would open a character literal.
COMMENT_OR_LITERAL = re.compile(
    r"""\b[0-9][0-9a-fA-FxX.']*|//[^\n]*|/\*.*?\*/|R"([^()\\\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'""",
    re.DOTALL)


def room_of(path):
    """The row of the table a file or include belongs to; None when no row fits."""
    folder = path.rsplit("/", 1)[0] if "/" in path else ""
    if folder.split("/")[0] == TESTS:
        return TESTS
    if folder in TABLE:
        return folder
    if folder.startswith("capture/app/"):
        return "capture/app"
    parent = folder.rsplit("/", 1)[0] + "/*"
    return folder if parent in TABLE else None


def may_include(room):
    """Every row that `room` may include, itself left out. "x/*" stays as written."""
    seen = []
    queue = list(TABLE.get(room) or TABLE.get(room.rsplit("/", 1)[0] + "/*", []))
    while queue:
        allowed = queue.pop()
        if allowed not in seen:
            seen.append(allowed)
            queue += TABLE[allowed]
    return seen


def arrow_allowed(source, target):
    if source == TESTS or source == target:
        return True
    allowed = may_include(source)
    return target in allowed or target.rsplit("/", 1)[0] + "/*" in allowed


def blank(match):
    """Keeps the lines of a comment or literal, drops its words."""
    text = match.group(0)
    return text if text[0].isdigit() else "\n" * text.count("\n") + " "


def check_includes(path, text):
    room, is_header = room_of(path), path.endswith(".h")
    if room is None:
        yield 1, f"folder is no room of the table in {__file__.rsplit('/', 1)[-1]}"
        return
    third_party = set()
    for match in INCLUDE.finditer(text):
        quote, target = match.groups()
        line = text.count("\n", 0, match.start()) + 1
        if target.split("/")[0] not in TOP or "/" not in target:
            if quote == '"':
                yield line, f'"{target}" is not named from the top of the tree'
            elif is_header and HEAVY.match(target) and path != CV_BRIDGE:
                yield line, f"<{target}> in a header: heavy third-party headers stay in .cpp files"
            third_party.add(target)
            continue
        target_room = room_of(target)
        if target_room is None:
            yield line, f"{target} lies in no room of the table"
        elif not arrow_allowed(room, target_room):
            yield line, f"{room} may not include {target_room} ({target})"
        if target == CV_BRIDGE and is_header:
            yield line, f"only .cpp files include {CV_BRIDGE}"
    if any(t.startswith("CLI/") for t in third_party) and any(t.startswith("nlohmann/") for t in third_party):
        yield 1, "includes both CLI11 and JSON: too slow to compile"


def check_words(path, text):
    code = COMMENT_OR_LITERAL.sub(blank, text)
    rules = [(RANDOM_WORDS, "randomness comes from processing/image/random.h")]
    if path != CLOCK_HOME:
        rules.append((CLOCK_WORDS, "time comes in through Clock (devices/clock.h)"))
    if path.endswith(".h") and path != CV_BRIDGE:
        rules.append((CV_WORDS, f"cv:: in a header other than {CV_BRIDGE}"))
    for pattern, why in rules:
        for match in pattern.finditer(code):
            yield code.count("\n", 0, match.start()) + 1, f"{match.group(0)}: {why}"
    if "SPDX-License-Identifier: GPL-3.0-or-later" not in text.split("\n", 1)[0]:
        yield 1, "first line is not the SPDX line"


def sources(root):
    for top in TOP:
        for path in sorted(pathlib.Path(root, top).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def check(root):
    found = []
    for path, text in sources(root):
        for line, what in [*check_includes(path, text), *check_words(path, text)]:
            found.append(f"{path}:{line}: {what}")
    return found


def main():
    found = check(sys.argv[1])
    print("\n".join(found) or "every include and word is allowed")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
