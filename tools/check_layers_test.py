#!/usr/bin/env python3
"""check_layers.py passes a tree that keeps the rules and fails each way of breaking them."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).parent / "check_layers.py"

GOOD = {
    "src/vesalius/CMakeLists.txt": "vesalius_library(core FOLDERS base forest . OPENS_NO_FILES PUBLIC base/error.h base/image.h)\n",
    "tests/capsule/CMakeLists.txt": "vesalius_library(capsule)\n",
    "src/io/CMakeLists.txt": "vesalius_library(io FOLDERS files\n  sources)  # bottom to top\n",
    "src/draw/CMakeLists.txt": "set(public_headers\n  draw.h)\nvesalius_library(draw TESTS_USE io PUBLIC ${public_headers})\n",
    "src/cli/CMakeLists.txt": (
        "set(folders . detect)\nset(uses io)\n"
        "macro(vesalius_satellite name)\nendmacro()\n  vesalius_satellite(pictures draw)\n"
        "vesalius_library(cli FOLDERS ${folders} USES ${uses})\n"
    ),
    "include/vesalius/error.h": "#include <string>\n",
    "include/vesalius/image.h": '#include "vesalius/error.h"\n',
    "src/vesalius/forest/forest.h": '#include "vesalius/image.h"\n',
    "src/vesalius/detect.h": '//   #include "io/sources/open.h"\n#include "vesalius/forest/forest.h"\n',
    "src/vesalius/detect.cpp": '#include "vesalius/detect.h"\n#include "generated.inc"\n',
    "src/vesalius/base/error_test.cpp": '#include <fstream>\n#include "vesalius/detect.h"\n#include "capsule/body.h"\n',
    "tests/capsule/body.h": '#include "vesalius/image.h"\n',
    "src/io/files/png.h": '#include "vesalius/detect.h"\n#include <fstream>\n',
    "src/io/sources/open.h": '#include "io/files/png.h"\n',
    "include/vesalius/draw.h": '#include "vesalius/image.h"\n',
    "src/draw/draw.cpp": '#include "vesalius/draw.h"\n',
    "src/draw/draw_test.cpp": '#include "io/files/png.h"\n',
    "training/train/CMakeLists.txt": "vesalius_library(train USES io draw)\n",
    "training/train/grow.h": '#include "io/files/png.h"\n#include "vesalius/detect.h"\n',
    "training/train/recipe.h": '#include "vesalius/image.h"\n#include "vesalius/draw.h"\n',
    "training/train/recipe_test.cpp": '#include "vesalius/forest/forest.h"\n',
    "tools/private_headers.txt": "# headers: why\nio/files/: files\nvesalius/detect.h: what is measured\n",
    "docs/library.md": "| header | what |\n|---|---|\n| `vesalius/error.h` | errors |\n| `vesalius/image.h` | pictures |\n"
                       "| `vesalius/draw.h` | drawings |\n",
    "src/cli/flags.h": '#include "io/sources/open.h"\n',
    "src/cli/pictures/pictures.cpp": '#include "vesalius/draw.h"\n#include "cli/flags.h"\n',
}

BUDGET = """# folder, lines, for whom
include/vesalius 9
src/vesalius 9
src/vesalius/forest 9
src/io/files 9  people who bring PNG
src/io/sources 9
src/draw 9
src/cli 9
src/cli/pictures 9
training/train 9
"""


def run(changes):
    """Exit code and output for the good tree with these files changed."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**GOOD, **changes}.items():
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr


class CheckLayers(unittest.TestCase):
    def expect_violation(self, changes, place):
        code, output = run(changes)
        self.assertEqual(code, 1, output)
        self.assertEqual(len(output.splitlines()), 1, output)
        self.assertTrue(output.startswith(place), output)

    def test_good_tree_passes(self):
        code, output = run({})
        self.assertEqual(code, 0, output)

    def test_folder_includes_folder_above(self):
        changes = {"src/vesalius/base/size.h": '\n#include "vesalius/forest/forest.h"\n'}
        self.expect_violation(changes, "src/vesalius/base/size.h:2:")

    def test_folder_of_satellite_includes_folder_above(self):
        changes = {"src/io/files/png.h": '#include "io/sources/open.h"\n', "src/io/sources/open.h": ""}
        self.expect_violation(changes, "src/io/files/png.h:1:")

    def test_command_includes_another_command(self):
        changes = {"src/cli/flags.h": '#include "cli/pictures/list.h"\n', "src/cli/pictures/list.h": ""}
        self.expect_violation(changes, "src/cli/flags.h:1:")

    def test_units_include_each_other(self):
        changes = {"include/vesalius/error.h": '#include "vesalius/image.h"\n'}
        self.expect_violation(changes, "src/vesalius/base/error.h:1: units include each other: vesalius/base/error, "
                                       "vesalius/base/image")

    def test_units_include_each_other_through_a_third(self):
        changes = {"src/io/files/a.h": '#include "io/files/b.h"\n', "src/io/files/b.h": "",
                   "src/io/files/b.cpp": '#include "io/files/c.h"\n', "src/io/files/c.h": '#include "io/files/a.h"\n'}
        self.expect_violation(changes, "src/io/files/a.h:1: units include each other")

    def test_core_includes_satellite(self):
        self.expect_violation({"src/vesalius/detect.cpp": '#include "vesalius/draw.h"\n'}, "src/vesalius/detect.cpp:1:")

    def test_core_includes_what_is_for_tests(self):
        self.expect_violation({"src/vesalius/detect.cpp": '#include "capsule/body.h"\n'}, "src/vesalius/detect.cpp:1:")

    def test_file_in_no_library(self):
        self.expect_violation({"src/stray/stray.cpp": ""}, "src/stray/stray.cpp:1:")

    def test_core_opens_files(self):
        self.expect_violation({"src/vesalius/base/image.h": "#include <fstream>\n"}, "src/vesalius/base/image.h:1:")

    def test_satellite_includes_satellite(self):
        self.expect_violation({"src/draw/canvas.h": '#include "io/files/png.h"\n'}, "src/draw/canvas.h:1:")

    def test_test_includes_satellite_that_it_may_not(self):
        changes = {"src/io/files/png_test.cpp": '#include "vesalius/draw.h"\n'}
        self.expect_violation(changes, "src/io/files/png_test.cpp:1:")

    def test_installed_header_includes_one_that_is_not(self):
        self.expect_violation({"include/vesalius/draw.h": '#include "vesalius/forest/forest.h"\n'}, "include/vesalius/draw.h:1:")

    def test_public_header_on_no_list(self):
        self.expect_violation({"include/vesalius/size.h": ""}, "include/vesalius/size.h:1: is on no PUBLIC list")
        changes = {"src/vesalius/CMakeLists.txt": GOOD["src/vesalius/CMakeLists.txt"].replace("image.h", "image.h base/size.h"),
                   "docs/library.md": GOOD["docs/library.md"] + "| `vesalius/size.h` | sizes |\n"}
        self.expect_violation(changes, "include/vesalius/size.h: is not there, and vesalius/base/size.h is PUBLIC")

    def test_path_not_from_root(self):
        self.expect_violation({"src/io/files/png.cpp": '#include "png.h"\n'}, "src/io/files/png.cpp:1:")

    def test_missing_file(self):
        self.expect_violation({"src/io/files/png.cpp": '#include "io/files/gone.h"\n'}, "src/io/files/png.cpp:1:")

    def test_product_uses_workshop(self):
        changes = {"src/draw/CMakeLists.txt": "vesalius_library(draw USES train TESTS_USE io PUBLIC draw.h)\n",
                   "src/draw/canvas.h": '#include "train/grow.h"\n'}
        self.expect_violation(changes, "src/draw/canvas.h:1:")

    def test_workshop_uses_what_it_does_not_name(self):
        changes = {"training/train/CMakeLists.txt": "vesalius_library(train USES io)\n", "training/train/recipe.h": "",
                   "training/train/split.h": '#include "vesalius/draw.h"\n'}
        self.expect_violation(changes, "training/train/split.h:1: includes draw/draw.h: train may not include draw")

    def test_workshop_uses_private_header_without_a_reason(self):
        changes = {"training/train/split.h": '#include "vesalius/forest/forest.h"\n'}
        self.expect_violation(changes, "training/train/split.h:1: includes vesalius/forest/forest.h, which is not public")
        private = GOOD["tools/private_headers.txt"]
        changes["tools/private_headers.txt"] = private + "vesalius/forest/:\n"
        self.expect_violation(changes, "tools/private_headers.txt: vesalius/forest/ has no reason")
        changes["tools/private_headers.txt"] = private + "vesalius/forest/: so are trees\n"
        self.assertEqual(run(changes)[0], 0)

    def test_private_header_that_nobody_includes_any_more(self):
        changes = {"tools/private_headers.txt": GOOD["tools/private_headers.txt"] + "cuda/ vesalius/base/size.h: once\n"}
        code, output = run(changes)
        self.assertEqual(code, 1)
        self.assertEqual(output.splitlines(), ["tools/private_headers.txt: nobody includes cuda/",
                                               "tools/private_headers.txt: nobody includes vesalius/base/size.h"])

    def test_many_public_headers(self):
        def surface(count):
            names = [f"base/public{i}.h" for i in range(count)]
            rows = "".join(f"| `{name.replace('base', 'vesalius')}` | one |\n" for name in names)
            library = "vesalius_library(core FOLDERS base forest . PUBLIC base/error.h base/image.h " + " ".join(names) + ")\n"
            return {**{f"include/{name.replace('base', 'vesalius')}": "" for name in names}, "src/vesalius/CMakeLists.txt": library,
                    "docs/library.md": GOOD["docs/library.md"] + rows}

        self.assertEqual(run(surface(22))[0], 0)
        self.expect_violation(surface(23), "26 public headers, expected at most 25")

    def test_public_header_is_documented(self):
        table = GOOD["docs/library.md"]
        self.expect_violation({"docs/library.md": table.replace("| `vesalius/draw.h` | drawings |\n", "")},
                              "docs/library.md: vesalius/draw.h is public and not in the table")
        self.expect_violation({"docs/library.md": table + "| `io/files/png.h` | pictures |\n"},
                              "docs/library.md: io/files/png.h is in the table and not public")

    def test_folder_grows_past_its_budget(self):
        grown = {"src/draw/draw.cpp": "//\n" * 6}
        self.expect_violation({**grown, "tools/line_budget.txt": BUDGET.replace("src/draw 9", "src/draw 5")}, "src/draw: 6 lines")
        code, output = run({**grown, "src/draw/draw_test.cpp": "//\n" * 99, "tools/line_budget.txt": BUDGET})
        self.assertEqual(code, 0, output)

    def test_budget_names_each_folder(self):
        changes = {"tools/line_budget.txt": BUDGET.replace("src/draw 9\n", "")}
        self.expect_violation(changes, "tools/line_budget.txt: src/draw is missing; it has 1 lines")
        self.expect_violation({"tools/line_budget.txt": BUDGET + "src/gone 9\n"}, "tools/line_budget.txt: src/gone has no sources")

    def test_folder_has_many_units(self):
        changes = {f"src/draw/unit{i}.h": "" for i in range(25)}
        self.expect_violation({**changes, "tools/line_budget.txt": BUDGET}, "src/draw: 26 units")

    def test_two_types_have_one_name(self):
        one = "namespace vesalius {\nnamespace test {\nstruct Fit;\n}  // namespace test\nstruct Fit {\n};\n}  // namespace vesalius\n"
        self.expect_violation({"src/draw/fit.h": one, "tools/fit/fit.h": one}, "tools/fit/fit.h:5: defines vesalius::Fit, as src/draw/fit.h does")
        for other in (one.replace("struct Fit {", "template <class T>\nstruct Fit {"), one.replace("vesalius", "other"),
                      one.replace("struct Fit {", "struct Fit;")):
            code, output = run({"src/draw/fit.h": one, "tools/fit/fit.h": other})
            self.assertEqual(code, 0, output)

    def test_no_core(self):
        code, output = run({"src/vesalius/CMakeLists.txt": ""})
        self.assertNotEqual(code, 0)
        self.assertIn("vesalius_library(core", output)


if __name__ == "__main__":
    unittest.main()
