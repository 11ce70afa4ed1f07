#!/usr/bin/python3
"""Prints how far the forces of the recorded dVRK sweep over config/psm_dvrk.yaml are off with other cells and tolerances, against cells of 1 mm, what
each replay expects of itself, and what it takes of a processor (doc/notes/accuracy.md). Some five minutes.

usage, after `source scripts/env.bash`: benchmark/drivers/sweep_cells.py psm2_classic_motion.bag
"""
import csv
import math
import os
import resource
import subprocess
import sys
import tempfile

SCENE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "config", "psm_dvrk.yaml")
CELL, TOLERANCE = "tissues.slab.refinement.cell_m", "solver.tolerance"
REFERENCE = {CELL: 0.001, "tissues.slab.refinement.nodes_at_most": 12000, TOLERANCE: 0.001}
ROWS = [dict({TOLERANCE: 1e-4}, **row)
        for row in ({}, {CELL: 0.003}, {CELL: 0.002, TOLERANCE: 0.01}, {CELL: 0.002}, {CELL: 0.0015}, {"tissues.slab.refinement": "auto"})]
AXES = ["force_x_n", "force_y_n", "force_z_n"]


def replay(bag, settings, folder):
    """(rows of the table, processor time in s)"""
    table = os.path.join(folder, "out.csv")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(["rosrun", "tissue_contact", "tissue_contact_replay", "--scene", SCENE, "--bag", bag, "--from", "11", "--duration", "10", "--csv", table] +
                   ["--set=%s=%s" % one for one in settings.items()], check=True, stderr=subprocess.DEVNULL)
    took_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with open(table, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream)), took_s


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        truth, _ = replay(sys.argv[1], REFERENCE, folder)
        size = sum(float(row[axis]) ** 2 for row in truth for axis in AXES)
        print("| settings | found | expected | processor, s | intervals with elements inside out, of those with force |\n|---|---|---|---|---|")
        for settings in ROWS:
            rows, took_s = replay(sys.argv[1], settings, folder)
            off = sum((float(row[axis]) - float(true[axis])) ** 2 for row, true in zip(rows, truth) for axis in AXES)
            expected = sum(float(row["force_error_n"]) ** 2 for row in rows)
            print("| %s | %.1f %% | %.0f %% | %.1f | %d of %d |" % (
                ", ".join("`%s=%s`" % one for one in settings.items()) or "as shipped", 100 * math.sqrt(off / size), 100 * math.sqrt(expected / size), took_s,
                sum(int(row["inverted_elements"]) > 0 for row in rows), sum(any(float(row[axis]) for axis in AXES) for row in rows)), flush=True)


if __name__ == "__main__":
    main()
