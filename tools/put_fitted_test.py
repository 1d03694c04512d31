#!/usr/bin/env python3
"""Tests put_fitted.py."""

import unittest

from put_fitted import put, put_distribution

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


class PutFitted(unittest.TestCase):
    def test_replaces_only_the_sets_of_both(self):
        text, replaced = put(FITTED, BODY)
        self.assertEqual(replaced, ["theirs"])
        self.assertEqual(text, BODY.replace("0.2", "0.3"))

    def test_replaces_only_the_sets_asked_for(self):
        self.assertEqual(put(FITTED, BODY, ["ours"]), (BODY, []))

    def test_does_nothing_twice(self):
        once, _ = put(FITTED, BODY)
        self.assertEqual(put(FITTED, once)[0], once)

    def test_puts_a_distribution_at_the_end_or_in_its_place(self):
        first = "[distribution]\nnoise = 1\n\n[[distribution.part]]\nname = \"trunk\"\n"
        self.assertEqual(put_distribution(FITTED, BODY), (BODY, False))
        once, _ = put_distribution(first, BODY)
        self.assertEqual(once, BODY + "\n" + first)
        middle = once + "\n[[surface]]\n"
        self.assertEqual(put_distribution(first.replace("1", "2"), middle)[0], middle.replace("noise = 1", "noise = 2"))


if __name__ == "__main__":
    unittest.main()
