"""Replays one after the other in one process, and what is measured of each. Standard library alone: a job starts in no time."""
import csv
import hashlib
import json
import math
import operator
import os
import subprocess
import tempfile

DOUBTS = ["discarded", "jumped", "implausible_load", "inverted_elements"]  # where they are not 0, the force is not to be trusted
COLUMNS = ["instrument", "static_contacts", "kinetic_contacts", *DOUBTS, "force_x_n", "force_y_n", "force_z_n", "torque_x_nm",
           "torque_y_nm", "torque_z_nm", "force_error_n", "solver_error_n", "simulated_s"]  # of a replay's CSV, that are looked at


class Replayer:
    """`tissue_contact_replay --batch -`, started again after a variant that ended it."""

    def __init__(self, program, log=subprocess.DEVNULL):
        self._program, self._log, self._process = program, log, None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._process:
            self._process.stdin.close()
            self._process.stdout.close()
            self._process.wait()

    def run(self, arguments):
        """(CPU seconds, None), or (.., what was wrong); CrashError if the process ended or the machine did not suffice."""
        if not self._process:
            self._process = subprocess.Popen([self._program, "--batch", "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._log,
                                             encoding="utf-8", errors="replace")
        try:
            self._process.stdin.write("\t".join(arguments) + "\n")
            self._process.stdin.flush()
            words = self._process.stdout.readline().rstrip("\n").split("\t", 2)
        except BrokenPipeError:
            words = []
        if words[0:1] == ["broken"]:
            raise CrashError(words[2])
        if words[0:1] not in (["ok"], ["failed"]):
            process, self._process = self._process, None
            process.stdout.close()
            code = process.wait()
            raise CrashError("the replay ended by signal %d" % -code if code < 0 else "the replay ended with exit code %d" % code)
        return float(words[1]), words[2] if words[0] == "failed" else None


class CrashError(Exception):
    """The process of a replay ended, or its results could not be written: the machine may be at fault, so it is tried again when the sweep is."""


class Measures:
    """Of one instrument. An implicit step holds its force from the state before to the one at which it is told, so a sum over
    intervals is the impulse that the simulation has transferred."""

    def __init__(self):
        self.before_s = None  # simulated
        self.was_held = False
        self.peak = {"force_n": 0.0, "torque_nm": 0.0}
        self.impulse = {"force_n": 0.0, "torque_nm": 0.0}
        self.squares = {"force_error_n": 0.0, "solver_error_n": 0.0}
        self.contact_s = 0.0
        self.slips = 0
        self.doubts = dict.fromkeys(DOUBTS, 0)  # intervals

    def add(self, _, held, sliding, *numbers):
        """Of COLUMNS."""
        doubts, numbers = numbers[:len(DOUBTS)], numbers[len(DOUBTS):]
        *numbers, simulated_s = map(float, numbers)
        # Not of stamps: a pause is simulated as step.max_gap_s. 0 again after a reset.
        interval = simulated_s - self.before_s if self.before_s is not None and simulated_s > self.before_s else 0.0
        self.before_s = simulated_s
        for kind, size in zip(self.peak, (math.hypot(*numbers[:3]), math.hypot(*numbers[3:6]))):
            self.peak[kind] = max(self.peak[kind], size)
            self.impulse[kind] += size * interval
        held, sliding = int(held), int(sliding)
        self.slips += self.was_held and not held and sliding > 0
        self.was_held = held > 0
        for name, value in zip(DOUBTS, doubts):
            self.doubts[name] += interval > 0.0 and int(value) > 0  # without a step a row repeats what was told before
        if held or sliding:
            self.contact_s += interval
            for name, error in zip(self.squares, numbers[6:]):
                self.squares[name] += error ** 2 * interval

    def result(self):
        def over_contact(value):
            return value / self.contact_s if self.contact_s else 0.0
        return {
            "peak_force_n": self.peak["force_n"], "mean_force_n": over_contact(self.impulse["force_n"]), "impulse_n_s": self.impulse["force_n"],
            "peak_torque_nm": self.peak["torque_nm"], "mean_torque_nm": over_contact(self.impulse["torque_nm"]),
            "angular_impulse_nm_s": self.impulse["torque_nm"], "contact_time_s": self.contact_s, "slips": self.slips,
            "likely_error_n": math.sqrt(over_contact(self.squares["force_error_n"])),
            "solver_error_n": math.sqrt(over_contact(self.squares["solver_error_n"])), **self.doubts}


MEASURES = list(Measures().result())


def measured(text):
    """{instrument: measures} of a replay's CSV."""
    instruments = {}
    lines = csv.reader(text.splitlines())
    columns = next(lines)
    pick = operator.itemgetter(*[columns.index(name) for name in COLUMNS])
    for line in lines:
        row = pick(line)
        instruments.setdefault(row[0], Measures()).add(*row)
    return {name: one.result() for name, one in instruments.items()}


def result_of(replayer, arguments, file):
    """What the table tells of a variant."""
    try:
        cpu_s, problem = replayer.run(arguments + ["--csv=" + file])
    except CrashError as error:
        return {"crashed": str(error)}
    if problem is not None:
        return {"error": problem, "cpu_time_s": cpu_s}
    with open(file, "rb") as stream:
        data = stream.read()
    return {"cpu_time_s": cpu_s, "sha256": hashlib.sha256(data).hexdigest(), "instruments": measured(data.decode("ascii"))}


def run_all(program, variants, kept_folder=None, log=subprocess.DEVNULL):
    """Yields the result of each of [{"key":, "arguments":}], with its key. CSV files are kept as KEY.csv in a folder, if there is one."""
    memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None  # a result that is read once need not reach a disk
    with tempfile.TemporaryDirectory(prefix="tissue_contact_sweep-", dir=memory) as folder, Replayer(program, log) as replayer:
        for variant in variants:
            file = os.path.join(kept_folder or folder, variant["key"] + ".csv")
            result = result_of(replayer, variant["arguments"], file)
            if not kept_folder and os.path.exists(file):
                os.remove(file)
            yield dict(key=variant["key"], **result)


def read_results(file):
    """{key: result} of a file of results; a last line that a kill cut off is none."""
    results = {}
    try:
        stream = open(file, encoding="utf-8")
    except FileNotFoundError:  # a job whose sweep was killed has ended meanwhile
        if not file.endswith(".part"):
            raise
        stream = open(file[:-len(".part")], encoding="utf-8")
    with stream:
        for line in stream:
            if not line.endswith("\n"):
                continue
            try:
                result = json.loads(line)
                results[result["key"]] = result
            except (ValueError, KeyError, TypeError):
                continue  # damaged: as if it were not there
    return results
