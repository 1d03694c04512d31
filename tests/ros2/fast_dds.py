#!/usr/bin/env python3
"""The node of `vesalius ros2` and Fast DDS in other processes, on the loopback.

usage: fast_dds.py CASE VESALIUS SENDER SOURCE_DIR WORK_DIR [PEER]

  types      one message of each type goes to Fast DDS, which reads it and writes it anew: the same bytes come back
  topics     Fast DDS reads all topics of a run on data/rooms, and who the node is
  rate       all topics at 30 Hz with pictures of 640x480 for VESALIUS_ROS2_SECONDS (5): none is lost, though another
             reader is killed meanwhile; whoever comes late gets what is latched
  subscribe  frames from topics that Fast DDS publishes, depth in millimetres and in metres
  usage      what cannot be meant ends in one line (needs no Fast DDS)
  vanish     the process that publishes a camera's topics is killed; the node says so and goes on when there is another
  spoilt     pictures and calibrations that are not what they say: a line each, then the good ones are taken

Exit code 77 without PEER: Fast DDS is not installed.
"""

import collections
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

RATE = 30
IMAGE, INFO, TEXT = "sensor_msgs/Image", "sensor_msgs/CameraInfo", "std_msgs/String"
PEOPLE_TOPICS = {"/vesalius/body_index": IMAGE, "/vesalius/labels": IMAGE, "/vesalius/camera_info": INFO,
                 "/vesalius/points": "sensor_msgs/PointCloud2", "/vesalius/markers": "visualization_msgs/MarkerArray",
                 "/vesalius/people": TEXT, "/tf": "tf2_msgs/TFMessage", "/humans/bodies/tracked": "hri_msgs/IdsList"}
FRAME_TOPICS = {"/vesalius/depth/image_rect": IMAGE, "/vesalius/depth/camera_info": INFO,
                "/vesalius/color/image_rect": IMAGE, "/vesalius/color/camera_info": INFO}
DISCOVERY = "/ros_discovery_info"


def fail(text):
    sys.exit(f"fast_dds.py: {text}")


def expect(found, expected, what):
    if found != expected:
        fail(f"{what}: {str(found)[:500]}, expected {str(expected)[:500]}")


def listen(topics, how=""):
    words = []
    for topic, of in topics.items():
        words += ["listen", of, topic] + ([how] if how else [])
    return words


def body_topics(ids):
    topics = {}
    for name in ids:
        topics[f"/humans/bodies/{name}/roi"] = "hri_msgs/NormalizedRegionOfInterest2D"
        topics[f"/humans/bodies/{name}/skeleton2d"] = "hri_msgs/Skeleton2D"
    return topics


class Case:
    def __init__(self, arguments):
        self.name, self.program, self.sender, self.source, self.work = arguments[:5]
        self.peer = arguments[5] if len(arguments) > 5 else ""
        # Tests that run at the same time do not hear each other. Domain ports up to 232 fit below 65536.
        self.domain = 1 + os.getpid() % 200
        shutil.rmtree(self.work, ignore_errors=True)
        Path(self.work).mkdir(parents=True)
        self.running = []

    def start_peer(self, seconds, words, name="peer"):
        out = open(f"{self.work}/{name}.jsonl", "w")
        process = subprocess.Popen([self.peer, str(self.domain), str(seconds), *words], stdout=out)
        self.running.append(process)
        end = time.monotonic() + 20
        while not Path(out.name).read_text():
            if process.poll() is not None or time.monotonic() > end:
                fail(f"{name} does not start")
            time.sleep(0.02)
        return process, out.name

    def messages(self, path):
        """Messages by topic, in the order in which they came."""
        by_topic = collections.defaultdict(list)
        lines = Path(path).read_text().split("\n")[:-1]  # a peer that was killed leaves half a line
        for line in map(json.loads, lines):
            if "topic" in line:
                by_topic[line["topic"]].append(line)
        return by_topic

    def clip(self, frames):
        """A folder in which a frame of data/rooms with people stays for so long."""
        demo, folder = Path(self.source) / "data/rooms", Path(self.work) / "clip"
        for kind in ("depth", "rgb"):
            (folder / kind).mkdir(parents=True, exist_ok=True)
            picture = sorted((demo / kind).iterdir())[0]
            for i in range(frames):
                shutil.copy(picture, folder / kind / f"{i:03}{picture.suffix}")
        shutil.copy(demo / "meta.json", folder)
        return str(folder)

    def vesalius(self, *arguments):
        return [self.program, "ros2", "--localhost", "--domain", str(self.domain), *arguments]

    def run(self):
        try:
            getattr(self, self.name)()
        finally:
            for process in self.running:
                if process.poll() is None:
                    process.kill()
                process.wait()
        print(f"{self.name}: as expected")

    def types(self):
        words = []
        kinds = sorted({*PEOPLE_TOPICS.values(), *body_topics(["x"]).values(), "rmw_dds_common/ParticipantEntitiesInfo"})
        for of in kinds:
            name = of.replace("/", "_")
            words += ["relay", of, f"/to/{name}", f"/from/{name}"]
        self.start_peer(100, words)
        done = subprocess.run([self.sender, str(self.domain), "types"], capture_output=True, text=True, timeout=200)
        print(done.stdout, end="")
        same = [line for line in done.stdout.splitlines() if ": same, " in line]
        if done.returncode != 0 or len(same) != len(kinds):
            fail(f"types: {done.stdout}{done.stderr}")

    def usage(self):
        demo = f"{self.source}/data/rooms"
        for words, code, why in (([], 2, "either SOURCE or --subscribe"), ([demo, "--subscribe", "/c"], 2, "either SOURCE"),
                                 (["--subscribe", "c"], 2, "--subscribe c: expected a name"),
                                 (["--subscribe", "/c", "--every-frame"], 2, "--every-frame goes with"),
                                 (["--subscribe", "/c", "--depth-topic", "/3"], 2, "--depth-topic /3: expected a name"),
                                 ([demo, "--node", "a-b"], 2, "node a-b: expected"),
                                 ([demo, "--namespace", "robot"], 2, "namespace robot: expected"),
                                 ([demo, "--remap", "tf"], 2, "--remap tf: expected FROM:=TO"),
                                 ([demo, "--domain", "300"], 2, "300"), ([demo, "--ros-distro", "hydro"], 2, "hydro"),
                                 ([demo, "--camera-pose", "base"], 2, "--camera-pose base: expected"),
                                 ([demo, "--id-prefix", "3"], 2, "prefix of ids 3: expected"),
                                 ([demo, "--reliable"], 2, "--reliable goes with"),
                                 ([f"{self.work}/nothing"], 1, "nothing"),
                                 ([demo, "--record", f"{self.work}/no/x.mcap"], 1, "x.mcap: cannot be created")):
            done = subprocess.run([self.program, "ros2", "--localhost", "-q", *words], capture_output=True, text=True, timeout=60)
            lines = done.stderr.splitlines()
            if done.returncode != code or len(lines) != 1 or why not in lines[0]:
                fail(f"{words}: {done.returncode}, {done.stderr}")
        settings = {**os.environ, "CYCLONEDDS_URI": "<CycloneDDS><Nonsense/></CycloneDDS>"}
        done = subprocess.run([self.program, "ros2", demo, "-q"], capture_output=True, text=True, timeout=60, env=settings)
        expect([done.returncode, len(done.stderr.splitlines()), "Nonsense" in done.stderr], [1, 1, True], done.stderr)

    def topics(self):
        ids = ["p1", "p2", "p3"]
        all_topics = {**PEOPLE_TOPICS, **FRAME_TOPICS}
        words = listen({**all_topics, **body_topics(ids)}) + listen({DISCOVERY: "rmw_dds_common/ParticipantEntitiesInfo"}, "latched")
        peer, out = self.start_peer(60, words)
        subprocess.run(self.vesalius(self.clip(8), "--rate", "2", "--quiet"), check=True, timeout=120)
        time.sleep(0.5)
        peer.kill()
        found = self.messages(out)
        for topic in all_topics:
            if not found[topic]:
                fail(f"nothing on {topic}")
        frames = [json.loads(message["data"]) for message in found["/vesalius/people"]]
        followed = {f"p{person['id']}" for frame in frames for person in frame["people"]}
        if not followed:
            fail("nobody was followed")
        for name in followed:
            for topic in body_topics([name]):
                if not found[topic]:
                    fail(f"nothing on {topic}")
        for topic in ("/vesalius/body_index", "/vesalius/labels"):
            for image in found[topic]:
                expect([image["encoding"], image["step"], image["frame_id"]],
                       ["mono8", image["size"][0], "camera_optical_frame"], topic)
                expect(image["bytes"], image["size"][0] * image["size"][1], topic)
        for cloud in found["/vesalius/points"]:
            expect(cloud["bytes"], cloud["size"][0] * cloud["point_step"], "bytes of the cloud")
        bodies = {}
        for message in found["/humans/bodies/tracked"]:
            bodies.setdefault(message["stamp_ns"], message["ids"])  # the last is empty, with the time of the one before
        expect(found["/humans/bodies/tracked"][-1]["ids"], [], "bodies at the end")
        for message in found["/tf"]:
            stamp = message["transforms"][0]["stamp_ns"]
            names = [t["child"][5:] for t in message["transforms"] if t["child"].startswith("body_")]
            if stamp in bodies:
                expect(names, bodies[stamp], "bodies in /tf")
        last = found[DISCOVERY][-1]
        most = max(found[DISCOVERY], key=lambda m: len(m["nodes"][0]["writers"]))
        expect([last["nodes"][0]["namespace"], last["nodes"][0]["name"]], ["/", "vesalius"], "node")
        if len(most["nodes"][0]["writers"]) < len(all_topics):
            fail(f"the node names {len(most['nodes'][0]['writers'])} writers, expected {len(all_topics)} and more")
        for writer in most["nodes"][0]["writers"]:
            expect(writer[:24], last["gid"][:24], "gid of a writer begins as that of its participant")
        print(f"topics: {len(found)} with messages, {len(frames)} frames, {sorted(followed)}, "
              f"{len(most['nodes'][0]['writers'])} writers of node {last['nodes'][0]['name']}")

    def rate(self):
        seconds = int(os.environ.get("VESALIUS_ROS2_SECONDS", "5"))
        read = dict(list(PEOPLE_TOPICS.items()) + list(body_topics(["p3", "p12"]).items()))
        keeper, kept = self.start_peer(seconds + 60, listen(read), "keeper")
        victim, _ = self.start_peer(seconds + 60, listen(read), "victim")
        with open(f"{self.work}/sender.json", "w") as out:
            sender = subprocess.Popen([self.sender, str(self.domain), "rate", str(seconds), "2"], stdout=out)
        self.running.append(sender)
        while not any(m["stamp_ns"] > 0 for m in self.messages(kept)["/vesalius/labels"]) and sender.poll() is None:
            time.sleep(0.1)
        time.sleep(seconds / 3)
        victim.kill()
        late = {"/humans/bodies/tracked": "hri_msgs/IdsList"}
        _, came = self.start_peer(seconds + 60, listen(late, "latched") + listen({"/vesalius/labels": IMAGE}, "sensor"), "late")
        expect(sender.wait(timeout=seconds + 60), 0, "sender")
        time.sleep(1)
        keeper.kill()
        told = json.loads(Path(f"{self.work}/sender.json").read_text())
        expected = [i * 10**9 for i in range(1, seconds * RATE + 1)]
        messages = self.messages(kept)
        for topic in read:
            stamps = [self.stamp_of(m) for m in messages[topic]]
            stamps = [stamp for stamp in stamps if stamp != 0]  # the one before all readers were there
            if topic == "/vesalius/people":  # has none
                expect(len(stamps), len(expected) + (1 if len(stamps) > len(expected) else 0), topic)
            else:
                expect(sorted(set(expected) - set(stamps)), [], f"{topic}: lost")
                expect(stamps, expected, f"{topic}: stamps")
        if told["seconds"] > 1.1 * seconds + 1:  # a writer that waits for the killed reader takes many seconds more
            fail(f"rate: {told['frames']} frames took {told['seconds']} s")
        if not self.messages(came)["/humans/bodies/tracked"] or not self.messages(came)["/vesalius/labels"]:
            fail("rate: who came late got nothing")
        print(f"rate: {len(read)} topics, {told['frames']} frames in {told['seconds']:.2f} s, none lost; writing a frame "
              f"took {told['write_ms']:.2f} ms, at most {told['longest_ms']:.1f} ms")
        self.latched()

    def latched(self):
        latched = {"/tf_static": "tf2_msgs/TFMessage", "/humans/bodies/tracked": "hri_msgs/IdsList",
                   DISCOVERY: "rmw_dds_common/ParticipantEntitiesInfo"}
        sender = subprocess.Popen([self.sender, str(self.domain), "latched", "30"], stdout=subprocess.PIPE, text=True)
        self.running.append(sender)
        expect(sender.stdout.readline().strip(), "written", "sender")
        _, out = self.start_peer(30, listen(latched, "latched") + listen({"/vesalius/people": TEXT}), "late_joiner")
        end = time.monotonic() + 20
        while len(self.messages(out)) < len(latched) and time.monotonic() < end:
            time.sleep(0.1)
        time.sleep(0.5)  # for what must not come
        found = self.messages(out)
        expect({topic: len(found[topic]) for topic in latched}, {topic: 1 for topic in latched}, "latched messages")
        expect(found["/humans/bodies/tracked"][0]["ids"], ["p3", "p12"], "ids")
        expect(len(found["/vesalius/people"]), 0, "messages that are not latched")
        print("rate: who came late got the last message of /tf_static, /humans/bodies/tracked and ros_discovery_info")

    @staticmethod
    def stamp_of(message):
        for inner in ("transforms", "markers"):
            if inner in message:
                return message[inner][0]["stamp_ns"]
        return message.get("stamp_ns", -1)

    @staticmethod
    def relay(*unit):
        """A peer that publishes the frames of the node `source` as a camera's driver would."""
        return ["relay", IMAGE, "/source/depth/image_rect", "/camera/depth/image_raw", *unit,
                "relay", INFO, "/source/depth/camera_info", "/camera/depth/camera_info",
                "relay", IMAGE, "/source/color/image_rect", "/camera/color/image_raw"]

    def source_until(self, holds, seconds=90):
        """Lets a node `source` play the clip again and again until something holds."""
        source, clip, end = None, self.clip(12), time.monotonic() + seconds
        while not holds():
            if time.monotonic() > end:
                fail(f"{self.name}: nothing for {seconds} s")
            if source is None or source.poll() is not None:
                source = subprocess.Popen(self.vesalius(clip, "--node", "source", "--rate", "2", "--stamps", "frame", "--quiet"))
                self.running.append(source)
            time.sleep(0.1)
        return source

    def vanish(self):
        lines = Path(self.work) / "said.txt"
        reader = subprocess.Popen(self.vesalius("--subscribe", "/camera", "--frames", "6", "--reliable"), stderr=lines.open("w"))
        self.running.append(reader)
        heard = {"/vesalius/people": TEXT}
        first, out = self.start_peer(200, self.relay() + listen(heard), "first")
        source = self.source_until(lambda: len(self.messages(out)["/vesalius/people"]) >= 2)
        first.kill()
        end = time.monotonic() + 30
        while "no depth on" not in lines.read_text() and time.monotonic() < end:
            time.sleep(0.1)
        expect(["no depth on /camera/depth/image_raw" in lines.read_text(), reader.poll()], [True, None], lines.read_text())
        source.kill()
        self.start_peer(200, self.relay(), "second")
        self.source_until(lambda: reader.poll() is not None)
        expect([reader.poll(), "6 frames" in lines.read_text()], [0, True], lines.read_text())
        print(lines.read_text(), end="")

    def subscribe(self):
        for unit in ("", "metres"):
            words = self.relay(*([unit] if unit else []))
            words += listen({"/source/people": TEXT, "/vesalius/people": TEXT, "/vesalius/camera_info": INFO})
            peer, out = self.start_peer(100, words, f"relay_{unit or 'millimetres'}")
            reader = subprocess.Popen(self.vesalius("--subscribe", "/camera", "--reliable", "--frames", "3"),
                                      stderr=subprocess.PIPE, text=True)
            self.running.append(reader)
            time.sleep(1)
            source = self.source_until(lambda: reader.poll() is not None)
            said = reader.stderr.read()
            if reader.poll() != 0:
                fail(f"subscribe: {said}")
            source.wait(timeout=60)
            peer.kill()
            found = self.messages(out)
            known = {f["frame"]: f for f in (json.loads(m["data"]) for m in found["/source/people"])}
            own = [json.loads(m["data"]) for m in found["/vesalius/people"]]
            expect(len(own) >= 2, True, f"frames with people from topics: {said}")
            expect("colour of /camera/color/image_raw" in said, True, said)
            apart = []
            for frame in own:
                number = round(float(frame["frame"]) * 2)
                there = sorted(known)[number]
                theirs = [p["position_m"] for p in known[there]["people"] if p["state"] != "hidden"]
                ours = [p["position_m"] for p in frame["people"] if p["state"] != "hidden"]
                expect(len(ours), len(theirs), f"people in {there}")
                for place in ours:
                    apart.append(min(sum((a - b) ** 2 for a, b in zip(place, other)) ** 0.5 for other in theirs))
            expect(max(apart) < 0.1, True, f"metres between people: {apart}")
            print(f"subscribe: depth in {unit or 'millimetres'}: {len(own)} frames, people at most {max(apart):.3f} m apart")

    def spoilt(self):
        self.start_peer(60, ["spoil", "/camera/depth/image_raw", "/camera/depth/camera_info"])
        done = subprocess.run(self.vesalius("--subscribe", "/camera", "--frames", "12", "--reliable"),
                              capture_output=True, text=True, timeout=60)
        print(done.stderr, end="")
        expect(done.returncode, 0, done.stderr)
        complaints = [line for line in done.stderr.splitlines() if "/camera/depth/" in line and "calibration of" not in line]
        expect(len(complaints), 8, "complaints")
        expect("12 frames" in done.stderr, True, done.stderr)


def main():
    case = Case(sys.argv[1:])
    if not case.peer and case.name != "usage":
        print("SKIPPED: Fast DDS (libfastrtps-dev, fastddsgen) is not installed")
        sys.exit(77)
    case.run()


if __name__ == "__main__":
    main()
