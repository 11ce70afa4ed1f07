#!/usr/bin/python3
"""Regenerates doc/validation.md and its pictures: runs every validation case, the speed-against-error benchmark and the
table of what the model advisor leaves out.

usage, after scripts/build:   . scripts/env.bash; scripts/make_validation_doc.py [--robot-bag FILE] [--out DIR] [--quick] [--reuse]
  --robot-bag FILE  recorded dVRK joint states for psm_dvrk.yaml and psm_palpation.yaml (default: dvrk/psm2_classic_motion.bag of
                    TISSUE_CONTACT_SHARED_DATA or ../shared/data, where it is there)
  --out DIR         where raw results go (default: validation, in the build directory)
  --quick           the coarse grid of tissue_contact_benchmark: a minute instead of half an hour
  --reuse           do not run again what has its results in DIR; the document names the commit each was made with
Takes three quarters of an hour to an hour. Nothing else should run meanwhile: times are wall times.
"""
import argparse
import csv
import json
import math
import os
import shutil
import subprocess
import sys

import rosbag
import yaml

from whole_file import whole_file

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
SCENES = {
    "press-drag": "Press and drag",
    "grasp": "Grasp with PSM jaws",
    "partial-slip": "Partial slip under a sphere",
    "robot": "Recorded dVRK PSM touches a pad",
    "robot-sweep": "Recorded dVRK PSM sweeps through a slab",
}


def fail(message):
    sys.exit("make_validation_doc.py: " + message)


def output(*command):
    try:
        return subprocess.run(command, cwd=PACKAGE, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError) as error:
        fail("%s: %s" % (" ".join(command), getattr(error, "stderr", "") or error))


def program(build, name):
    file = os.path.join(build, "devel", "lib", "tissue_contact", name)
    if not os.access(file, os.X_OK):
        fail("%s is not built; run scripts/build" % file)
    return file


def machine(build):
    """(what, value) of what the figures were made with."""
    model, flags = "unknown", {}
    with open("/proc/cpuinfo", encoding="utf-8") as stream:
        for line in stream:
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
    with open(os.path.join(build, "CMakeCache.txt"), encoding="utf-8") as stream:
        for line in stream:
            name, _, value = line.strip().partition("=")
            flags[name.split(":")[0]] = value
    compiler = output(flags["CMAKE_CXX_COMPILER"], "--version").splitlines()[0]
    build_type = flags.get("CMAKE_BUILD_TYPE", "")
    options = flags.get("CMAKE_CXX_FLAGS_" + build_type.upper(), "")
    return [
        ("processor", "%s, %d cores (one is used)" % (model, os.cpu_count())),
        ("compiler", "%s, %s (%s)" % (compiler, build_type, options)),
    ]


def commit():
    changed = " with uncommitted changes" if output("git", "status", "--porcelain", "--untracked-files=no") else ""
    return output("git", "log", "-1", "--format=%h of %cs") + changed


def made_with(files):
    """The commits of results, one line where they agree."""
    commits = {}
    for what, file in files.items():
        with open(file + ".commit", encoding="utf-8") as stream:
            commits.setdefault(stream.read().strip(), []).append(what)
    if len(commits) == 1:
        return next(iter(commits))
    return "; ".join("%s: %s" % (", ".join(what), name) for name, what in commits.items())


def number(value, digits=4):
    return "" if value is None or math.isnan(value) else "%.*g" % (digits, value)


def cell(text):
    return str(text).replace("|", "\\|")


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(cell(c) for c in row) + " |" for row in rows])


def check_row(check):
    near = check["kind"] == "near"
    sign = {"near": "", "at_most": "\u2264 ", "at_least": "\u2265 "}[check["kind"]]
    error = check["got"] - check["expected"] if near and check["got"] is not None else None
    return [check["quantity"], check["unit"], sign + number(check["expected"]), number(check["got"]), number(error, 2),
            number(check["tolerance"], 2) if near else "", "pass" if check["passed"] else "**FAIL**", check["source"]]


def study_text(study):
    levels = ", ".join("%s: %s" % (number(size, 3), number(value)) for size, value in study["levels"])
    return "%s over %s (limit %s %s): %s. Observed order %s." % (
        study["quantity"], study["parameter"], number(study["limit"]), study["unit"], levels,
        number(study["observed_order"], 2) or "none")


def validation_section(results):
    cases = results["cases"]
    passed = sum(case["passed"] for case in cases)
    parts = ["## Closed forms and hard cases", "%d of %d cases pass, %d checks." % (
        passed, len(cases), sum(len(case["checks"]) for case in cases))]
    for case in cases:
        parts.append("### `%s`: %s" % (case["name"], case["title"]))
        if case["failure"]:
            parts.append("**Stopped:** " + case["failure"])
        if case["checks"]:
            head = ["quantity", "unit", "expected", "got", "error", "tolerance", "", "source"]
            parts.append(table(head, [check_row(check) for check in case["checks"]]))
        for text in [study_text(study) for study in case["studies"]] + case["notes"]:
            parts.append("- " + text)
    return parts


def read_rows(file):
    with open(file, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def percent(text):
    return "%.3g" % (100.0 * float(text)) if text else ""


def speed_row(row):
    most = row["iterations"] + " \u00d7 " + row["contact_passes"] if row["contact_passes"] else ""
    settings = "%g, at most %s" % (float(row["tolerance"]), most) if row["tolerance"] not in ("", "0") else most
    name = " ".join(filter(None, [row["method"], row["relaxation"]]))
    return ["**%s**" % name if row["shipped"] == "1" else name, settings, row["nodes"],
            "%g" % (1e3 * float(row["dt_s"])), "%.3g" % float(row["median_ms"]), "%.3g" % float(row["p99_ms"]),
            "%.3g" % float(row["max_ms"]), "%.0f" % float(row["steps_per_s"]), "%.2g" % float(row["realtime_factor"]),
            percent(row["solver_error"]), percent(row["total_error"]), percent(row["met_tolerance"])]


SPEED_HEAD = ["solver", "stops at; iterations \u00d7 passes", "nodes", "dt, ms", "median, ms", "p99", "max", "steps/s", "\u00d7 real time",
              "solver error, %", "total error, %", "steps that met it, %"]


def speed_section(folder):
    parts = ["## Speed against error",
             "Time per step on one core against the RMS error of the wrench over the run, in per cent of its RMS. *Solver "
             "error*: against the same mesh and step solved to convergence. *Total error*: against a stored truth or a "
             "finer mesh. Bold: as shipped. Made by `tissue_contact_benchmark`; errors are the same in every run, times "
             "are this machine's."]
    with open(os.path.join(folder, "summary.txt"), encoding="utf-8") as stream:
        parts.append("```\n" + stream.read().strip("\n") + "\n```")
    for scene, title in SCENES.items():
        file = os.path.join(folder, scene + ".csv")
        if not os.path.exists(file):
            parts.append("### %s\n\nNot run: no recording was given." % title)
            continue
        parts.append("### " + title)
        if os.path.exists(os.path.join(folder, scene + ".png")):
            parts.append("![%s: time per step against solver and total error](%s.png)" % (title, scene))
        parts.append(table(SPEED_HEAD, [speed_row(row) for row in read_rows(file)]))
    if os.path.exists(os.path.join(folder, "growth.png")):
        parts.append("### Growth with the mesh\n\n![Time and error of press and drag over nodes](growth.png)")
    return parts


def advisor_section(file):
    rows = read_rows(file)
    head = list(rows[0])
    text = ("Each scene with each choice of the advisor off and on: processor time per step, what it adds to the wrench (RMS of "
            "the force over the run, relative), and the bound stated for it. Sleep is off while another choice is measured. "
            "Made by `benchmark/drivers/advisor.cpp`.")
    return ["## What a scene does not need", text,
            table([name.replace("_", " ") for name in head], [[row[name] for name in head] for row in rows])]


def run(command, result, reuse, may_fail=False, stdout=None):
    """Runs what makes `result`; `result`.commit, written last, says that it is whole."""
    if reuse and os.path.exists(result) and os.path.exists(result + ".commit"):
        return
    made = commit()
    if os.path.exists(result + ".commit"):
        os.remove(result + ".commit")
    print(" ".join(command), flush=True)
    code = subprocess.run(command, check=False, stdout=stdout).returncode
    if code != 0 and not (may_fail and code == 1):
        fail("%s ended with exit code %d" % (command[0], code))
    with open(result + ".commit", "w", encoding="utf-8") as stream:
        stream.write(made + "\n")


def write_path(bag_file, csv_file):
    """Two dips of the recorded arm as a table of joint positions, for benchmark/drivers/advisor.cpp: the benchmark's, seen to their end."""
    begin, end = 14.1, 19.1  # s from the first joint state
    with open(os.path.join(PACKAGE, "config", "psm_dvrk.yaml"), encoding="utf-8") as stream:
        instrument = yaml.safe_load(stream)["instruments"][0]
    names = instrument["joint_names"]
    first = None
    with rosbag.Bag(bag_file) as bag, open(csv_file, "w", newline="", encoding="ascii") as stream:
        writer = csv.writer(stream)
        for _, message, _ in bag.read_messages(topics=instrument["joint_state_topics"]):
            stamp = message.header.stamp.to_sec()
            if first is None:
                first = stamp
                writer.writerow(["time_s"] + [names.get(name, name) for name in message.name])
            if begin <= stamp - first <= end:
                writer.writerow([stamp - first - begin] + list(message.position))


def run_advisor(build, robot_bag, result, reuse):
    if reuse and os.path.exists(result) and os.path.exists(result + ".commit"):
        return
    command = [os.path.join(build, "benchmark", "drivers", "advisor")]
    if robot_bag:
        path = os.path.join(os.path.dirname(result), "psm_path.csv")
        write_path(robot_bag, path)
        command += ["--psm", path]
    with open(result, "w", encoding="ascii") as stream:
        run(command, result, False, stdout=stream)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    data = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or os.path.join(PACKAGE, "..", "shared", "data")
    parser.add_argument("--robot-bag", default=os.path.join(data, "dvrk", "psm2_classic_motion.bag"))
    parser.add_argument("--out")
    parser.add_argument("--reuse", action="store_true")
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()

    build = output(os.path.join(PACKAGE, "scripts", "build"), "--where")
    out = arguments.out or os.path.join(build, "validation")
    os.makedirs(out, exist_ok=True)
    output("cmake", "--build", build, "--target", "tissue_contact_validate", "tissue_contact_benchmark", "advisor")
    results_file = os.path.join(out, "validation.json")
    # A case that fails is a result as well, exit code 1; the document says so.
    run([program(build, "tissue_contact_validate"), "--json", results_file], results_file, arguments.reuse, True)
    robot_bag = arguments.robot_bag if os.path.exists(arguments.robot_bag) else ""
    speed = [program(build, "tissue_contact_benchmark"), "--out", out]
    speed += ["--robot-bag", robot_bag] if robot_bag else []
    speed += ["--quick"] if arguments.quick else []
    speed_file = os.path.join(out, "summary.txt")
    run(speed, speed_file, arguments.reuse)
    advisor_file = os.path.join(out, "advisor.csv")
    run_advisor(build, robot_bag, advisor_file, arguments.reuse)

    with open(results_file, encoding="utf-8") as stream:
        results = json.load(stream)
    parts = ["# Validation, measured", "Generated by `scripts/make_validation_doc.py`; do not edit.",
             table(["", ""], [("commit", made_with({"cases": results_file, "speed": speed_file, "advisor": advisor_file}))] +
                   machine(build))]
    if arguments.quick:
        parts.append("Speed against error: the quick grid, with fewer settings and meshes than the full one.")
    parts += validation_section(results) + speed_section(out) + advisor_section(advisor_file)
    doc = os.path.join(PACKAGE, "doc")
    with whole_file(os.path.join(doc, "validation.md")) as part, open(part, "w", encoding="utf-8") as stream:
        stream.write("\n\n".join(parts) + "\n")
    for name in list(SCENES) + ["growth"]:
        picture = os.path.join(out, name + ".png")
        if os.path.exists(picture):
            shutil.copy(picture, doc)
    print("written: doc/validation.md")
    return 0 if results["passed"] else 1


if __name__ == "__main__":
    sys.exit(main())
