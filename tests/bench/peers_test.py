#!/usr/bin/env python3
"""Checks the counting of bench/peers against counting by hand. Needs nothing but Python."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench" / "peers"))
from counts import Counts, across_ray_m, iou, lies_on, markdown  # noqa: E402

ALL = 0xFF


class Rules(unittest.TestCase):
    def test_a_person_lies_on_a_mask_by_half_of_either(self):
        self.assertTrue(lies_on(0b1111, 0b11110000 | 0b0011, ALL))  # half of its own pixels
        self.assertFalse(lies_on(0b1111, 0b11110001, ALL))
        self.assertTrue(lies_on(0b11111111, 0b0001, ALL))  # covers all of a partial mask
        self.assertFalse(lies_on(0, 0b0001, ALL))

    def test_pixels_without_reading_do_not_count(self):
        self.assertTrue(lies_on(0b1111, 0b0001, 0b0011))
        self.assertFalse(lies_on(0b1111, 0b0001, 0b1110))
        self.assertEqual(iou(0b1111, 0b0011, 0b0111), 2 / 3)
        self.assertEqual(iou(0, 0, ALL), 0.0)

    def test_counts_by_hand(self):
        counts = Counts()
        counts.add(0, None, None, ALL)
        counts.add(0, None, 0b1, ALL)          # somebody in an empty frame
        counts.add(1, 0b1111, 0b0111, ALL)     # found
        counts.add(1, 0b1111, 0b11110000, ALL)  # elsewhere
        counts.add(-1, 0b1111, None, ALL)      # missed
        counts.add(2, None, 0b1, ALL)          # one of two, whoever it is
        counts.add_time(10.0, 20.0)
        counts.add_time(30.0, 20.0)
        counts.add_time(11.0, 50.0)
        self.assertEqual(counts.figures(), {"people.found": (2, 5), "people.false": 2, "frames.empty_with_person": (1, 2),
                                            "mask.iou_where_found": 0.75, "ms": 11.0, "cpu_ms": 30.0})

    def test_what_is_not_known_is_left_out(self):
        figures = Counts().figures()
        self.assertEqual(figures["people.found"], (0, 0))
        self.assertNotIn("mask.iou_where_found", figures)
        self.assertNotIn("ms", figures)

    def test_distance_across_the_ray(self):
        across, down = across_ray_m((13.0, 14.0), (10.0, 10.0), 2.0, (100.0, 100.0))
        self.assertAlmostEqual(across, 0.1)
        self.assertAlmostEqual(down, 0.08)

    def test_a_table_has_empty_cells(self):
        self.assertEqual(markdown(["a", "b"], [[1, None]]), "| a | b |\n|---|---|\n| 1 |  |")


if __name__ == "__main__":
    unittest.main()
