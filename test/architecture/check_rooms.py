#!/usr/bin/python3
"""Checks the rules that keep the rooms apart; exits 1 and prints one line per violation.

1. A room includes itself, `core` and rooms above it in ROOMS, never below.
2. Only `ros` and `benchmark` may include ROS (and any other library); the other rooms include the standard library,
   Eigen and, in sources and private headers only (src/), PRIVATE_LIBRARIES and OPERATING_SYSTEM.
3. The core library links nothing but LINKED: ROS headers and libraries lie in the system's own directories, so the
   compiler and linker would not object.
"""

import argparse
import pathlib
import re
import subprocess
import sys

ROOMS = ["core", "scene", "instrument", "tissue", "contact", "friction", "solver", "simulation", "validation", "tools",
         "ros", "benchmark"]
ROS_ROOMS = {"ros", "benchmark"}
PRIVATE_LIBRARIES = {"fcl", "urdf_model", "urdf_parser", "urdf_world", "console_bridge", "assimp", "yaml-cpp"}
OPERATING_SYSTEM = {"fcntl.h", "sys", "unistd.h"}
LINKED = re.compile(r"^(lib(fcl|urdfdom_model|console_bridge|assimp|yaml-cpp|stdc\+\+|gcc_s|m|c)|ld-linux.*)\.so(\.[0-9.]+)?$")

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def room_violation(room, target_room):
    """Why `room` may not include `target_room`, or None."""
    if target_room not in ROOMS:
        return f"'{target_room}' is no room (rooms: {', '.join(ROOMS)})"
    if ROOMS.index(target_room) > ROOMS.index(room):
        return f"room '{room}' is above '{target_room}' and must not include it"
    return None


def include_violation(room, is_public, quote, target):
    """Why a file of `room` may not include `target`, or None."""
    parts = target.split("/")
    if ".." in parts:
        return "write the path from the root of the rooms, without '..'"
    if parts[0] == "tissue_contact":
        if len(parts) > 2:
            return room_violation(room, parts[1])
        return None if room in ROS_ROOMS else "generated messages belong to the ros room"
    if quote == '"':  # a private header: of this room ("x.h") or by room ("tissue/x.h")
        if is_public:
            return "a public header includes public headers only, as tissue_contact/<room>/<file>"
        return room_violation(room, parts[0]) if len(parts) > 1 else None
    if room in ROS_ROOMS or parts[0] in ("Eigen", "unsupported"):
        return None
    if len(parts) == 1 and "." not in target:
        return None  # standard library
    if parts[0] not in PRIVATE_LIBRARIES | OPERATING_SYSTEM:
        return f"room '{room}' may use Eigen, {', '.join(sorted(PRIVATE_LIBRARIES))} and the standard library"
    return f"'{parts[0]}' in a public header; only sources and headers below src/ may use it" if is_public else None


def check_sources(source):
    """Violations of rules 1 and 2 in the tree at `source`, and the number of files read."""
    violations, files = [], 0
    for top, is_public in (("include/tissue_contact", True), ("src", False)):
        for path in sorted((source / top).rglob("*")):
            if path.suffix not in (".h", ".hpp", ".cpp"):
                continue
            files += 1
            name = path.relative_to(source)
            room = path.relative_to(source / top).parts[0]
            if room not in ROOMS:
                violations.append(f"{name}: lies in no room (rooms: {', '.join(ROOMS)})")
                continue
            text = path.read_text(encoding="utf-8")
            for match in INCLUDE.finditer(text):
                problem = include_violation(room, is_public, match[1], match[2])
                if problem:
                    line = text.count("\n", 0, match.start()) + 1
                    violations.append(f"{name}:{line}: #include of {match[2]}: {problem}")
    return violations, files


def check_linked(dynamic_section):
    """Violations of rule 3 in the output of `readelf -d`."""
    needed = re.findall(r"\(NEEDED\).*\[(.+)\]", dynamic_section)
    if not needed:
        return ["the core library needs no library at all: this cannot be its dynamic section"]
    return [f"the core library links {name}" for name in needed if not LINKED.match(name)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--source", type=pathlib.Path, required=True, help="root of the package")
    parser.add_argument("--library", required=True, help="the core library that was built")
    arguments = parser.parse_args()

    violations, files = check_sources(arguments.source)
    if files == 0:
        violations.append(f"no source found in {arguments.source}")
    readelf = subprocess.run(["readelf", "-d", arguments.library], check=True, capture_output=True, text=True)
    violations += check_linked(readelf.stdout)
    for violation in violations:
        print(violation)
    print(f"{files} files, {len(violations)} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
