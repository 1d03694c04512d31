#!/usr/bin/env python3
"""Listens to `vesalius detect --osc --udp` with python-osc and a socket, and compares with its JSON.

Usage: live.py PROGRAM SOURCE
"""

import json
import socket
import subprocess
import sys
import threading
from pathlib import Path
import tempfile

from pythonosc.dispatcher import Dispatcher
from pythonosc.osc_server import BlockingOSCUDPServer


def main():
    program, source = sys.argv[1:]
    heard, datagrams = [], []
    dispatcher = Dispatcher()
    dispatcher.set_default_handler(lambda address, *values: heard.append((address, values)))
    server = BlockingOSCUDPServer(("127.0.0.1", 0), dispatcher)
    server.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    listener.bind(("127.0.0.1", 0))
    listener.settimeout(2)

    def listen():
        try:
            while True:
                datagrams.append(json.loads(listener.recv(1 << 16)))
        except TimeoutError:
            pass

    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory() as folder:
        lines = Path(folder) / "people.jsonl"
        threads = threading.Thread(target=listen)
        threads.start()
        subprocess.run([program, "detect", source, "--track", "-q", "--json", lines,
                        "--osc-frame", "camera", "--osc", f"127.0.0.1:{server.server_address[1]}", "--udp", f"127.0.0.1:{listener.getsockname()[1]}"],
                       check=True)
        threads.join()
        frames = [line for line in map(json.loads, lines.read_text().splitlines()) if "frame" in line]
    people = {}
    for datagram in datagrams:
        people.setdefault(datagram["frame"], []).extend(datagram["people"])
    if people != {frame["frame"]: frame["people"] for frame in frames}:
        sys.exit("live.py: UDP: other people than in the JSON")
    expected = []
    for frame in frames:
        expected.append(("/vesalius/people", (len(frame["people"]), *(p["id"] for p in frame["people"]))))
        for person in frame["people"]:
            expected.append((f"/vesalius/{person['id']}/state", (person["state"],)))
            expected.append((f"/vesalius/{person['id']}/position", person["position_m"]))
            for name, joint in person["joints"]["k4abt32"].items():
                if joint["xyz_m"] is not None:
                    expected.append((f"/vesalius/{person['id']}/{name}", joint["xyz_m"]))
    if [address for address, _ in heard] != [address for address, _ in expected]:
        sys.exit(f"live.py: OSC: {len(heard)} messages, expected {len(expected)}")
    for (address, values), (_, wanted) in zip(heard, expected):
        if isinstance(wanted, list):
            wanted = [wanted[0], -wanted[1], -wanted[2]]
            if any(abs(a - b) > 1e-3 for a, b in zip(values, wanted)):
                sys.exit(f"live.py: OSC: {address} at {values}, expected {wanted}")
        elif tuple(values) != tuple(wanted):
            sys.exit(f"live.py: OSC: {address}: {values}, expected {wanted}")
    print(f"{len(frames)} frames, {len(datagrams)} datagrams of JSON, {len(heard)} OSC messages, as in the JSON")
    return 0


if __name__ == "__main__":
    sys.exit(main())
