#!/usr/bin/python3
"""One job of a sweep, as Snakemake starts it: run_job.py JOB.json RESULTS.jsonl. Each result is written when the next replay begins,
in RESULTS.jsonl.part, so that nothing is lost when the job is killed; the name is given when all are there."""
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from replays import run_all


def main(job_file, results_file):
    with open(job_file, encoding="utf-8") as stream:
        job = json.load(stream)
    with open(results_file + ".part", "w", encoding="utf-8") as results, open(results_file + ".log", "w", encoding="utf-8") as log:
        for result in run_all(job["program"], job["variants"], job["kept_folder"], log):
            results.write(json.dumps(result) + "\n")
            results.flush()
    os.replace(results_file + ".part", results_file)
    os.remove(results_file + ".log")


if __name__ == "__main__":
    main(*sys.argv[1:])
