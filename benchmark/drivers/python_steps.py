#!/usr/bin/python3
"""What a step costs from Python, over what it costs in C++: the same scene and motion, in turns, median of the ratios of processor times.

usage, after `source scripts/env.bash` and `make -C "$(scripts/build --where)" python_steps`:
    benchmark/drivers/python_steps.py "$(scripts/build --where)/benchmark/drivers/python_steps" [PAIRS]
"""
import statistics
import subprocess
import sys
import time

import tissue_contact as tc

ONCE = "--once"


def steps():
    """Processor time (s), and the sum of the forces (N)."""
    simulator = tc.Simulator(tc.load_scene("package://tissue_contact/config/press_drag.yaml"))
    sum_n, before = 0.0, time.thread_time()
    for k in range(1, 701):
        path = 0.00002 * k
        simulator.advance(0.001, {"probe": [max(path - 0.004, 0.0), 0.0, -0.01 - min(path, 0.004)]})
        sum_n += simulator.wrench("probe")[2]
    return time.thread_time() - before, sum_n


def run(*command):
    """Of a process of its own, whose memory is new to it."""
    return tuple(map(float, subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()))


def main():
    if sys.argv[1:] == [ONCE]:
        return print("%.6f %.17g" % steps())
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    ratios, times = [], []
    for pair in range(int(sys.argv[2]) if len(sys.argv) == 3 else 11):
        python, cpp = [sys.executable, __file__, ONCE], [sys.argv[1]]
        first, second = (run(*python), run(*cpp)) if pair % 2 else (run(*cpp), run(*python))[::-1]
        if first[1] != second[1]:
            sys.exit("not the same forces: %.17g N from Python, %.17g N from C++" % (first[1], second[1]))
        ratios.append(first[0] / second[0])
        times.append(second[0] / 700)
    print("Python / C++: median %.3f, from %.3f to %.3f; a step %.3f ms" %
          (statistics.median(ratios), min(ratios), max(ratios), 1e3 * statistics.median(times)))


if __name__ == "__main__":
    main()
