#!/usr/bin/env python3
"""Tests put_joints.py."""

import unittest

from put_joints import put

BODY = """name = "small"

[[part]]
name = "trunk"

# Ours.
[[joint_set]]
name = "ours"

[[joint_set.joint]]
name = "middle"
depth_offset = 0.1

# Theirs.
[[joint_set]]
name = "theirs"

[[joint_set.joint]]
name = "middle"
depth_offset = 0.2

[[surface]]
part = "trunk"
"""

FITTED = """[[joint_set]]
name = "theirs"

[[joint_set.joint]]
name = "middle"
depth_offset = 0.3

[[joint_set]]
name = "others"
"""


class PutJoints(unittest.TestCase):
    def test_replaces_only_the_sets_of_both(self):
        text, replaced = put(FITTED, BODY)
        self.assertEqual(replaced, ["theirs"])
        self.assertEqual(text, BODY.replace("0.2", "0.3"))

    def test_replaces_only_the_sets_asked_for(self):
        self.assertEqual(put(FITTED, BODY, ["ours"]), (BODY, []))

    def test_does_nothing_twice(self):
        once, _ = put(FITTED, BODY)
        self.assertEqual(put(FITTED, once)[0], once)


if __name__ == "__main__":
    unittest.main()
