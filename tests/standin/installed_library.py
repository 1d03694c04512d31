"""What the installed libraries in place of others have in common: what they export, and how programs of theirs are run."""
import re
import subprocess
import sys

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]


def run(*command, **more):
    print("$", *command, flush=True)
    return subprocess.run([str(each) for each in command], check=True, stdout=subprocess.PIPE, text=True, **more).stdout


def expect_same(what, left, right):
    if left != right:
        sys.exit(f"{what}: {left}, expected {right}")


def check_symbols(library, header, export_list, function, soname, stranger):
    """The library exports what its header declares and its list has, under the name that programs were linked to, and needs no library whose
    name begins with `stranger`. `function` is a pattern of its functions' names."""
    exported = {line.split()[-1] for line in run("nm", "-D", "--defined-only", library).splitlines()}
    listed = set(re.findall(rf"^ +({function});", export_list.read_text(), re.MULTILINE))
    declared = set(re.findall(rf"\b({function})\(", re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.DOTALL)))
    expect_same("exported symbols", exported, listed)
    expect_same("declared functions", declared, listed)
    dynamic = run("readelf", "-d", library)
    expect_same("soname", re.findall(r"\(SONAME\).*\[(.*)\]", dynamic), [soname])
    expect_same("needed", [name for name in re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic) if name.startswith(stranger)], [])


def expect_line(done, answer, line):
    """A program of another language has printed `answer`, and one line with `line` in it among the errors, or none for ""."""
    expect_same("a tracker", done.stdout, answer)
    if line not in done.stderr or len(done.stderr.splitlines()) != (1 if line else 0):
        sys.exit(f"expected a line with {line!r}, got {done.stderr}")
