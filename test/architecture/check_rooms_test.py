#!/usr/bin/python3
"""Plants each kind of violation in a small tree and sees check_rooms.py find it, at its line."""

import pathlib
import tempfile
import unittest

import check_rooms


class CheckRoomsTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.root = pathlib.Path(directory.name)

    def violations(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        found, files = check_rooms.check_sources(self.root)
        self.assertEqual(files, 1)
        return found

    def assert_one(self, path, text, *words):
        found = self.violations(path, text)
        self.assertEqual(len(found), 1, found)
        for word in (path, *words):
            self.assertIn(word, found[0])

    def test_clean_source(self):
        text = '#include "tissue_contact/solver/a.h"\n#include <vector>\n#include <Eigen/Core>\n#include <yaml-cpp/yaml.h>\n'
        text += '#include "tissue_contact/core/types.h"\n#include "contact/private.h"\n#include "solver/own.h"\n'
        self.assertEqual(self.violations("src/solver/a.cpp", text), [])

    def test_clean_ros_source(self):
        text = '#include <ros/ros.h>\n#include <tissue_contact/Status.h>\n#include "tissue_contact/simulation/a.h"\n'
        self.assertEqual(self.violations("src/ros/node/node.cpp", text), [])

    def test_clean_benchmark_source(self):
        text = '#include <ros/package.h>\n#include "tissue_contact/ros/a.h"\n#include "validation/a.h"\n#include "support/a.h"\n'
        self.assertEqual(self.violations("benchmark/a.cpp", text), [])

    def test_product_must_not_include_what_measures_it(self):
        for target in ("benchmark/a.h", "validation/a.h", "support/a.h"):
            self.assert_one("src/ros/a.cpp", f'#include "{target}"\n', "no room of the product")

    def test_validation_knows_neither_ros_nor_benchmark(self):
        self.assert_one("validation/a.cpp", "#include <ros/ros.h>\n", "ros/ros.h")
        self.assert_one("validation/a.cpp", '#include "benchmark/a.h"\n', "'benchmark'")

    def test_private_header_without_its_room(self):
        self.assert_one("src/solver/a.cpp", '#include "own.h"\n', "from the room on")

    def test_public_header_of_one_room(self):
        self.violations("include/tissue_contact/tissue/a.h", "")
        user = self.root / "src/tissue/a.cpp"
        user.parent.mkdir(parents=True)
        user.write_text('#include "tissue_contact/tissue/a.h"\n', encoding="utf-8")
        (self.root / "validation").mkdir()
        (self.root / "validation/a.cpp").write_text(user.read_text(encoding="utf-8"), encoding="utf-8")
        found = check_rooms.check_public(self.root)
        self.assertEqual(len(found), 1, found)
        self.assertIn("include/tissue_contact/tissue/a.h", found[0])
        user.write_text("", encoding="utf-8")
        user = self.root / "src/contact/a.cpp"
        user.parent.mkdir(parents=True)
        user.write_text('#include "tissue_contact/tissue/a.h"\n', encoding="utf-8")
        self.assertEqual(check_rooms.check_public(self.root), [])

    def test_comment_is_no_include(self):
        self.assertEqual(self.violations("src/core/a.cpp", "// #include <ros/ros.h>\n"), [])

    def test_lower_room(self):
        self.assert_one("include/tissue_contact/tissue/a.h", '\n#include "tissue_contact/solver/a.h"\n', ":2:", "'tissue'", "'solver'")

    def test_lower_room_in_angle_brackets(self):
        self.assert_one("src/contact/a.cpp", " #  include <tissue_contact/simulation/a.h>\n", ":1:", "'simulation'")

    def test_lower_room_private_header(self):
        self.assert_one("src/contact/a.cpp", '#include "simulation/a.h"\n', "'simulation'")

    def test_unknown_room(self):
        self.assert_one("src/utilities/a.cpp", "", "no room")

    def test_include_of_unknown_room(self):
        self.assert_one("src/ros/a.cpp", '#include "tissue_contact/utilities/a.h"\n', "'utilities' is no room")

    def test_way_around(self):
        self.assert_one("src/contact/a.cpp", '#include "../simulation/a.h"\n', "'..'")

    def test_private_header_in_public_one(self):
        self.assert_one("include/tissue_contact/contact/a.h", '#include "contact/private.h"\n', "public headers only")

    def test_third_party_in_public_header(self):
        for target in ("fcl/fcl.h", "urdf_model/model.h", "assimp/scene.h", "yaml-cpp/yaml.h"):
            self.assert_one("include/tissue_contact/contact/a.h", f"#include <{target}>\n", target, "public header")

    def test_ros_outside_its_room(self):
        for target in ("ros/ros.h", "sensor_msgs/JointState.h", "tf2_ros/buffer.h", "tissue_contact/Status.h"):
            self.assert_one("src/simulation/a.cpp", f"#include <{target}>\n", target)

    def test_linked(self):
        line = " 0x0001 (NEEDED)             Shared library: [{}]\n"
        allowed = line.format("liburdfdom_model.so.3.0") + line.format("libstdc++.so.6")
        self.assertEqual(check_rooms.check_linked(allowed), [])
        self.assertEqual(check_rooms.check_linked(allowed + line.format("libroscpp.so.4d")),
                         ["the core library links libroscpp.so.4d"])
        self.assertEqual(len(check_rooms.check_linked("")), 1)


if __name__ == "__main__":
    unittest.main()
