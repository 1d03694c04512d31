"""The C++ reference: what the headers that are installed say, a page each, by Doxygen and Breathe."""

import subprocess
import sys
import textwrap
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import check_layers  # noqa: E402  (it reads which headers the CMake files install)

ABOUT = {
    "core": "The method: frames in, people out; people over time; fitted bodies.",
    "io": "Frames from files, recordings and cameras; models.",
    "draw": "Pictures of depth, labels and people.",
    "stream": "Frames read ahead, in real time; people as JSON.",
    "dataset": "Labelled frames in files; truth to compare with.",
    "synth": "Labelled frames of synthetic people.",
    "train": "Grows forests from labelled frames.",
    "eval": "Metrics and their intervals.",
    "evaluation": "Sets of frames measured, reports, comparison.",
    "report": "Documents and plots.",
}

SECTIONS = ("briefdescription detaileddescription define enum innerclass innernamespace func var typedef public-func "
            "public-attrib public-static-func public-static-attrib public-type user-defined")
DOXYFILE = """
PROJECT_NAME = vesalius
INPUT = {inputs}
STRIP_FROM_PATH = {source}
FULL_PATH_NAMES = YES
OUTPUT_DIRECTORY = {out}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
EXTRACT_LOCAL_CLASSES = NO
HIDE_FRIEND_COMPOUNDS = YES
JAVADOC_AUTOBRIEF = YES
MARKDOWN_SUPPORT = YES
AUTOLINK_SUPPORT = NO
CASE_SENSE_NAMES = YES
ENABLE_PREPROCESSING = YES
MACRO_EXPANSION = YES
QUIET = YES
WARN_AS_ERROR = FAIL_ON_WARNINGS
WARN_IF_UNDOCUMENTED = NO
WARN_IF_DOC_ERROR = YES
WARN_NO_PARAMDOC = NO
WARN_LOGFILE = {out}/warnings
"""


def libraries(source):
    """Libraries with C++ headers that are installed: the core first, the others by name."""
    folder = source / "src"
    found = [check_layers.read_library(path, source) for path in sorted(folder.rglob("CMakeLists.txt"))]
    found = [library for library in found if library and library.public and library.name != "c_interface"]
    return sorted(found, key=lambda library: (library.name != "core", library.name))


def run_doxygen(headers, source, out):
    out.mkdir(parents=True, exist_ok=True)
    inputs = " ".join(f'"{source / "include" / header}"' for header in headers)
    doxyfile = out / "Doxyfile"
    doxyfile.write_text(DOXYFILE.format(inputs=inputs, source=source / "include", out=out))
    done = subprocess.run(["doxygen", str(doxyfile)], check=False, stdout=subprocess.DEVNULL)
    warnings = (out / "warnings").read_text() if (out / "warnings").exists() else ""
    if done.returncode != 0 or warnings:
        sys.exit(f"doxygen ended with {done.returncode}:\n{warnings}")


def heading(text, mark="="):
    return f"{text}\n{mark * len(text)}\n\n"


def headers_of(library):
    """A library's headers as programs include them."""
    return sorted(f"vesalius/{Path(header).name}" for header in library.public)


def header_section(header):
    return (heading(header, "-") + f".. doxygenfile:: {header}\n   :project: vesalius\n   :sections: {SECTIONS}\n\n")


def component(library):
    """What a program writes to use a library."""
    text = f"# CMakeLists.txt\nfind_package(vesalius REQUIRED COMPONENTS {library.name})\n" \
           f"target_link_libraries(my_program PRIVATE vesalius::{library.name})"
    return ".. code-block:: cmake\n\n" + textwrap.indent(text, "   ") + "\n\n"


def page_of(library):
    headers = headers_of(library)
    first = f".. code-block:: cpp\n\n   #include \"{headers[0]}\"\n\n"
    return heading(library.name) + component(library) + first + "Everything is in the namespace ``vesalius``.\n\n" + \
        "".join(map(header_section, headers))


def write(source, staged, work):
    """Writes the pages below staged/reference/cpp. Returns the folder of Doxygen's XML."""
    folder = staged / "reference/cpp"
    found = libraries(source)
    run_doxygen([header for library in found for header in headers_of(library)], source, work / "doxygen")
    folder.mkdir(parents=True, exist_ok=True)
    index = heading("C++ reference") + \
        "From the headers that ``cmake --install`` puts in place. The guide :doc:`/library` has a program to begin with.\n\n"
    for library in found:
        index += heading(library.name, "-") + ABOUT.get(library.name, "") + "\n\n.. toctree::\n   :maxdepth: 1\n\n"
        (folder / f"{library.name}.rst").write_text(page_of(library))
        index += f"   {library.name}\n\n"
    (folder / "index.rst").write_text(index)
    return work / "doxygen/xml"
