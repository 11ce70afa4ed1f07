#!/usr/bin/python3
"""doc/reference.md against a running node, its refusals, the messages, the launch files and the tools: each table has what there is, no more and no less."""
import collections
import glob
import io
import os
import re
import socket
import subprocess
import threading
import unittest.mock
import xml.etree.ElementTree
import xmlrpc.client

import rosgraph
import rosgraph.network
import rospy
import yaml
from dynamic_reconfigure.msg import Config, ConfigDescription, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from roslaunch.substitution_args import resolve_args

import harness

RATES = "publish: {mesh_rate_hz: 20, contacts_rate_hz: 50, status_rate_hz: 10, markers_rate_hz: 10, tf: true}"
NAMES = {"~": harness.NODE + "/", "<instrument>": "probe", "<tissue>": "block", "instruments[].joint_state_topics[]": harness.TOPIC}
UNITS = ["m/s", "Pa", "rad", "N", "m", "s", "W"]
SUFFIXES = [("_m_per_s", "m/s"), ("_per_s", "1/s"), ("_hz", "Hz"), ("_nm", "N m"), ("_pa", "Pa"), ("_rad", "rad"), ("_n", "N"), ("_w", "W"), ("_m", "m"), ("_s", "s")]


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def read_tables(document):
    """{heading: [{column: cell}]}; what is wholly in backticks comes without them."""
    tables, heading, columns = collections.OrderedDict(), None, None
    with open(os.path.join(harness.PACKAGE, "doc", document), encoding="utf-8") as stream:
        for line in stream:
            if line.startswith("#"):
                heading, columns = line.strip("# \n`"), None
            elif not line.startswith("|"):
                columns = None
            elif columns is None:
                columns = cells(line)
                tables[heading] = []
            elif not line.startswith("|---"):
                row = dict(zip(columns, cells(line)))
                tables[heading].append({key: re.sub(r"^`([^`]*)`$", r"\1", cell) for key, cell in row.items()})
    return tables


TABLES = read_tables("reference.md")
HAPTICS = read_tables("haptics.md")["Feeling the force"]


def full_name(name):
    for short, full in NAMES.items():
        name = name.replace(short, full)
    return name


def of_table(heading, value, column=None):
    """{name: value} of a table whose names are in its first column, or in `column`."""
    return {full_name(row[column or list(row)[0]]): row[value] for row in TABLES[heading]}


def read_numbers(text):
    return [float(number) for number in re.findall(r"-?\d[\d.]*(?:e[+-]?\d+)?", text)]


def service_type(name):
    """As its server says in a handshake that asks for no more."""
    host, port = rosgraph.network.parse_http_host_and_port(rosgraph.Master("/test").lookupService(name).replace("rosrpc", "http"))
    with socket.create_connection((host, port), harness.DEADLINE_S) as connection:
        header = {"probe": "1", "md5sum": "*", "callerid": "/test", "service": name}
        rosgraph.network.write_ros_handshake_header(connection, header)
        return rosgraph.network.read_ros_handshake_header(connection, io.BytesIO(), 4096)["type"]


class Headers:
    """Of the first message on each topic: how its publisher described it."""

    def __init__(self, topics):
        self._headers, self._lock = {}, threading.Lock()
        self._subscribers = [rospy.Subscriber(topic, rospy.AnyMsg, self._take, topic) for topic in topics]
        node = xmlrpc.client.ServerProxy(rosgraph.Master("/test").lookupNode(harness.NODE))
        harness.wait_until(lambda: set(topics) <= {to[4] for to in node.getBusInfo("/test")[2] if to[1:3] == [rospy.get_name(), "o"]},
                           "a connection of each topic")  # what was published before does not come

    def _take(self, message, topic):
        if message._connection_header["callerid"] == harness.NODE:
            with self._lock:
                self._headers.setdefault(topic, message._connection_header)

    def get(self):
        with self._lock:
            return dict(self._headers)


class Reference(harness.TestCase):
    maxDiff = None

    def setUp(self):
        super().setUp()
        if rospy.has_param(harness.NODE):  # of the test before
            rospy.delete_param(harness.NODE)

    # ------------------------------------------------------------------ topics and services

    def advertised(self, kind):
        """What the node has registered: 0 publishers, 1 subscribers, 2 services."""
        return {name for name, nodes in rosgraph.Master("/test").getSystemState()[kind] if harness.NODE in nodes}

    def wait_for_all(self):
        """Until the node has registered all, and what it then says of itself: the first figures come after that."""
        return harness.diagnostics().wait(lambda all: all and all[-1].status[0].values, "diagnostics with figures")[-1]

    def test_topics_and_services(self):
        with harness.node(self.changed_scene({RATES: RATES[:-1] + ", crtk: true}"})):
            source = harness.JointSource()
            diagnostics = self.wait_for_all()
            documented = of_table("Published topics", "type")
            self.assertEqual(self.advertised(0), set(documented))
            subscribed = of_table("Subscribed topics", "type")
            self.assertEqual(self.advertised(1), {harness.TOPIC})
            self.assertIn(harness.TOPIC, subscribed)
            self.assertEqual({name: service_type(name) for name in self.advertised(2)}, of_table("Services", "type"))
            headers = Headers(documented)
            rospy.ServiceProxy(harness.NODE + "/set_parameters", Reconfigure)(
                Config(doubles=[DoubleParameter("tissues/block/youngs_modulus_pa", 6000.0)]))  # told on ~changes
            source.send_all(harness.press(100))
            harness.wait_until(lambda: set(headers.get()) == set(documented), "a message on each topic")
            self.assertEqual({name: header["type"] for name, header in headers.get().items()}, documented)
            latched = {name: "yes" if header.get("latching") == "1" else "no" for name, header in headers.get().items()}
            self.assertEqual(latched, of_table("Published topics", "latched"))
            self.assert_diagnostics(diagnostics)

    def assert_diagnostics(self, message):
        found = {status.name.partition(": ")[2]: {value.key for value in status.values} for status in message.status}
        self.assertEqual(found, {name: set(of_table(name, "unit")) for name in found})
        for name in found:
            for key, unit in of_table(name, "unit").items():
                self.assertEqual(unit, self.unit_of(key), key)

    def test_topics_whose_rate_is_zero(self):
        off = "publish: {mesh_rate_hz: 0, contacts_rate_hz: 0, status_rate_hz: 0, markers_rate_hz: 0, tf: false}"
        self.assertEqual(re.findall(r"\w+(?=:)", RATES), re.findall(r"\w+(?=:)", off))
        with harness.node(self.changed_scene({RATES: off})):
            self.wait_for_all()
            rates = of_table("Published topics", "rate")
            self.assertEqual(self.advertised(0), {name for name, rate in rates.items() if "publish." not in rate})

    # ------------------------------------------------------------------ parameters

    def refusal(self, *arguments, program="tissue_contact_node"):
        """The fatal message of a start that must fail."""
        code, output = harness.run([harness.program(program), "__name:=tissue_contact", *arguments])
        self.assertEqual(code, 1, output)
        if rospy.has_param(harness.NODE):
            rospy.delete_param(harness.NODE)
        return [line for line in output.splitlines() if "[FATAL]" in line][0]

    def test_parameters(self):
        """The names that the node says it reads."""
        known = re.search(r"It reads (.*)\. It was given", self.refusal("_no_such_parameter:=1")).group(1)
        self.assertEqual(sorted(known.split(", ")), sorted(row["parameter"] for row in TABLES["Private parameters"]))

    def test_defaults_and_ranges_of_parameters(self):
        """A value that is none is refused with what is allowed, and the default."""
        kinds = {row["type"] for row in TABLES["Private parameters"]}
        self.assertLessEqual(kinds, {"number", "word", "switch", "text", "texts", "path", "-"})
        checked = 0
        for row in TABLES["Private parameters"]:
            if row["type"] not in ("number", "word", "switch"):
                continue
            said = self.refusal("_scene:=" + harness.SCENE, "_%s:=bad_value" % row["parameter"])
            allowed, default = self.told(said)
            if row["type"] == "number":
                self.assert_number(row, said)
            else:
                self.assertEqual(row["allowed"].replace("`", ""), allowed.replace(" or ", ", "), said)
                self.assertEqual(row["default"], default, said)
            checked += 1
        self.assertGreaterEqual(checked, 4)

    @staticmethod
    def told(refusal):
        """What is allowed, and the default."""
        return re.search(r'bad_value"; it must be (.*?); default ([\w.+-]+)', refusal).groups()

    def assert_number(self, row, refusal):
        """A row that has what the refusal of a bad value tells."""
        allowed, default = self.told(refusal)
        self.assertEqual(read_numbers(row["allowed"]), read_numbers(allowed)[:2], refusal)
        self.assertEqual("> " in row["allowed"], "> " in allowed, refusal)
        self.assertEqual(*[text if text == "auto" else float(text) for text in (row["default"], default)], refusal)
        self.assertEqual(row["unit"], re.search(r"<=? \S+ ?(.*)", allowed).group(1), refusal)

    def test_parameters_of_haptics(self):
        """Names, defaults and ranges; and the same defaults of the launch file's arguments and in --help."""
        name = "tissue_contact_haptics"
        known = re.search(r"It reads (.*)\. It was given", self.refusal("_no_such_parameter:=1", program=name)).group(1)
        self.assertEqual(sorted(known.split(", ")), sorted(row["parameter"] for row in HAPTICS))
        launch = xml.etree.ElementTree.parse(os.path.join(harness.PACKAGE, "launch", "haptics.launch"))
        arguments = {argument.get("name"): argument.get("default") for argument in launch.iter("arg") if argument.get("default") is not None}
        self.assertEqual(set(arguments), {row["parameter"] for row in HAPTICS} | {"name"})
        lines = harness.run([harness.program(name), "--help"])[1].splitlines()
        helped = {word: re.search(r"default ([\d.]+)$", line) for line in lines for word in re.findall(r"~(\w+)", line)}
        self.assertEqual(set(helped), {row["parameter"] for row in HAPTICS})
        for row in HAPTICS:
            self.assertEqual(arguments[row["parameter"]], row["default"], row)
            if row["type"] == "number":
                self.assert_number(row, self.refusal("_%s:=bad_value" % row["parameter"], program=name))
                self.assertEqual(helped[row["parameter"]].group(1), row["default"], row)

    def test_numbers_that_change(self):
        """Every kind there is, in a scene that has them all: names, types, ranges and units of its descriptions."""
        where = "where: [{sphere: {center_m: [0, 0, 0.02], radius_m: 0.02}}]"
        scene = self.changed_scene({
            "    damping: {stiffness_s: 0.003}\n": "    damping: {stiffness_s: 0.003}\n    regions:\n      - {name: hard, %s, material: "
            "{youngs_modulus_pa: 8000, poissons_ratio: 0.3}, damping: {stiffness_s: 0.01}}\n" % where,
            "static: 0.6, kinetic: 0.4}\n": "static: 0.6, kinetic: 0.4}\n  - {instrument: probe, tissue: block, region: hard, law: "
            "orthotropic, axis: {link_direction: [1, 0, 0]}, static: [0.6, 0.5], kinetic: [0.4, 0.3]}\n"})
        with harness.node(scene):
            described = harness.Listener(harness.NODE + "/parameter_descriptions", ConfigDescription).wait(len, "descriptions")[0]
        names = {"block.hard": "<other>", "friction/probe/": "friction/<one>/", "/block/": "/<tissue>/", "regions/hard": "regions/<region>"}
        found = set()
        for one in described.groups[0].parameters:
            name = one.name
            for given, general in names.items():
                name = name.replace(given, general)
            name = re.sub("^(friction/<one>/)<tissue>", r"\1<other>", re.sub("/[0-9]$", "/<n>", name))
            low, high = [next(number.value for number in limits.doubles + limits.ints if number.name == one.name)
                         for limits in (described.min, described.max)]
            found.add((name, one.type, self.unit_of(one.name), low, high))
        self.assertEqual(found, {(row["parameter"], row["type"], row["unit"], *read_numbers(row["allowed"]))
                                 for row in TABLES["Numbers that change while it runs"]})

    # ------------------------------------------------------------------ messages, tables, programs

    @staticmethod
    def default_of(argument, display):
        """As roslaunch finds it, `ROS_HOME` as people have it."""
        text = argument.get("default")
        if text is None:
            return "must be given"
        with unittest.mock.patch.dict(os.environ, {"ROS_HOME": "~/.ros", "DISPLAY": display}):
            return str(resolve_args(text)) or "none"

    def test_arguments_of_launch_files(self):
        documented, found = collections.defaultdict(dict), collections.defaultdict(dict)
        for row in TABLES["Launch files"]:
            for name in row["launch files"].split(", "):
                self.assertNotIn(row["argument"], documented[name])
                documented[name][row["argument"]] = row["default"].replace("<launch file>", name)
        for file in glob.glob(os.path.join(harness.PACKAGE, "launch", "*.launch")):
            name = os.path.splitext(os.path.basename(file))[0]
            for argument in xml.etree.ElementTree.parse(file).getroot().findall("arg"):  # not those it hands on
                if argument.get("value"):  # what it makes of others
                    continue
                with_display, without = [self.default_of(argument, display) for display in (":0", "")]
                is_by_display = (with_display, without) == ("True", "False")
                self.assertTrue(is_by_display or with_display == without, (name, argument.attrib))
                found[name][argument.get("name")] = "with a display" if is_by_display else without
        self.assertEqual(set(found.pop("haptics")), {row["parameter"] for row in HAPTICS} | {"name", "wrench", "servo_cf"})
        self.assertEqual(found, documented)

    def test_fields_of_messages(self):
        files = [file for kind in ("msg", "srv") for file in glob.glob(os.path.join(harness.PACKAGE, kind, "*." + kind))]
        self.assertGreaterEqual(len(files), 7)
        for file in files:
            name = os.path.splitext(os.path.basename(file))[0]
            with open(file, encoding="utf-8") as stream:
                found = [re.match(r"([\w/\[\]]+)\s+(\w+(?:=\d+)?)\s*(?:#\s*(.*))?$", line) for line in stream]
            fields = [(m[2], m[1], self.unit_at_the_start(m[3] or "")) for m in found if m]
            self.assertEqual([(row["field"], row["type"], row["unit"]) for row in TABLES[name]], fields, name)

    @staticmethod
    def unit_at_the_start(comment):
        match = re.match("(%s)(?=[ ,;]|$)" % "|".join(UNITS), comment)
        return match[1] if match else ""

    @staticmethod
    def unit_of(name):
        return next((unit for suffix, unit in SUFFIXES if name.endswith(suffix)), "")

    def test_columns_of_the_replay(self):
        outputs = {"--csv": self.path("out.csv"), "--timing": self.path("times.csv")}
        self.replayed(harness.SCENE, self.bag_of("press.bag", harness.press(3)), outputs["--csv"], "--timing", outputs["--timing"])
        for option, file in outputs.items():
            with open(file, encoding="ascii") as stream:
                columns = stream.readline().strip().split(",")
            self.assertEqual([row["column"] for row in TABLES[option]], columns)
            for row in TABLES[option]:
                self.assertEqual(row["unit"], self.unit_of(row["column"]), row)

    def test_keys_of_the_manifest(self):
        manifest = self.path("made.yaml")
        self.replayed(harness.SCENE, self.bag_of("press.bag", harness.press(3)), self.path("out.csv"), "--manifest", manifest)
        with open(manifest, encoding="utf-8") as stream:
            self.assertEqual([row["key"] for row in TABLES["--manifest"]], list(yaml.safe_load(stream)))

    def test_exit_codes(self):
        programs = {os.path.basename(file) for file in glob.glob(os.path.dirname(harness.program("tissue_contact_node")) + "/tissue_contact_*")}
        self.assertEqual(programs, {row["program"] for row in TABLES["Exit codes"]})
        for row in TABLES["Exit codes"]:
            for argument, column in [("--help", "done"), ("--no-such-option", "wrong arguments")]:
                done = subprocess.run([harness.program(row["program"]), argument], stdin=subprocess.DEVNULL,
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=harness.DEADLINE_S, check=False)
                self.assertEqual(str(done.returncode), row[column], (row["program"], argument))


if __name__ == "__main__":
    harness.main(Reference)
