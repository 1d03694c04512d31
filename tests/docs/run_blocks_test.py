#!/usr/bin/env python3
"""Tests of run_blocks.py: pages that do what they say, and pages that do not."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import run_blocks  # noqa: E402


class Pages(unittest.TestCase):
    def follow(self, text, quick=True, python=sys.executable):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            page.write_text(text)
            reader = run_blocks.Reader("/bin/false", Path(folder), Path(folder), python, quick)
            with contextlib.redirect_stdout(io.StringIO()) as said:
                return reader.follow(page), said.getvalue()

    def expect_wrong(self, text, message):
        with self.assertRaisesRegex(run_blocks.Wrong, message):
            self.follow(text)

    def test_blocks_of_a_page_are_one_session(self):
        self.assertEqual(self.follow("```bash\nx=3\nmkdir a && cd a\n```\n\n```bash\necho $x in $(basename $PWD)\n```\n"
                                     "```text output\n3 in a\n```\n")[0], 2)

    def test_python_blocks_that_follow_each_other_are_one_session(self):
        self.assertEqual(self.follow("```python\nx = 3\n```\n```python\nprint(x)\n```\n```text output\n3\n```\n")[0], 2)

    def test_python_is_left_out_without_the_package(self):
        ran, said = self.follow("```python\nimport nothing\n```\n", python=None)
        self.assertEqual(ran, 0)
        self.assertIn("no Python with the package", said)

    def test_output_is_compared_in_order_with_dots_for_anything(self):
        block = "```bash\nprintf 'a 1 s\\nb\\nc\\n'\n```\n```text output\n"
        self.follow(block + "a ... s\nc\n```\n")
        self.expect_wrong(block + "c\nb\n```\n", r"page.md:1: expected the line\n  b")
        self.expect_wrong(block + "a ... m\n```\n", "expected the line")

    def test_a_command_that_fails_is_a_failure_and_names_what_was_not_reached(self):
        self.expect_wrong("```bash\nfalse\n```\n", "page.md:1: ended with 1")
        self.expect_wrong("```bash\nfalse | true\n```\n```bash\ntrue\n```\n", "page.md:4: not reached")

    def test_marks(self):
        self.expect_wrong("```\ntrue\n```\n", "without a language")
        self.expect_wrong("```bash sometimes\ntrue\n```\n", "unknown mark sometimes")
        self.expect_wrong("```bash no-run\ntrue\n```\n", "no-run without saying why")
        self.expect_wrong("```bash camera\ntrue\n```\n", "no camera in it")
        self.expect_wrong("```text output\nx\n```\n", "output of nothing")
        self.assertEqual(self.follow("```bash no-run: needs the moon\nfalse\n```\n")[0], 0)
        self.assertEqual(self.follow("```bash needs: moon\nfalse\n```\n")[0], 0)
        self.assertEqual(self.follow("```bash nightly\nfalse\n```\n")[0], 0)
        self.assertEqual(self.follow("```bash nightly\ntrue\n```\n", quick=False)[0], 1)

    def test_parts_of_files_are_compared(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "a.cpp").write_text("// A.\nint x;\n")
            block = run_blocks.Block(Path("page.md"), 1, "cpp", "file", "a.cpp", ["int x;"])
            run_blocks.compare_with_file(block, Path(folder))
            block.lines = ["int y;"]
            with self.assertRaisesRegex(run_blocks.Wrong, "not what stands in a.cpp"):
                run_blocks.compare_with_file(block, Path(folder))

    def test_a_viewer_is_looked_at_and_ended(self):
        text = ("```bash ctrl-c\npython3 -c 'import http.server as h, signal, sys\ns = h.HTTPServer((\"127.0.0.1\", 0), h.SimpleHTTPRequestHandler)\n"
                "signal.signal(signal.SIGINT, lambda *_: sys.exit(0))\nprint(\"http://127.0.0.1:%d/\" % s.server_port, flush=True)\n"
                "s.serve_forever()' 2>/dev/null\n```\n```text output\nhttp://127.0.0.1:...\n```\n")
        self.assertEqual(self.follow(text)[0], 1)


if __name__ == "__main__":
    unittest.main()
