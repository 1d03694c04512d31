"""Starts the node of vesalius: ros2 launch vesalius vesalius.launch.py source:=realsense: (docs/ros2.md)."""

import shlex
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

# Argument: the program's flag and what it is.
FLAGS = {
    "subscribe": ("--subscribe", "namespace of a camera's driver whose topics are the source"),
    "depth_topic": ("--depth-topic", "topic of depth"),
    "colour_topic": ("--colour-topic", "topic of colour"),
    "camera_info_topic": ("--camera-info-topic", "topic of the calibration"),
    "model": ("--model", "model file"),
    "options_file": ("--options", "TOML file with options of detector and tracking"),
    "node": ("--node", "name of the node"),
    "namespace": ("--namespace", "namespace of the node"),
    "frame_id": ("--frame-id", "coordinate frame of the pictures, optical"),
    "camera_pose": ("--camera-pose", "FRAME,X,Y,Z,ROLL,PITCH,YAW: where the camera stands"),
    "stamps": ("--stamps", "times of messages: frame or now"),
    "record": ("--record", "MCAP file for the same messages"),
}


def program():
    """That of the installation which this file is of, or else the path's."""
    installed = Path(__file__).resolve().parents[3] / "bin" / "vesalius"
    return str(installed) if installed.exists() else "vesalius"


def start(context):
    def value(name):
        return LaunchConfiguration(name).perform(context)

    words = [program(), "ros2"]
    for name, (flag, _) in FLAGS.items():
        if value(name):
            words += [flag, value(name)]
    words += shlex.split(value("arguments"))
    if value("source"):
        words += ["--", value("source")]
    return [ExecuteProcess(cmd=words, name="vesalius", output="screen", sigterm_timeout="10")]


def generate_launch_description():
    arguments = {"source": "recording, folder or camera; not with subscribe"}
    arguments.update({name: text for name, (_, text) in FLAGS.items()})
    arguments["arguments"] = "further words of `vesalius ros2`, as a shell reads them"
    declared = [DeclareLaunchArgument(name, default_value="", description=text) for name, text in arguments.items()]
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
