#!/usr/bin/env python3
"""Tests of what the site is built with: links of pages, links of the built site, signatures of Python, tables of accuracy."""

import json
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[2] / "bench/accuracy")]
import check_links  # noqa: E402
import python_reference  # noqa: E402
import tables  # noqa: E402
from stage import BrokenLinks, Stage  # noqa: E402


class Folder(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = Path(self.temporary.name)

    def write(self, files):
        for name, text in files.items():
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)


class StagedPages(Folder):
    def stage(self, pages):
        pages = {"docs/index.md": "# Index\n", "docs/images/x": "", "ARCHITECTURE.md": "# A\n", "README.md": "# R\n", **pages}
        self.write({f"repository/{name}": text for name, text in pages.items()})
        subprocess.run(["git", "init", "-q", self.folder / "repository"], check=True)
        Stage(self.folder / "repository", self.folder / "site").write_pages()
        return lambda name: (self.folder / "site" / name).read_text()

    def test_links_lead_to_pages_of_the_site(self):
        site = self.stage({"docs/a.md": "[b](starts/b.md#x) [A](../ARCHITECTURE.md) [e](https://e.org/a.md) [here](#y)\n", "docs/starts/b.md": "# B\n"})
        self.assertEqual(site("a.md"), "[b](starts/b.md#x) [A](project/ARCHITECTURE.md) [e](https://e.org/a.md) [here](#y)\n")

    def test_names_of_pages_become_links(self):
        site = self.stage({"docs/a.md": "See `docs/b.md`, (b.md) and docs/no.md; x/b.md too.\n\n    b.md\n\n```\nb.md\n```\n", "docs/b.md": "# B\n"})
        self.assertEqual(site("a.md"), "See [`docs/b.md`](b.md), ([b.md](b.md)) and docs/no.md; x/b.md too.\n\n    b.md\n\n```\nb.md\n```\n")

    def test_files_that_are_no_pages_come_along(self):
        self.write({"repository/examples/a": "int x;\n"})
        site = self.stage({"docs/a.md": "[x](../examples/a)\n"})
        self.assertEqual(site("a.md"), "[x](project/examples/a)\n")
        self.assertEqual(site("project/examples/a"), "int x;\n")

    def test_broken_links_are_named(self):
        with self.assertRaisesRegex(BrokenLinks, "docs/a.md: no.md: no such file"):
            self.stage({"docs/a.md": "[x](no.md)\n"})

    def test_pages_that_are_named_nowhere_are_in_the_navigation(self):
        index = self.stage({"docs/ros3.md": "# R\n"})("index.md")
        self.assertIn("ros3", index)
        self.assertNotIn("docs/ros2", index)

    def test_blocks_of_commands_get_their_language(self):
        site = self.stage({"docs/a.md": "```\nvesalius info\n```\n\n```\nframe -> people\n```\n\n```bash camera\nls\n```\n"})
        self.assertEqual(site("a.md"), "```bash\nvesalius info\n```\n\n```\nframe -> people\n```\n\n```bash camera\nls\n```\n")


class AccuracyTables(Folder):
    PAGE = "before\n<!-- table rendered -->\n| old |\n<!-- end -->\nafter\n"

    def record(self, model, run, found):
        figures = {"people.found": {"value": found / 4, "numerator": found, "denominator": 4}}
        one = {"name": run, "source": f"models/{run}.toml", "frames": 5, "figures": figures}
        self.write({f"{model}/{run}.json": json.dumps({"sets": [one]})})

    def filled(self, page=PAGE):
        self.write({"page.md": page})
        for model, found in (("a", 1), ("b", 3)):
            for run in ("held_out", "held_out_usual"):
                self.record(model, run, found)
        with unittest.mock.patch.object(sys, "argv", ["tables.py", str(self.folder / "page.md"), *(f"{model}={self.folder / model}" for model in "ab")]):
            tables.main()
        return (self.folder / "page.md").read_text()

    def test_a_table_takes_the_place_of_the_old_one(self):
        page = self.filled()
        self.assertTrue(page.startswith("before\n<!-- table rendered -->\n|"))
        self.assertTrue(page.endswith("<!-- end -->\nafter\n"))
        self.assertIn("| people found | 1 of 4, 25.0 % | 1 of 4, 25.0 % | 3 of 4, 75.0 % | 3 of 4, 75.0 % |", page)
        self.assertNotIn("old", page)
        self.assertEqual(self.filled(page), page)

    def test_figures_that_are_not_there_are_dashes_and_sets_add_up(self):
        sets = [{"figures": {"f": {"value": 0.5, "numerator": 1, "denominator": 2}}}, {"figures": {"f": {"value": 1, "numerator": 6, "denominator": 6}}}]
        self.assertEqual(tables.filled("{f:%1} of {f:d}, {f:.2}; {g:n}", *sets), "87.5 of 8, 0.88; -")
        self.assertEqual(tables.filled("{g:n}", sets[0]), "")

    def test_a_run_that_was_not_made_is_named(self):
        with self.assertRaisesRegex(SystemExit, "a: no protocol.json, expected all that"):
            self.filled("<!-- table protocol -->\n<!-- end -->\n")

    def test_an_unknown_table_changes_nothing(self):
        page = "<!-- table nosuch -->\n<!-- end -->\n"
        with self.assertRaisesRegex(SystemExit, "no table nosuch, expected one of which, real"):
            self.filled(page)
        self.assertEqual((self.folder / "page.md").read_text(), page)


class BuiltLinks(Folder):
    def broken(self, html):
        self.write({"a.html": html, "b.html": "<h1 id='there'>B</h1>"})
        return list(check_links.broken(self.folder))

    def test_targets_and_places_in_them_must_be_there(self):
        self.assertEqual(self.broken("<a href='b.html#there'></a><a href='https://e.org'></a><a href='#'></a>"), [])
        self.assertEqual(self.broken("<a href='c.html'></a>"), ["a.html: c.html: no such file"])
        self.assertEqual(self.broken("<a href='b.html#no'></a>"), ["a.html: b.html#no: no such place in that page"])

    def test_nothing_is_loaded_from_elsewhere(self):
        self.assertEqual(len(self.broken("<script src='https://e.org/x.js'></script>")), 1)
        self.assertEqual(len(self.broken("<link rel='stylesheet' href='//e.org/x.css'>")), 1)

    def test_no_pages_are_no_success(self):
        self.assertEqual(len(list(check_links.broken(self.folder))), 1)


class PythonReference(Folder):
    def page(self, stub, doc='    """Finds `all`."""\n'):
        self.write({"python/vesalius/__init__.py": '"""People in *depth*."""\nfrom ._vesalius import Camera, find\n'
                    'from ._vesalius import D as _D\n__all__ = ["Camera", "D", "find", "__version__"]\n'
                    f"class D(_D):\n{doc}    def __init__(self, model=None): ...\n"})
        path = self.folder / "_vesalius.pyi"
        if stub:
            path.write_text(stub)
        complete = python_reference.write(self.folder, self.folder / "site", path)
        return complete, (self.folder / "site/reference/python.rst").read_text()

    def test_signatures_and_docstrings_come_from_the_stub(self):
        complete, text = self.page('class Camera:\n    """A camera."""\n    @property\n    def fx(self) -> float:\n        """Pixels."""\n'
                                   "    @fx.setter\n    def fx(self, arg: float) -> None: ...\n"
                                   'class D:\n    def detect(self, depth: int = 0) -> list:\n        """Finds all."""\n'
                                   'def find(a: Annotated[NDArray, dict(order="C")]) -> str: ...\n')
        self.assertTrue(complete)
        self.assertIn(".. py:class:: Camera\n\n   A camera.", text)
        self.assertIn("   .. py:attribute:: fx\n      :type: float\n\n      Pixels.", text)
        self.assertIn(".. py:class:: D(model=None)\n\n   Finds ``all``.", text)
        self.assertIn("   .. py:method:: detect(depth: int=0) -> list\n\n      Finds all.", text)
        self.assertIn(".. py:function:: find(a: NDArray) -> str", text)
        self.assertIn(r"People in \*depth\*.", text)

    def test_docstrings_that_are_put_together(self):
        text = self.page('def options() -> str: ...\n', '    __doc__ = f"""Finds.\n\n    model: a path.\n\n{options()}"""\n')[1]
        self.assertIn("D(model=None)\n\n   Finds.\n\n   model: a path.\n\n   ``vesalius.options()`` says.", text)

    def test_other_modules_of_the_package(self):
        self.write({"python/vesalius/more.py": '"""More:\n\n    import vesalius.more\n"""\n__all__ = ["log"]\ndef log(a=1):\n    """Logs."""\n'
                    "def _hidden(): ...\n"})
        text = self.page(None)[1]
        self.assertIn("More:\n\n.. code-block:: python\n\n   import vesalius.more", text)
        self.assertIn(".. py:module:: vesalius.more\n\n.. py:function:: log(a=1)\n\n   Logs.", text)
        self.assertNotIn("_hidden", text)

    def test_without_the_stub_it_says_so(self):
        complete, text = self.page(None)
        self.assertFalse(complete)
        self.assertIn(".. py:data:: Camera\n\n   Of the compiled module", text)


if __name__ == "__main__":
    unittest.main()
