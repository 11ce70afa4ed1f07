#!/usr/bin/python3
"""Whether the files that a manifest of tissue_contact_replay names are still what they were: a line for each that is not, and exit code 1."""
import argparse
import hashlib
import sys

import yaml

MOST_BYTES = 10 << 20


def sha256_of(file):
    digest = hashlib.sha256()
    with open(file, "rb") as stream:
        for part in iter(lambda: stream.read(1 << 20), b""):
            digest.update(part)
    return digest.hexdigest()


def read_manifest(file):
    """[(role, file, SHA-256)]"""
    with open(file, "rb") as stream:
        manifest = yaml.safe_load(stream.read(MOST_BYTES))
    if not isinstance(manifest, dict) or manifest.get("manifest") != "tissue_contact_replay 1":
        raise ValueError("is no manifest of tissue_contact_replay")
    return [(one["role"], one["file"], one["sha256"]) for part in ("program", "inputs", "results") for one in manifest[part]]


def problem_of(file, sha256):
    try:
        return None if sha256_of(file) == sha256 else "has another content"
    except OSError as error:
        return "cannot be read: " + error.strerror


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("manifest", help="what tissue_contact_replay --manifest wrote")
    name = parser.parse_args().manifest
    try:
        files = read_manifest(name)
    except (OSError, ValueError, KeyError, TypeError, yaml.YAMLError) as error:
        sys.exit("check_manifest.py: %s: %s" % (name, getattr(error, "strerror", None) or " ".join(str(error).split())))
    problems = [(role, file, problem_of(file, sha256)) for role, file, sha256 in files]
    for role, file, problem in problems:
        if problem:
            print("%s %s: %s" % (role, file, problem))
    wrong = sum(problem is not None for _, _, problem in problems)
    print("%d files, %s" % (len(files), "%d not as they were" % wrong if wrong else "all as they were"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
