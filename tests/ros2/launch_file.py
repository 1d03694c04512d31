#!/usr/bin/env python3
"""What colcon and `ros2 launch` find of vesalius below a prefix, and what the launch file starts.

Usage: launch_file.py CMAKE BUILD_DIR FOLDER

ROS 2's launch is on no machine without ROS 2: a stand-in of the few classes that the file takes from it says which words
would be run, and these are run with an installed program's stand-in.
"""

import json
import os
import runpy
import shutil
import subprocess
import sys
import types
import xml.etree.ElementTree as xml
from pathlib import Path


def expect(found, wanted, what):
    if found != wanted:
        sys.exit(f"launch_file.py: {what}: {found!r}, expected {wanted!r}")


def description_of(file):
    """Loads the file with what stands for the modules of launch; returns its arguments, and what makes the process."""
    launch, actions, substitutions = (types.ModuleType(n) for n in ("launch", "launch.actions", "launch.substitutions"))
    launch.LaunchDescription = list
    actions.DeclareLaunchArgument = lambda name, *, default_value, description: ("argument", name, default_value)
    actions.ExecuteProcess = lambda *, cmd, **unused: cmd
    actions.OpaqueFunction = lambda *, function: ("function", function)
    substitutions.LaunchConfiguration = lambda name: types.SimpleNamespace(perform=lambda context: context[name])
    sys.modules |= {m.__name__: m for m in (launch, actions, substitutions)}
    found = runpy.run_path(str(file))["generate_launch_description"]()
    return {each[1]: each[2] for each in found if each[0] == "argument"}, found[-1][1]


def main():
    cmake, build, folder = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run([cmake, "--install", f"{build}/src/cli/ros2", "--prefix", str(folder)], check=True, capture_output=True)
    share = folder / "share"
    expect((share / "ament_index/resource_index/packages/vesalius").read_text(), "", "the index's file")
    manifest = xml.parse(share / "vesalius/package.xml").getroot()
    expect(manifest.get("format"), "3", "the manifest's format")
    expect(manifest.findtext("name"), "vesalius", "the package's name")
    expect(manifest.findtext("export/build_type"), "cmake", "how colcon builds it")
    hooks = json.loads((Path(__file__).parent.parent.parent / "colcon.pkg").read_text())["hooks"]
    expect([(folder / hook).read_text() for hook in hooks], ["prepend-non-duplicate;AMENT_PREFIX_PATH;\n"], "what colcon sets")
    program = folder / "bin/vesalius"
    program.parent.mkdir()
    program.write_text('#!/usr/bin/env python3\nimport json, sys\nprint(json.dumps(sys.argv[1:]))\n')
    os.chmod(program, 0o755)
    arguments, start = description_of(share / "vesalius/launch/vesalius.launch.py")

    def run(**values):
        (words,) = start(arguments | values)
        expect(words[0], str(program), "the program")
        return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)

    expect(set(arguments.values()), {""}, "values that nobody gave")
    expect(run(source="a b.mcap"), ["ros2", "--", "a b.mcap"], "a recording")
    expect(run(subscribe="/camera", model="m.model", frame_id="eye", options_file="o.toml",
               arguments="--remap /tf:=/robot/tf --id-prefix 'b'"),
           ["ros2", "--subscribe", "/camera", "--model", "m.model", "--options", "o.toml", "--frame-id", "eye",
            "--remap", "/tf:=/robot/tf", "--id-prefix", "b"], "a driver's topics")
    return 0


if __name__ == "__main__":
    sys.exit(main())
