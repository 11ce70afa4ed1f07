"""A study file: what it may say, and the variants that it stands for. doc/sweep.md has its keys."""
import difflib
import glob
import itertools
import json
import math
import os
import re
import sys

import yaml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "scripts"))

MOST_BYTES = 1 << 20
MOST_VARIANTS = 1000000
MOST_SAMPLES = 1000000
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\Z")
PLAIN = re.compile(r"[A-Za-z_/~][A-Za-z0-9_./:~-]*\Z")

KEYS = {
    "the study": ["bags", "scenes", "set", "cases", "grid", "latin_hypercube", "replay", "variants_per_job", "keep_csv"],
    "latin_hypercube": ["samples", "seed", "ranges"],
    "replay": ["from_s", "duration_s", "urdf", "changes"],
    "a range": ["from", "to", "count", "spacing"],
}


class Loader(yaml.SafeLoader):
    """Without aliases, by which a small file becomes a large one or holds itself, and without keys given twice."""

    def compose_node(self, parent, index):
        if self.check_event(yaml.AliasEvent):
            raise yaml.MarkedYAMLError(problem="aliases (*name) are not allowed", problem_mark=self.peek_event().start_mark)
        return super().compose_node(parent, index)

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key, _ in node.value:
            if key.value in seen if isinstance(key.value, str) else False:
                raise yaml.MarkedYAMLError(problem="the key %s is given twice" % key.value, problem_mark=key.start_mark)
            seen.add(str(key.value))
        return super().construct_mapping(node, deep)


class StudyError(Exception):
    """What is wrong with a study file: file, key, value, what is allowed."""


class Entry:
    """A value of the study file and where it stands."""

    def __init__(self, file, path, value):
        self.file, self.path, self.value = file, path, value

    def fail(self, problem):
        raise StudyError("%s: %s: %s" % (self.file, self.path or "the study", problem))

    def shown(self):
        text = json.dumps(self.value, default=str)
        return text if len(text) <= 80 else text[:77] + "..."

    def below(self, key, value):
        return Entry(self.file, self.path + ("." if self.path and not key.startswith("[") else "") + key, value)

    def map(self, kind=None):
        """{key: Entry}; with a kind, its keys alone."""
        if not isinstance(self.value, dict):
            self.fail("is %s; it must be a map (key: value)" % self.shown())
        for key in self.value:
            if not isinstance(key, str):
                self.fail("has the key %r; keys must be text" % (key,))
            if kind and key not in KEYS[kind]:
                near = difflib.get_close_matches(key, KEYS[kind], 1)
                self.below(key, None).fail("unknown key; %sallowed here: %s" % ('did you mean "%s"? ' % near[0] if near else "", ", ".join(KEYS[kind])))
        return {key: self.below(key, value) for key, value in self.value.items()}

    def list(self):
        if not isinstance(self.value, list) or not self.value:
            self.fail("is %s; it must be a list of one element or more" % self.shown())
        return [self.below("[%d]" % i, value) for i, value in enumerate(self.value)]

    def number(self, low, high, whole=False):
        value = self.value
        if isinstance(value, str) and NUMBER.match(value):
            value = float(value)  # YAML 1.1 takes 1e5, without a dot, for text
        good = isinstance(value, (int, float)) and not isinstance(value, bool) and low <= value <= high and not (whole and value != int(value))
        if not good:
            self.fail("is %s; it must be a %snumber from %g to %g" % (self.shown(), "whole " if whole else "", low, high))
        return int(value) if whole else float(value)

    def text(self):
        if not isinstance(self.value, str) or not self.value or re.search(r"[\x00-\x1f\x7f]", self.value):
            self.fail("is %s; it must be text of one line" % self.shown())
        return self.value

    def choice(self, words):
        if self.value not in words:
            self.fail("is %s; it must be %s" % (self.shown(), " or ".join(map(str, words))))
        return self.value

    def setting_value(self):
        """As --set has it behind the '='."""
        value = self.value
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            self.fail("is %s; it must be a value of the scene" % self.shown())
        if isinstance(value, str) and (PLAIN.match(value) or NUMBER.match(value)):
            return value
        try:
            text = json.dumps(value)
        except TypeError:
            self.fail("is %r; write dates and the like in quotes" % (value,))
        if len(text) > 4000:
            self.fail("has %d bytes; at most 4000 are allowed" % len(text))
        return text

    def setting_key(self):
        """Of a map of settings: the key of this entry."""
        key = self.path.partition(".")[2]
        if not key or re.search(r"[\x00-\x1f\x7f=]", key):
            self.fail('has "%s" for a key; it must be one of a scene, such as step.max_step_s' % key)
        return key


def spaced(low, high, part, spacing):
    """So far of the way from low to high; `part` from 0 to 1."""
    if part in (0.0, 1.0):
        return high if part else low
    return low * (high / low) ** part if spacing == "log" else low + part * (high - low)


def read_range(entry, keys):
    """(from, to, spacing, entries)."""
    entries = entry.map("a range")
    for key in keys:
        if key not in entries:
            entry.fail('required key "%s" is missing' % key)
    low, high = (entries[key].number(-1e300, 1e300) for key in ("from", "to"))
    spacing = entries["spacing"].choice(["linear", "log"]) if "spacing" in entries else "linear"
    if not low < high:
        entry.fail('"from" is %g and "to" is %g; the first must be smaller' % (low, high))
    if spacing == "log" and not low > 0:
        entries["from"].fail("is %g; it must be above 0 where spacing is log" % low)
    return low, high, spacing, entries


def read_grid(entry):
    """[(key, [value texts])]."""
    axes = []
    for key, axis in entry.map().items():
        axis.setting_key()
        if isinstance(axis.value, dict):
            low, high, spacing, entries = read_range(axis, ["from", "to", "count"])
            count = entries["count"].number(2, MOST_VARIANTS, whole=True)
            axes.append((key, [repr(spaced(low, high, i / (count - 1), spacing)) for i in range(count)]))
        else:
            axes.append((key, [element.setting_value() for element in axis.list()]))
    return axes


class LatinHypercube:
    """So many samples; in each of that many equal parts of each range lies one (McKay, Beckman, Conover 1979)."""

    def __init__(self, entry):
        entries = entry.map("latin_hypercube")
        for key in ["samples", "seed", "ranges"]:
            if key not in entries:
                entry.fail('required key "%s" is missing' % key)
        self.samples = entries["samples"].number(1, MOST_SAMPLES, whole=True)
        self.seed = entries["seed"].number(0, 2 ** 63, whole=True)
        self.ranges = []
        for key, one in entries["ranges"].map().items():
            low, high, spacing, more = read_range(one, ["from", "to"])
            if "count" in more:
                more["count"].fail("is for grids; here `samples` says how many")
            self.ranges.append((key, low, high, spacing))
        if not self.ranges:
            entries["ranges"].fail("is empty; give a range for one key or more")

    def settings(self):
        """[[(key, value text)]], one list for each sample."""
        from fitting.latin_hypercube import latin_hypercube  # loads NumPy, which only who wants it waits for
        points = latin_hypercube(self.samples, len(self.ranges), self.seed)
        return [[(key, repr(float(spaced(low, high, float(part), spacing)))) for part, (key, low, high, spacing) in zip(point, self.ranges)]
                for point in points]


class Variant:
    """One replay."""

    def __init__(self, scene, bag, settings):
        self.scene, self.bag, self.settings = scene, bag, settings

    def arguments(self):
        return ["--set=%s=%s" % setting for setting in self.settings]


class Study:
    """What a study file says, checked; of the scene's keys only the replay knows what they may be."""

    def __init__(self, file):
        self.file = file
        top = self._read().map("the study")
        self.folder = os.path.dirname(os.path.abspath(file))
        for key in ["bags", "scenes"]:
            if key not in top:
                raise StudyError('%s: the study: required key "%s" is missing; it is a list of files' % (file, key))
        self.bags = [path for entry in top["bags"].list() for path in self._files(entry)]
        self.scenes = [path for entry in top["scenes"].list() for path in self._files(entry)]
        self.fixed = self._settings(top["set"]) if "set" in top else []
        self.cases = [self._settings(entry) for entry in top["cases"].list()] if "cases" in top else [[]]
        self.axes = read_grid(top["grid"]) if "grid" in top else []
        self.hypercube = LatinHypercube(top["latin_hypercube"]) if "latin_hypercube" in top else None
        self.options = self._replay_options(top["replay"].map("replay")) if "replay" in top else []
        self.per_job = top["variants_per_job"].number(1, MOST_VARIANTS, whole=True) if "variants_per_job" in top else None
        self.keep_csv = top["keep_csv"].choice([True, False]) if "keep_csv" in top else False
        self._refuse_twice()
        self._refuse_too_many()

    def _read(self):
        try:
            with open(self.file, "rb") as stream:
                text = stream.read(MOST_BYTES + 1)
        except OSError as error:
            raise StudyError("study file %s cannot be read: %s" % (self.file, error.strerror)) from error
        if len(text) > MOST_BYTES:
            raise StudyError("%s: has more than %d bytes; sweep over values by ranges, or over several studies" % (self.file, MOST_BYTES))
        try:
            return Entry(self.file, "", yaml.load(text, Loader))
        except (yaml.YAMLError, ValueError, RecursionError) as error:
            raise StudyError("%s: is no YAML: %s" % (self.file, " ".join(str(error).split()))) from error

    def _files(self, entry):
        """Of a path or pattern, relative to the study; scenes and URDFs may be URIs (package://) too."""
        path = entry.text()
        if "://" in path and entry.path.startswith(("scenes", "replay.urdf")):
            return [path]
        found = sorted(glob.glob(os.path.join(glob.escape(self.folder), path)))
        if not found:
            entry.fail("is %s; there is no such file (patterns with * and ? are allowed)" % entry.shown())
        for one in found:
            if not os.path.isfile(one) or re.search(r"[\x00-\x1f\x7f]", one):
                entry.fail("is %s; %r is no regular file" % (entry.shown(), one))
        return found

    @staticmethod
    def _settings(entry):
        settings = entry.map()
        for value in settings.values():
            value.setting_key()
        return [(key, value.setting_value()) for key, value in settings.items()]

    def _replay_options(self, entries):
        options = []
        for key, name in [("from_s", "--from"), ("duration_s", "--duration")]:
            if key in entries:
                options.append("%s=%r" % (name, entries[key].number(0, 1e9)))
        if "urdf" in entries:
            options.append("--urdf=" + self._files(entries["urdf"])[0])
        if "changes" in entries:
            options.append("--changes=" + entries["changes"].text())
        return options

    def keys(self):
        """Those that differ between variants, in the order of the table."""
        keys = [key for case in self.cases for key, _ in case] + [key for key, _ in self.axes]
        keys += [key for key, *_ in self.hypercube.ranges] if self.hypercube else []
        return list(dict.fromkeys(keys))

    def _refuse_twice(self):
        parts = [[key for key, _ in self.fixed], list(dict.fromkeys(key for case in self.cases for key, _ in case)),
                 [key for key, _ in self.axes], [key for key, *_ in self.hypercube.ranges] if self.hypercube else []]
        seen = set()
        for key in itertools.chain(*parts):
            if key in seen:
                raise StudyError("%s: %s: is in two of set, cases, grid and latin_hypercube; leave it in one" % (self.file, key))
            seen.add(key)

    def count(self):
        return (len(self.bags) * len(self.scenes) * len(self.cases) * math.prod(len(values) for _, values in self.axes) *
                (self.hypercube.samples if self.hypercube else 1))

    def _refuse_too_many(self):
        if self.count() > MOST_VARIANTS:
            raise StudyError("%s: the study: has %d variants; at most %d are allowed: shorten grid, or take a latin_hypercube of fewer samples" %
                             (self.file, self.count(), MOST_VARIANTS))

    def variants(self):
        """In the order of the table."""
        samples = self.hypercube.settings() if self.hypercube else [[]]
        grid = [[(key, value) for (key, _), value in zip(self.axes, values)] for values in itertools.product(*[values for _, values in self.axes])]
        for bag, scene, case, point, sample in itertools.product(self.bags, self.scenes, self.cases, grid, samples):
            yield Variant(scene, bag, self.fixed + case + point + sample)
