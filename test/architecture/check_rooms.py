#!/usr/bin/python3
"""Checks the rules that keep the rooms apart; exits 1 and prints one line per violation.

1. A room of the product includes itself and rooms before it in ROOMS, never after.
2. Only ROS_ROOMS may include ROS (and any other library); the other rooms include the standard library, Eigen and, in
   sources and private headers only (src/), PRIVATE_LIBRARIES and OPERATING_SYSTEM.
3. What uses and measures the product (MEASURING) may include all of it and test/support; the product knows nothing of that.
4. A public header (include/) is one that another room of the product or a public header includes, or one of API, which other
   packages include. What measures the product takes private ones as they lie in src/.
5. The core library links nothing but LINKED: ROS headers and libraries lie in the system's own directories, so the
   compiler and linker would not object.
"""

import argparse
import pathlib
import re
import subprocess
import sys

ROOMS = ["core", "mesh", "instrument", "tissue", "contact", "friction", "solver", "baselines", "simulation", "scene", "ros"]
MEASURING = ["python", "validation", "benchmark"]
ROS_ROOMS = {"ros", "python", "benchmark"}
API = {"ros/environment.h", "ros/lock_step.h", "scene/load_scene.h", "simulation/joint_state_player.h", "simulation/simulator.h"}
PRIVATE_LIBRARIES = {"fcl", "urdf_model", "urdf_parser", "urdf_world", "console_bridge", "assimp", "yaml-cpp"}
OPERATING_SYSTEM = {"fcntl.h", "sys", "unistd.h"}
LINKED = re.compile(r"^(lib(pthread|fcl|urdfdom_model|console_bridge|assimp|yaml-cpp|stdc\+\+|gcc_s|m|c)|ld-linux.*)\.so(\.[0-9.]+)?$")

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def room_violation(room, target_room):
    """Why `room` may not include `target_room`, or None."""
    if room in MEASURING:
        known = ROOMS + MEASURING[:MEASURING.index(room) + 1] + ["support"]
        return None if target_room in known else f"'{target_room}' is nothing that '{room}' may include"
    if target_room not in ROOMS:
        return f"'{target_room}' is no room of the product (rooms: {', '.join(ROOMS)})"
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
    if quote == '"':  # a private header by its room: "tissue/x.h", "contact/shape/x.h"
        if is_public:
            return "a public header includes public headers only, as tissue_contact/<room>/<file>"
        return room_violation(room, parts[0]) if len(parts) > 1 else "write the path from the room on: \"room/x.h\""
    if room in ROS_ROOMS or parts[0] in ("Eigen", "unsupported"):
        return None
    if len(parts) == 1 and "." not in target:
        return None  # standard library
    if parts[0] not in PRIVATE_LIBRARIES | OPERATING_SYSTEM:
        return f"room '{room}' may use Eigen, {', '.join(sorted(PRIVATE_LIBRARIES))} and the standard library"
    return f"'{parts[0]}' in a public header; only sources and headers below src/ may use it" if is_public else None


def sources(source):
    """Each C++ file of the rooms: its room, whether it is public, its path and its text."""
    for top, is_public in (("include/tissue_contact", True), ("src", False), *((name, None) for name in MEASURING)):
        for path in sorted((source / top).rglob("*")):
            if path.suffix in (".h", ".hpp", ".cpp") and not (is_public is None and "drivers" in path.parts):
                room = top if is_public is None else path.relative_to(source / top).parts[0]
                yield room, bool(is_public), path, path.read_text(encoding="utf-8")


def check_sources(source):
    """Violations of rules 1 to 3 in the tree at `source`, and the number of files read."""
    violations, files = [], 0
    for room, is_public, path, text in sources(source):
        files += 1
        name = path.relative_to(source)
        if room not in ROOMS + MEASURING:
            violations.append(f"{name}: lies in no room (rooms: {', '.join(ROOMS)})")
            continue
        for match in INCLUDE.finditer(text):
            problem = include_violation(room, is_public, match[1], match[2])
            if problem:
                line = text.count("\n", 0, match.start()) + 1
                violations.append(f"{name}:{line}: #include of {match[2]}: {problem}")
    return violations, files


def check_public(source):
    """Violations of rule 4."""
    needed, public = set(API), set()
    for room, is_public, path, text in sources(source):
        if is_public:
            public.add(path.relative_to(source / "include/tissue_contact").as_posix())
        for match in INCLUDE.finditer(text) if room in ROOMS else ():
            target = match[2][len("tissue_contact/"):]
            if match[2].startswith("tissue_contact/") and (is_public or target.split("/")[0] != room):
                needed.add(target)
    return [f"include/tissue_contact/{name}: only its own room includes it; it belongs into src/"
            for name in sorted(public - needed)]


def check_linked(dynamic_section):
    """Violations of rule 5 in the output of `readelf -d`."""
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
    violations += check_public(arguments.source)
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
