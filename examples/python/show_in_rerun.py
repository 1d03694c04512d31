"""Shows the people of a source in the Rerun viewer, or writes what it shows: usage: show_in_rerun.py SOURCE [OUT.rrd]

Needs the package `rerun-sdk` beside vesalius.
"""

import sys

import rerun

import vesalius
import vesalius.rerun

rerun.init("vesalius", spawn=len(sys.argv) == 2)
if len(sys.argv) > 2:
    rerun.save(sys.argv[2])
tracker = vesalius.Tracker(vesalius.Detector())
for frame in vesalius.open(sys.argv[1]):
    vesalius.rerun.log(tracker.update(frame), frame)
