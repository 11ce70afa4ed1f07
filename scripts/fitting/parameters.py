"""What is fitted: --fit KEY[:LOW..HIGH], where KEY is a key of the scene by its path or by an end of it that no other key has."""
import dataclasses
import math
import re

import yaml

from fitting import FitError

UNITS = (("_n_per_m", "N/m"), ("_pa_per_m", "Pa/m"), ("_m_per_s", "m/s"), ("_kg_per_m3", "kg/m3"), ("_per_s", "1/s"), ("_pa", "Pa"),
         ("_n_m", "N m"), ("_rad", "rad"), ("_m", "m"), ("_s", "s"))
OFFSET = "offset_m"
THICKNESS = "thickness_m"
TYPICAL = {  # bounds of a key that --fit gives none; of a thickness, of the scene's
    "youngs_modulus_pa": (3e2, 3e5), "poissons_ratio": (0.3, 0.49), "stiffness_s": (1e-3, 1e-1), "static": (0.02, 2.0), "kinetic": (0.02, 2.0),
    OFFSET: (-1e-3, 1e-3), THICKNESS: (0.4, 2.5)}
LOG_FROM_RATIO = 5.0  # bounds this far apart are of a number known by its order of magnitude


@dataclasses.dataclass
class Parameter:
    key: str  # of the scene; or OFFSET; or TISSUE's path + "." + THICKNESS of a block
    low: float
    high: float
    start: float

    @property
    def is_log(self):
        return self.low > 0.0 and self.high >= LOG_FROM_RATIO * self.low

    @property
    def unit(self):
        return next((unit for suffix, unit in UNITS if self.key.endswith(suffix)), "")

    @property
    def label(self):
        return self.key.replace("tissues.", "").replace("instruments.", "")

    def value(self, part):
        """At `part` of the way from low (0) to high (1)."""
        if self.is_log:
            return self.low * (self.high / self.low) ** part
        return self.low + part * (self.high - self.low)

    def part(self, value):
        if self.is_log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def slope(self, part):
        """d value / d part."""
        return self.value(part) * math.log(self.high / self.low) if self.is_log else self.high - self.low


class SceneKeys:
    """The scene's file as a tree, to find keys by the end of their path, and what is fitted besides keys."""

    def __init__(self, path):
        self.path = path
        try:
            with open(path, encoding="utf-8") as stream:
                self.tree = yaml.safe_load(stream)
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise FitError("%s cannot be read: %s" % (path, error)) from error
        if not isinstance(self.tree, dict):
            raise FitError("%s is not a scene" % path)
        self.tree = _with_exponents(self.tree)
        self.numbers = dict(_numbers(self.tree, ""))

    def resolve(self, name):
        """(key, value in the scene or None)."""
        if name == OFFSET:
            return name, 0.0
        found = [key for key in self.numbers if key == name or key.endswith("." + name)]
        if len(found) == 1:
            return found[0], self.numbers[found[0]]
        if len(found) > 1:
            raise FitError("--fit %s: %s has several keys of this name; give one of %s" % (name, self.path, ", ".join(found)))
        blocks = [self.tissue_path(tissue) for tissue in self.tissues() if "block" in tissue]
        thick = [path for path in blocks if (path + "." + THICKNESS).endswith(name)] if name.endswith(THICKNESS) else []
        if len(thick) == 1:
            return thick[0] + "." + THICKNESS, self.block_of(thick[0])["size_m"][2]
        if len(thick) > 1:
            raise FitError("--fit %s: %s has several blocks; give one of %s" %
                           (name, self.path, ", ".join(path + "." + THICKNESS for path in thick)))
        if name.endswith("." + THICKNESS):
            raise FitError("--fit %s: %s has no such block; its blocks are %s" % (name, self.path, ", ".join(blocks) or "none"))
        if "." in name:
            return name, None  # a key that the file leaves out: the scene's own reader says whether there is one
        raise FitError("--fit %s: %s has no such number; give the whole path of a key that it leaves out, or one of %s" %
                       (name, self.path, ", ".join(sorted(set(key.rsplit(".", 1)[1] for key in self.numbers if "." in key)))))

    def tissues(self):
        tissues = self.tree.get("tissues")
        return [tissue for tissue in tissues if isinstance(tissue, dict)] if isinstance(tissues, list) else []

    @staticmethod
    def tissue_path(tissue):
        return "tissues.%s" % tissue.get("name")

    def _tissue(self, path):
        return next(tissue for tissue in self.tissues() if self.tissue_path(tissue) == path)

    def block_of(self, path):
        size = (self._tissue(path).get("block") or {}).get("size_m")
        if not (isinstance(size, list) and len(size) == 3):
            raise FitError("%s: %s has no block of three size_m" % (self.path, path))
        return self._tissue(path)["block"]

    def instruments(self):
        instruments = self.tree.get("instruments")
        return [one for one in instruments if isinstance(one, dict)] if isinstance(instruments, list) else []

    def settings(self, parameters, values, instrument, approach):
        """{key of the scene: value} of the fitted values, the tool moved on by its offset included."""
        values = dict(zip((parameter.key for parameter in parameters), values))
        settings = {}
        for key, value in values.items():
            if key == OFFSET:
                settings.update(self._moved_tool(instrument, approach, value))
            elif key.endswith("." + THICKNESS) and key not in self.numbers and key[:-len(THICKNESS) - 1] in map(self.tissue_path, self.tissues()):
                settings.update(self._thick_block(key[:-len(THICKNESS) - 1], value))
            else:
                settings[key] = value
        for kinetic in [key for key in settings if key.startswith("friction.") and key.endswith(".kinetic")]:
            self._order(settings, kinetic[:-len("kinetic")] + "static", kinetic)
        for static in [key for key in settings if key.startswith("friction.") and key.endswith(".static")]:
            settings[static] = max(settings[static], settings.get(static[:-len("static")] + "kinetic", self.numbers.get(static[:-len("static")] + "kinetic", 0.0)))
        return settings

    def _order(self, settings, static, kinetic):
        """Static friction is nowhere below kinetic. Of two that are fitted the larger one is static, so that the search cannot lose one
        behind the other; where the scene gives it, it is raised to what it must be."""
        pair = sorted((settings.get(static, self.numbers.get(static, settings[kinetic])), settings[kinetic]))
        if static in settings:
            settings[kinetic] = pair[0]
        settings[static] = pair[1]

    def _moved_tool(self, instrument, approach, offset_m):
        tree = next(one for one in self.instruments() if one.get("name") == instrument)
        at = (tree.get("base_pose") or {}).get("position_m", [0.0, 0.0, 0.0])
        return {"instruments.%s.base_pose.position_m" % instrument: [float(x + offset_m * a) for x, a in zip(at, approach)]}

    def _thick_block(self, path, thickness_m):
        """The block with its upper face where it was: it grows downwards, along its z axis as posed."""
        tissue, size = self._tissue(path), self.block_of(path)["size_m"]
        pose = tissue.get("pose") or {}
        if any(key in pose for key in ("rpy_rad", "quaternion_xyzw")):
            raise FitError("%s.%s: a block that is turned cannot be fitted its thickness; leave out pose.rpy_rad" % (path, THICKNESS))
        at = [float(x) for x in pose.get("position_m", [0.0, 0.0, 0.0])]
        at[2] += float(size[2]) - thickness_m
        return {path + ".block.size_m": [float(size[0]), float(size[1]), thickness_m], path + ".pose.position_m": at}


def _with_exponents(node):
    """The tree with numbers as the scene's reader has them: YAML 1.1, which PyYAML reads, takes 5e3 for text."""
    if isinstance(node, dict):
        return {key: _with_exponents(child) for key, child in node.items()}
    if isinstance(node, list):
        return [_with_exponents(child) for child in node]
    is_number = isinstance(node, str) and re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+", node)
    return float(node) if is_number else node


def _numbers(node, path):
    """(path, value) of every number; an element of a list goes by its name, or else its index."""
    if isinstance(node, dict):
        for key, child in node.items():
            yield from _numbers(child, "%s.%s" % (path, key) if path else str(key))
    elif isinstance(node, list):
        for index, child in enumerate(node):
            name = child.get("name", index) if isinstance(child, dict) else index
            yield from _numbers(child, "%s.%s" % (path, name))
    elif isinstance(node, (int, float)) and not isinstance(node, bool):
        yield path, float(node)


def parse_fit(text, keys):
    """A Parameter of "KEY", "KEY:LOW..HIGH" or "KEY:LOW..HIGH:START"."""
    if ":" not in text:
        return _with_typical_bounds(text, keys)
    match = re.fullmatch(r"([^:\s]+):([^:.]*(?:\.[^:.]+)?)\.\.([^:]+)(?::([^:]+))?", text)
    try:
        numbers = [float(group) if group else None for group in match.groups()[1:]]
        low, high, start = numbers
        good = math.isfinite(low) and math.isfinite(high) and low < high
    except (AttributeError, TypeError, ValueError):
        good = False
    if not good:
        raise FitError("--fit '%s' is not KEY:LOW..HIGH with LOW below HIGH, such as youngs_modulus_pa:1e3..1e5" % text)
    key, in_scene = keys.resolve(match.group(1))
    if start is not None and not low <= start <= high:
        raise FitError("--fit '%s': the start %g is not from %g to %g" % (text, start, low, high))
    parameter = Parameter(key, low, high, 0.0)
    inside = in_scene is not None and low <= in_scene <= high
    parameter.start = start if start is not None else in_scene if inside else parameter.value(0.5)
    return parameter


def _with_typical_bounds(name, keys):
    key, in_scene = keys.resolve(name)
    last = key.rsplit(".", 1)[-1]
    if last not in TYPICAL:
        raise FitError("--fit %s has no bounds: give it as KEY:LOW..HIGH, such as youngs_modulus_pa:1e3..1e5; only %s may go without" %
                       (name, ", ".join(TYPICAL)))
    scale = float(in_scene) if last == THICKNESS else 1.0
    return parse_fit("%s:%r..%r" % ((key,) + tuple(scale * bound for bound in TYPICAL[last])), keys)


def parse_fits(texts, keys):
    parameters = [parse_fit(text, keys) for text in texts]
    for i, parameter in enumerate(parameters):
        if parameter.key in [other.key for other in parameters[:i]]:
            raise FitError("--fit names %s twice" % parameter.key)
    by_key = {parameter.key: parameter for parameter in parameters}
    for key, static in by_key.items():
        kinetic = by_key.get(key[:-len("static")] + "kinetic") if key.endswith(".static") else None
        if kinetic and static.start <= kinetic.start:  # from where they are one, nothing would tell which of them to move
            static.start, kinetic.start = static.value(0.6), kinetic.value(0.4)
    return parameters


def settings_of(texts, option):
    """{key of the scene: value} of "KEY=VALUE"s."""
    settings = {}
    for text in texts:
        key, equals, value = text.partition("=")
        try:
            settings[key.replace("[", ".").replace("]", "")] = yaml.safe_load(value)
        except yaml.YAMLError as error:
            raise FitError("%s '%s': %s" % (option, text, error)) from error
        if not (key and equals and value):
            raise FitError("%s '%s' is not KEY=VALUE, such as step.max_step_s=0.001" % (option, text))
    return settings
