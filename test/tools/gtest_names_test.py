#!/usr/bin/python3
"""Each gtest of each executable is run by one ctest and one only.

usage: gtest_names_test.py CTEST BUILD
"""
import collections
import re
import subprocess
import sys
import unittest

CTEST, BUILD = sys.argv[1:]


def output(*command):
    return subprocess.run(command, cwd=BUILD, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout


def gtests(executable, *arguments):
    names, suite = [], ""
    for line in output(executable, "--gtest_list_tests", *arguments).splitlines():
        word = line.split()[0]
        if line.startswith("  "):
            names.append(suite + word)
        elif word.endswith("."):
            suite = word
    return names


class GtestNamesTest(unittest.TestCase):
    def test_each_is_run_once(self):
        runs = re.findall(r"(/\S+) '(--gtest_filter=[^']*)'", output(CTEST, "-N", "-V"))
        self.assertGreater(len(runs), 100)
        for executable in sorted({executable for executable, _ in runs}):
            run = collections.Counter(name for other, choice in runs if other == executable for name in gtests(other, choice))
            there = collections.Counter(gtests(executable))
            self.assertGreater(len(there), 0, executable)
            self.assertEqual(there, run, executable)
            self.assertEqual([name for name, count in there.items() if count > 1], [], executable)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
