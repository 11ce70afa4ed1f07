#!/usr/bin/python3
"""Replays a study: many recordings, scenes and values of their keys, to one table and pictures. doc/sweep.md.

A run that is killed goes on where it was; of a study that was changed only what is new is run."""
import argparse
import contextlib
import fcntl
import hashlib
import importlib.metadata
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import yaml

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
from replays import read_results, run_all
from study import Study, StudyError, Variant
from table import write_pictures, write_table

MOST_JOBS = 4000  # of a run: a scheduler of a cluster bears some thousand
LOG = "snakemake.log"
WRONG_KEY = re.compile(r'unknown key|has no element|; it has no "|is no path of keys|would undo')
BAD_BAG = "bag '"  # of a problem: the bag's own, not the scene's


class SweepError(Exception):
    """Why a sweep cannot go on, for people."""


def fold(*parts):
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


# ---------------------------------------------------------------------------------------------- what a variant depends on


def sha256_of(file):
    digest = hashlib.sha256()
    with open(file, "rb") as stream:
        for part in iter(lambda: stream.read(1 << 20), b""):
            digest.update(part)
    return digest.hexdigest()


class Inputs:
    """Hashes of all that a replay reads, by asking the replay for the manifest of its first moment, or of all where that has nothing of the
    robot: of each scene with each choice of settings that are no numbers, since such a setting may name another file."""

    def __init__(self, program, study):
        self._program, self._study = program, study
        self._bags = {bag: sha256_of(bag) for bag in study.bags}
        self._measures = sha256_of(os.path.join(HERE, "replays.py"))
        self._scenes = {}

    def key(self, variant):
        return fold(self._scene(variant), self._bags[variant.bag], variant.settings, self._study.options, self._measures)[:32]

    def _scene(self, variant):
        words = tuple((key, value) for key, value in variant.settings if not re.fullmatch(r"[-+\d.eE]+", value))
        chosen = (variant.scene, words)
        if chosen not in self._scenes:
            found, problem = self._ask(variant)
            if problem and not WRONG_KEY.search(problem):  # of its numbers, perhaps: that is for the table
                found, problem = self._ask(Variant(variant.scene, variant.bag, list(words)))
            if problem:
                raise StudyError("%s: %s" % (self._study.file, problem))
            self._scenes[chosen] = found
        return self._scenes[chosen]

    def _ask(self, variant):
        """(hash, what is wrong). By another bag where one is at fault: that is for the table. By all of it where its first joint state is, which may be
        of another robot."""
        first = None
        for bag, duration_s in [(variant.bag, "1e-9"), (variant.bag, "1e9")] + [(bag, "1e-9") for bag in self._study.bags if bag != variant.bag]:
            if duration_s == "1e9":
                print("sweep: %s tells nothing of the scene by its first moment: it is replayed whole" % bag, flush=True)
            found, problem = self._hash_by(Variant(variant.scene, bag, variant.settings), duration_s)
            if not problem or BAD_BAG not in problem:
                return found, problem
            first = first or problem
        return None, first

    def _hash_by(self, variant, duration_s):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "manifest.yaml")
            arguments = [one for one in arguments_of(self._study, variant) if not one.startswith(("--from", "--duration"))]
            arguments += ["--duration=" + duration_s, "--manifest=" + file]
            result = next(run_all(self._program, [{"key": "first", "arguments": arguments}]))
            if "sha256" not in result:
                return None, result.get("error") or result["crashed"]
            with open(file, encoding="utf-8") as stream:
                manifest = yaml.load(stream, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        # In the order in which they are read, which tells who uses which.
        files = [(one["role"], one["sha256"]) for part in ("program", "inputs") for one in manifest[part] if one["role"] != "--bag"]
        return fold(files, manifest["versions"].get("gmsh")), None


def arguments_of(study, variant):
    return ["--scene=" + variant.scene, "--bag=" + variant.bag] + study.options + variant.arguments()


# ---------------------------------------------------------------------------------------------- the folder of a sweep


class Folder:
    """jobs/, results/, plan.json: what Snakemake works on; the table and pictures."""

    def __init__(self, path):
        self.path = path
        for name in ["jobs", "results", "csv"]:
            os.makedirs(os.path.join(path, name), exist_ok=True)
        self._lock = open(os.path.join(path, ".lock"), "w", encoding="utf-8")  # Snakemake inherits it: held until that has ended too
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise SweepError("another sweep still runs in %s; wait for it, end it, or give another --out" % path) from error
        os.set_inheritable(self._lock.fileno(), True)

    def file(self, *names):
        return os.path.join(self.path, *names)

    def result_files(self):
        return [self.file("results", name) for name in sorted(os.listdir(self.file("results"))) if name.endswith((".jsonl", ".jsonl.part"))]

    def results(self):
        """Those that need not be run again. A crash is none: the machine may have been at fault."""
        results = {}
        for file in self.result_files():
            results.update((key, one) for key, one in read_results(file).items() if "crashed" not in one)
        return results

    def missing(self, study, keyed):
        """[(key, variant)] of those that are not done, or whose CSV is to be kept and is not there. A refused one has none."""
        results, kept = self.results(), set(os.listdir(self.file("csv")))

        def is_done(key):
            return key in results and (not study.keep_csv or "error" in results[key] or key + ".csv" in kept)
        return [(key, variant) for key, variant in dict(keyed).items() if not is_done(key)]

    def crashes(self):
        return {key: one for file in self.result_files() for key, one in read_results(file).items() if "crashed" in one}

    def next_run(self):
        return 1 + max([int(os.path.basename(file).partition("-")[0]) for file in self.result_files()], default=0)


def plan(folder, study, program, variants, keep_csv):
    """Writes the jobs of a run. @return {job: how many variants}."""
    old = [folder.file("jobs", name) for name in os.listdir(folder.file("jobs"))]
    old += [folder.file("results", name) for name in os.listdir(folder.file("results")) if name.endswith(".log")]
    for file in old:
        os.remove(file)
    run, size = folder.next_run(), per_job(len(variants), study.per_job)
    jobs = {}
    for i in range(0, len(variants), size):
        job = "%04d-%05d" % (run, i // size)
        jobs[job] = len(variants[i:i + size])
        content = {"program": program, "kept_folder": folder.file("csv") if keep_csv else None,
                   "variants": [{"key": key, "arguments": arguments_of(study, variant)} for key, variant in variants[i:i + size]]}
        with open(folder.file("jobs", job + ".json"), "w", encoding="utf-8") as stream:
            json.dump(content, stream)
    with open(folder.file("plan.json"), "w", encoding="utf-8") as stream:
        json.dump({"jobs": list(jobs), "run_job": os.path.join(HERE, "run_job.py")}, stream)
    return jobs


def per_job(variants, wanted):
    """Some 100 jobs, since each costs a quarter of a second; fewer where that would be less than ten variants for each of eight."""
    return max(wanted or max(min(10, variants // 8), math.ceil(variants / 100)), math.ceil(variants / MOST_JOBS))


# ---------------------------------------------------------------------------------------------- running


class Progress:
    """How many are done and how long the rest will take: a line that is rewritten on a terminal, one every 10 s in a log."""

    def __init__(self, folder, jobs, done, total):
        self._folder, self._jobs, self._done, self._total = folder, dict(jobs), done, total
        self._finished, self._start = 0, time.monotonic()
        self._stop, self._is_terminal = threading.Event(), sys.stderr.isatty()
        self._thread = threading.Thread(target=self._tell, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()
        if self._is_terminal:
            sys.stderr.write("\r\033[K")

    def _count(self):
        running = 0
        for job in list(self._jobs):
            file = self._folder.file("results", job + ".jsonl")
            if os.path.exists(file):
                self._finished += self._jobs.pop(job)
                continue
            with contextlib.suppress(FileNotFoundError), open(file + ".part", "rb") as stream:
                running += stream.read().count(b"\n")
        return self._finished + running

    def _tell(self):
        while not self._stop.wait(2 if self._is_terminal else 10):
            count = self._count()
            elapsed = time.monotonic() - self._start
            text = "sweep: %d of %d variants" % (self._done + count, self._total)
            if count:
                left = int(elapsed / count * (self._total - self._done - count))
                text += ", %d:%02d:%02d left" % (left // 3600, left // 60 % 60, left % 60)
            sys.stderr.write("\r\033[K" + text if self._is_terminal else text + "\n")
            sys.stderr.flush()


def snakemake(folder, jobs, profile):
    """Runs the planned jobs; ends with all of them when it is told to."""
    command = ["/usr/bin/python3", "-m", "snakemake", "--snakefile", os.path.join(HERE, "Snakefile"), "--directory", folder.path, "--nolock",
               "--keep-going"]
    version = tuple(map(int, re.findall(r"\d+", importlib.metadata.version("snakemake"))[:2]))
    if version >= (7, 8):  # older ones go by times alone, and know no such options
        command += ["--rerun-triggers", "mtime", "--scheduler", "greedy"]
    command += ["--profile", profile] if profile else ["--cores", str(jobs)]
    with open(folder.file(LOG), "w", encoding="utf-8") as log:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, end)
        process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, start_new_session=True, close_fds=False)
        try:
            return process.wait()
        except SystemExit:
            os.killpg(process.pid, signal.SIGINT if profile else signal.SIGKILL)  # with a cluster Snakemake cancels its jobs
            process.wait()
            raise


def end(number, _):
    sys.exit("sweep: ended by signal %d; the same command goes on" % number)


def cpu_seconds():
    return sum(usage.ru_utime + usage.ru_stime for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


def run(folder, study, options, keyed):
    missing = folder.missing(study, keyed)
    todo = {key for key, _ in missing}
    print("sweep: %d variants, %d of them done before" % (len(keyed), sum(key not in todo for key, _ in keyed)))
    if options.shuffle is not None:
        random.Random(options.shuffle).shuffle(missing)
    if not missing:
        return None
    jobs = plan(folder, study, options.program, missing, study.keep_csv)
    with Progress(folder, jobs, len(dict(keyed)) - len(missing), len(dict(keyed))):
        code = snakemake(folder, options.jobs, options.profile)
    after, lost = folder.results(), [key for key, _ in folder.missing(study, missing)]
    if not lost:
        return len(jobs), sum(after[key]["cpu_time_s"] for key, _ in missing)
    crashes = folder.crashes()
    first = next((crashes[key]["crashed"] for key in lost if key in crashes), None)
    if first is None:
        with open(folder.file(LOG), encoding="utf-8", errors="replace") as log:
            first = "Snakemake ended with exit code %d; %s ends with:\n%s" % (code, folder.file(LOG), "".join(log.readlines()[-12:]))
    raise SweepError("%d variants are not done: %s\nThe same command tries them again." % (len(lost), first.rstrip()))


def verify(folder, study, options, keyed):
    """Repeats one of a hundred variants. @return whether all are as they were."""
    done = folder.results()
    if any(key not in done for key, _ in keyed):
        raise SweepError("there is nothing to verify: not all variants are done with these files and this program; run the sweep first")
    unique = list(dict(keyed).items())
    chosen = random.Random(options.verify).sample(unique, math.ceil(len(unique) / 100))
    again = run_all(options.program, [{"key": key, "arguments": arguments_of(study, variant)} for key, variant in chosen])
    other = [(new, done[new["key"]]) for new in again if any(new.get(name) != done[new["key"]].get(name) for name in ("sha256", "error"))]
    print("sweep: %d of %d variants repeated: %s" % (len(chosen), len(unique), "%d differ" % len(other) if other else "the same hashes"))
    for new, old in other[:10]:
        print("  variant %s: %s, before %s" % (new["key"], new.get("sha256", new), old.get("sha256", old)))
    return not other


# ---------------------------------------------------------------------------------------------- what the user says and sees


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(prog="scripts/sweep", description=__doc__.split("\n")[0], allow_abbrev=False)
    parser.add_argument("study", help="the study (doc/sweep.md)")
    parser.add_argument("--out", help="folder for the table, pictures and what is done so far; default: the study's name without its ending")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="replays at a time; default: as many as cores")
    parser.add_argument("--profile", help="of Snakemake: a folder, or slurm")
    parser.add_argument("--verify", type=int, nargs="?", const=0, metavar="SEED", help="repeat one of a hundred variants and compare hashes")
    parser.add_argument("--dry-run", action="store_true", help="tell what would be run")
    parser.add_argument("--shuffle", type=int, metavar="SEED", help="run in another order, to see that the answers are the same")
    options = parser.parse_args(arguments)
    if options.jobs < 1:
        parser.error("--jobs is %d; it must be 1 or more" % options.jobs)
    options.program = os.environ.get("TISSUE_CONTACT_REPLAY") or shutil.which("tissue_contact_replay")
    if options.profile and os.path.isdir(os.path.join(HERE, "profiles", options.profile)):
        options.profile = os.path.join(HERE, "profiles", options.profile)
    if options.profile and not os.path.isfile(os.path.join(options.profile, "config.yaml")):
        parser.error("--profile %s: there is no file config.yaml in such a folder; known by name: %s" %
                     (options.profile, ", ".join(sorted(os.listdir(os.path.join(HERE, "profiles"))))))
    options.out = os.path.abspath(options.out or os.path.splitext(options.study)[0])
    return options


def describe(folder, study, keyed):
    print("sweep: %d variants, %d to be run" % (len(keyed), len(folder.missing(study, keyed))))
    for _, variant in keyed[:5]:
        print("  " + " ".join(arguments_of(study, variant)))


def main(arguments):
    options = parse_arguments(arguments)
    try:
        study = Study(options.study)
        if os.path.exists(options.out) and not os.path.isdir(options.out):
            raise SweepError("--out %s is no folder; give the name of one" % options.out)
        folder = Folder(options.out)
        inputs = Inputs(options.program, study)
        keyed = [(inputs.key(variant), variant) for variant in study.variants()]
        if options.dry_run:
            return describe(folder, study, keyed)
        if options.verify is not None:
            return 0 if verify(folder, study, options, keyed) else 1
        costs = run(folder, study, options, keyed)
        files = write_table(folder.path, study, keyed, folder.results())
        files += write_pictures(folder.path, study, keyed, folder.results())
        if costs:
            print("sweep: %d jobs; CPU time of replays %.1f s%s" % (*costs, "" if options.profile else ", of all %.1f s" % cpu_seconds()))
        print("sweep: " + ", ".join(files))
        return 0
    except (StudyError, SweepError) as error:
        sys.exit("sweep: %s" % error)
    except OSError as error:
        sys.exit("sweep: %s: %s" % (error.filename or options.out, error.strerror))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
