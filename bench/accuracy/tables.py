#!/usr/bin/env python3
"""Makes the tables of docs/accuracy.md from what bench/accuracy/measure left.

    bench/accuracy/tables.py PAGE MODEL=FOLDER...

In PAGE everything between `<!-- table NAME -->` and `<!-- end -->` becomes table NAME of TABLES, with a column, or some, for each
model; MODEL is the word that stands above it. A row's text has figures in it as {figure:format} (docs/metrics.md has the figures):
n, d   numerator, denominator      % %1   per cent, with so many decimals      .2   value with so many decimals      mm   whole, with its sign
"""
import json
import pathlib
import re
import sys

RECORDINGS = {  # row: source under the folder of real frames
    "`alina_wave`, one person, and the room empty": "real/alina_wave",
    "`fallseq`, in black before a black sofa": "real/fallseq",
    "`uva_person`, an upper body turning": "real/uva_person",
    "`uc3m`, a cluttered lab": "real/uc3m",
    "`tue_people`, a robot's hall": "real/tue_people",
    "`pcl`: five from behind, one close": "real/pcl",
    "`jointvosf`": "real/jointvosf",
    "`neg_7scenes_kitchen`": "real/neg_7scenes_kitchen",
    "`neg_aims`, halls, smoothed stereo": "real/neg_aims",
    "`neg_leezl_tabletop`": "real/neg_leezl_tabletop",
    "`neg_pcl`": "real/neg_pcl",
    "`sequences/alina`, a whole recording": "sequences/alina",
    "`sequences/fallseq`": "sequences/fallseq",
    "`sofa_realsense`, on a sofa, smoothed stereo": "sequences/sofa_realsense",
    "`urfd`, 4.3 m away before a wall": "sequences/urfd",
    "`handheld`, rolled, head and shoulders": "sequences/handheld",
}
PARTS = {"faces, top": "face_top", "bottom": "face_bottom", "chest": "chest", "upper arms": "upper_arm", "elbows": "elbow", "forearms": "forearm",
         "hands": "hand", "hips": "hips", "thighs": "thigh", "knees": "knee", "legs": "leg", "feet": "foot"}
SCORES = [f"{low}_to_{low + 10}" for low in range(0, 100, 10)]
JOINTS = {"shoulders": "shoulder", "elbows": "elbow", "wrists": "wrist", "hands": "hand", "hips": "hip", "knees": "knee",
          "ankles": "ankle", "feet": "foot"}

# What rendered frames have in common: rows of (label, text).
PEOPLE = [
    ("people found", "{people.found:n} of {people.found:d}, {people.found:%1} %"),
    ("false people a frame; empty frames with somebody", "{people.false:.3}; {frames.empty_with_person:n} of {frames.empty_with_person:d}"),
    ("mask IoU where found", "{mask.iou_where_found:.2}"),
    ("person IoU of the labels; body pixels of empty frames", "{pixels.person_iou:.3}; {pixels.body_on_empty:%2} %"),
    ("mean recall of classes, background as a rival; of parts inside the true masks", "{pixels.mean_recall:%1}; {pixels.mean_recall_inside:%1} %"),
    ("visible parts right; of the upper body", "{parts.right:%}; {parts.right_upper:%} %"),
    ("joints within 10 cm; those seen; those hidden", "{joints.at_10cm:%}; {joints.seen.at_10cm:%}; {joints.hidden.at_10cm:%} %"),
    ("found of those with 75 to 100 / 50 to 75 / 25 to 50 % of their parts visible",
     "{visible.75-100%:%} / {visible.50-75%:%} / {visible.25-50%:%} %"),
    ("at 1 to 2 / 2 to 3 / 3 to 4 / over 4 m", "{distance.1-2m:%} / {distance.2-3m:%} / {distance.3-4m:%} / {distance.4m-:%} %"),
    ("standing / sitting / kneeling / lying", "{posture.standing:%} / {posture.sitting:%} / {posture.kneeling:%} / {posture.lying:%} %"),
    ("up to 1.2 / 1.5 / 1.65 / 1.8 m tall / taller",
     "{stature.0-1.2m:%} / {stature.1.2-1.5m:%} / {stature.1.5-1.65m:%} / {stature.1.65-1.8m:%} / {stature.1.8m-:%} %"),
    ("seen from the front / side / back", "{heading.front:%} / {heading.side:%} / {heading.back:%} %"),
]
SIDES = [
    ("parts given out that are right", "{given.right:%1} %", "{given.right.%s:%} %"),
    ("on the mirror partner's place", "{given.mirrored:%1} %", "{given.mirrored.%s:%} %"),
    ("people with swapped sides", "{sides.swapped:%1} %", "{sides.swapped.%s:%} %"),
    ("yaw within 45 degrees", "{yaw.right:%1} %", "{yaw.right.%s:%} %"),
    ("joints given out that are within 10 cm", "{joints.given_right:%1} %", "{joints.given_right.%s:%} %"),
]
PROTOCOL = [
    ("people found", "{people.found:%1} %"),
    ("false people a frame", "{people.false:.3}"),
    ("mask IoU where found", "{mask.iou_where_found:.2}"),
    *PEOPLE[7:9], PEOPLE[11],
    ("visible parts right, of all people", "{parts.right:%} %"),
    ("mean average precision of the parts' centres at 10 cm", "{centre_precision:%1} %"),
]
CLIPS = [
    ("found; false", "{people.found:n} of {people.found:d}; {people.false:n}"),
    ("visible parts right; those given out", "{parts.right:%}; {given.right:%} %"),
    ("mask IoU where found", "{mask.iou_where_found:.2}"),
]
FOLLOWED = [*CLIPS, ("ids a person; IDF1; HOTA", "{track.ids:.2}; {track.idf1:%1}; {track.hota:%1} %")]


class Runs(dict):
    """{run: {source or name of a set: its record}} of one model."""
    folder = ""

    def __missing__(self, run):
        sys.exit(f"{self.folder}: no {run}.json, expected all that bench/accuracy/measure leaves")


def load(folder):
    runs = Runs()
    runs.folder = folder
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as e:
            sys.exit(f"{path}: {e}, expected what `vesalius evaluate --json` writes")
        runs[path.stem] = {key: of_set for of_set in record["sets"] for key in (of_set["source"], of_set["name"].rsplit("/")[-1])}
        runs[path.stem] |= {"only": record["sets"][0], "sets": record["sets"]}
    return runs


def pooled(sets, figure):
    have = [of["figures"][figure] for of in sets if figure in of["figures"]]
    if not have:
        return None
    counts = [sum(of[part] for of in have) for part in ("numerator", "denominator")]
    return {"numerator": counts[0], "denominator": counts[1], "value": counts[0] / counts[1] if counts[1] else float("nan")}


def shown(value, form):
    if form in "nd":
        return f"{value['numerator' if form == 'n' else 'denominator']:.0f}"
    if form == "mm":
        return f"{value['value']:+.0f}"
    return f"{100 * value['value']:.{form[1:] or 0}f}" if form[0] == "%" else f"{value['value']:{form}f}"


def figure_of(of_sets, name):
    if name == "centre_precision":
        parts = of_sets[0]["centre_precision"].values()
        return {"value": sum(parts) / len(parts)}
    return pooled(of_sets, name) if len(of_sets) > 1 else of_sets[0]["figures"].get(name)


def filled(text, *of_sets):
    """Fills in the figures of a set, or of some added up; a dash where there are none."""
    values = [(figure_of(of_sets, name), form) for name, form in re.findall(r"\{(.+?):([^:}]+)\}", text)]
    if all(value is None for value, _ in values):
        return ""
    shown_values = iter("-" if value is None else shown(value, form) for value, form in values)
    return re.sub(r"\{.+?:[^:}]+\}", lambda _: next(shown_values), text)


def grid(corner, columns, rows):
    """A table of {heading: cell of a row} and rows."""
    lines = [f"| {corner} | " + " | ".join(columns) + " |", "|---" * (len(columns) + 1) + "|"]
    return lines + [f"| {row} | " + " | ".join(cell(content) for cell in columns.values()) + " |" for row, content in rows]


def by_set(models, rows, corner, sets):
    """A column for each set of each model; sets are {heading: (run, set)}."""
    columns = {f"{model}{', ' + heading if heading else ''}": lambda text, of=runs[run][key]: filled(text, of)
               for model, runs in models.items() for heading, (run, key) in sets.items()}
    return grid(corner, columns, rows)


def which(models):
    def cell(runs):
        return lambda row: ", ".join(filled(text, runs[run]["only"]) for run, text in row)
    found = "{people.found:n} of {people.found:d}; {people.false:n}"
    rows = [(label, [(run, found)]) for label, run in [
        ("hard (`held_out.toml`), 600 frames: people found; false", "held_out"), ("usual (`held_out_usual.toml`), 600", "held_out_usual"),
        ("two people side by side, 150", "pairs"), ("homes (`held_out_home.toml`), 150", "held_out_home"),
        ("care (`held_out_care.toml`), 150", "held_out_care")]]
    rows += [(label, [("held_out", text), ("held_out_usual", text)]) for label, text in [
        ("mask IoU where found: hard, usual", "{mask.iou_where_found:.2}"), ("person IoU of labels", "{pixels.person_iou:.3}"),
        ("mean recall of the parts, inside the true masks", "{pixels.mean_recall_inside:%1} %"), ("given-out parts that are right", "{given.right:%1} %"),
        ("people with swapped sides", "{sides.swapped:%1} %"), ("yaw within 45 degrees", "{yaw.right:%} %"),
        ("joints within 10 cm", "{joints.at_10cm:%} %"), ("body pixels on empty frames", "{pixels.body_on_empty:%2} %")]]
    return grid("rendered frames of other bodies, rooms and motions", {model: cell(runs) for model, runs in models.items()}, rows)


def real(models):
    """A row for each set of real frames, and what all of them have."""
    def cell(runs, text):
        return lambda key: filled(text, *(runs["real"]["sets"] if key == "all" else [runs["real"][key]]))
    first = next(iter(models.values()))
    columns = {"frames": lambda key: str(sum(of["frames"] for of in first["real"]["sets"]) if key == "all" else first["real"][key]["frames"]),
               "people": cell(first, "{people.found:d}")}
    for model, runs in models.items():
        columns |= {f"{model}: {heading}": cell(runs, text) for heading, text in (
            ("found", "{people.found:n}"), ("false", "{people.false:n}"), ("mask IoU", "{mask.iou_where_found:.3}"))}
    return grid("set", columns, [*RECORDINGS.items(), ("all", "all")])


def joints(models):
    columns = {f"{model}, {name}": lambda joint, sets=runs[run]["sets"]: "; ".join(filled("{joint.%s.at_10cm:%%}" % one, *sets) for one in joint)
               for model, runs in models.items() for run, name in (("joints", "four people"), ("joints_man", "one man"))}
    rows = [("head", ["head"]), ("shoulder centre", ["shoulder_center"]), ("spine", ["spine"]), ("hip centre", ["hip_center"]),
            *((f"{label}, l; r", [f"l_{name}", f"r_{name}"]) for label, name in JOINTS.items())]
    table = grid("within 10 cm, %", columns, rows)
    every = [filled("{joints.at_10cm:%1}", *runs[run]["sets"]) for runs in models.values() for run in ("joints", "joints_man")]
    swapped = [filled("{sides.swapped:%1}", *runs[run]["sets"]) for runs in models.values() for run in ("joints", "joints_man")]
    return [*table, f"| all | {' | '.join(every)} |", f"| people with swapped sides | {' | '.join(swapped)} |"]


def sides(models):
    columns = {f"{model}: {heading}": lambda texts, runs=runs, heading=heading: filled(
        texts[0] if heading == "all" else texts[1].replace("%s", heading), runs["held_out_usual"]["only"])
        for model, runs in models.items() for heading in ("all", "front", "side", "back")}
    return grid("`held_out_usual`", columns, [(label, texts) for label, *texts in SIDES])


def by_part(models, figure):
    def cell(part):
        names = [part] if part == "neck" else [f"l_{part}", f"r_{part}"]
        return lambda of: filled("; ".join("{%s:%%}" % figure.replace("PART", name) for name in names), of)
    columns = {label: cell(part) for label, part in [*list(PARTS.items())[:2], ("neck", "neck"), *list(PARTS.items())[2:]]}
    return columns, [(f"{model}, `{name}`", runs["protocol"][name]) for model, runs in models.items() for name in ("clear", "cluttered")]


def parts_found(models):
    lines = []
    for fewest in ("4", "8"):
        columns, rows = by_part(models, f"part.right_of_{fewest}.PART")
        table = grid("%", columns, [(f"{label}, {fewest}", row) for label, row in rows])
        lines += table if not lines else table[2:]
    return lines


def scores(models):
    sets = {f"{model}, `{run}`": runs[run]["only"] for model, runs in models.items() for run in ("held_out", "held_out_usual")}
    columns = {score.replace("_to_", "-"): lambda of, score=score: filled("{score.right_at.%s:%%}" % score, of) for score in SCORES}
    return grid("score, %", columns, list(sets.items()))


def curve(models, axis, points, sets, figures):
    """A row at each of `points` of a curve over scores or parts; figures are (heading, key of the curve, format)."""
    columns = {f"{model}, `{name}`: {heading}": lambda point, of=runs["protocol"][name][axis], key=key, form=form: shown(
        {"value": next(at[key] for at in of if abs(at["threshold"] - point) < 1e-6)}, form) + " %" * (form[0] == "%")
        for model, runs in models.items() for name in sets for heading, key, form in figures}
    return grid("least", columns, [(str(point), point) for point in points])


def sensors(models):
    rows = [("Kinect v1, 320x240 (600 frames)", "held_out"), ("Kinect v2, 512x424", "kinect_v2"), ("the same, half of the pixels", "kinect_v2_half"),
            ("Azure Kinect, 640x576", "azure_kinect"), ("D435, 640x360", "d435")]
    columns = {f"{model}: {heading}": lambda run, runs=runs, text=text: filled(text, runs[run]["only"])
               for model, runs in models.items() for heading, text in (
                   ("found", "{people.found:%1} %"), ("false a frame", "{people.false:.3}"), ("person IoU of labels", "{pixels.person_iou:.3}"))}
    return grid("`held_out`, 200 frames", columns, rows)


def bias(models):
    joint = {name: [name] for name in ("head", "neck", "torso")} | {
        label: [f"l_{name}", f"r_{name}"] for label, name in (("shoulders, l; r", "shoulder"), ("elbows", "elbow"), ("hands", "hand"), ("hips", "hip"),
                                                              ("knees", "knee"), ("feet", "foot"))}
    columns = {label: lambda row, names=names: filled("; ".join("{joint.%s.%s:mm}" % (name, row[1]) for name in names), row[0])
               for label, names in joint.items()}
    rows = [(f"{model}, {label}", (runs["held_out_usual"]["only"], figure)) for model, runs in models.items()
            for label, figure in (("all", "up_mm"), ("within 25 cm", "placed_up_mm"))]
    return grid("mm too high", columns, rows)


def left_out(models):
    """People and false ones where the least score of each recording is the one that finds most in the others, at five false people there or fewer."""
    def at(sets, score):
        of_curve = [(of, next(one for one in of["curve_over_score"] if abs(one["threshold"] - score) < 1e-6)) for of in sets]
        people = sum(one["rate"] * of["figures"]["people.found"]["denominator"] for of, one in of_curve if one["rate"] is not None)
        return people, sum(one["false_per_frame"] * of["frames"] for of, one in of_curve)

    def chosen(sets):
        scores = [one["threshold"] for one in sets[0]["curve_over_score"]]
        return max((score for score in scores if at(sets, score)[1] < 5.5), key=lambda score: (round(at(sets, score)[0]), score))

    rows = []
    for model, runs in models.items():
        recordings = {}
        for of in runs["real"]["sets"]:
            recordings.setdefault(pathlib.Path(of["source"]).name.removesuffix("_wave"), []).append(of)
        results = []
        for name, own in recordings.items():
            score = chosen([of for other, sets in recordings.items() if other != name for of in sets])
            results.append((score, *at(own, score)))
        rows.append((model, (f"{min(score for score, _, _ in results):.2f} to {max(score for score, _, _ in results):.2f}",
                             f"{sum(people for _, people, _ in results):.0f}; {sum(false for _, _, false in results):.0f}")))
    return grid("", {"least scores": lambda row: row[0], "found; false": lambda row: row[1]}, rows)


def twice(models, names, rows):
    """Rows of (run, label, text), each in a column for each of names: {heading: prefix or suffix of runs}."""
    columns = {f"{model}: {heading}": lambda row, runs=runs, make=make: filled(row[1], *runs[make(row[0])]["sets"])
               for model, runs in models.items() for heading, make in names.items()}
    return grid("", columns, [(label, (run, text)) for run, label, text in rows])


FOUND_FALSE = "{people.found:n} of {people.found:d}, {people.false:n}"


def colour(models):
    run = {"with colour": lambda name: "real" if name == "real" else f"colour_hue_{name}", "without": lambda name: f"colour_none_{name}"}
    return twice(models, run, [
        ("pairs", "two side by side, 300 frames: found, false", FOUND_FALSE), ("pairs", "mask IoU where found", "{mask.iou_where_found:.3}"),
        ("hard", "`held_out`, 300", FOUND_FALSE), ("crossing", "two who cross, ten clips of 10 s, followed", FOUND_FALSE),
        ("crossing", "IDF1; HOTA", "{track.idf1:%1}; {track.hota:%1} %"), ("real", "the 16 real sets", FOUND_FALSE)])


def worth(models):
    text = {"hard: found, false": "{people.found:%1} %, {people.false:n}", "mask IoU": "{mask.iou_where_found:.2}",
            "visible parts right": "{parts.right:%} %"}
    lines = [("as it is", "held_out", "real"), *((label, f"without_{run}", f"without_{run}_real") for label, run in (
        ("no second pass", "pass"), ("no smoothing", "smoothing"), ("every second pixel", "pixels"), ("the labeller asked everywhere", "gate")))]
    columns = {}
    for model, runs in models.items():
        columns |= {f"{model}, {heading}": lambda row, runs=runs, one=one: filled(one, runs[row[0]]["only"]) for heading, one in text.items()}
        columns[f"{model}, real: found, false"] = lambda row, runs=runs: filled("{people.found:n}, {people.false:n}", *runs[row[1]]["sets"])
    return grid("", columns, [(label, runs) for label, *runs in lines])


HARD = {"hard": ("held_out", "only"), "usual": ("held_out_usual", "only")}
CLIP_SETS = ("moving", "walking", "sitting")
TABLES = {
    "which": which,
    "real": real,
    "followed": lambda models: by_set(models, [("found", "{people.found:n} of {people.found:d}"), ("false", "{people.false:n}"), ("ids", "{track.ids:.2}")],
                                      "followed", {name: ("followed", name) for name in ("alina", "fallseq", "sofa_realsense", "urfd")}),
    "joints": joints,
    "rendered": lambda models: by_set(models, PEOPLE, "600 frames of 320x240, Kinect v1", HARD),
    "scores": scores,
    "sensors": sensors,
    "protocol": lambda models: by_set(models, PROTOCOL, "", {name: ("protocol", name) for name in ("clear", "cluttered")}),
    "fewest": lambda models: curve(models, "curve_over_parts", (4, 8, 12, 16, 20), ("clear", "trained"),
                                   [("found", "rate", "%1"), ("parts right", "part_rate", "%1")]),
    "least_score": lambda models: curve(models, "curve_over_score", (0.9, 0.8, 0.7, 0.5, 0.3, 0.1), ("clear", "cluttered"),
                                        [("found", "rate", "%1"), ("false", "false_per_frame", ".3")]),
    "parts_found": parts_found,
    "parts_all": lambda models: grid("%", *by_part(models, "centre.PART.at_10cm")),
    "clips": lambda models: by_set(models, CLIPS, "each frame by itself", {name: ("clips", name) for name in CLIP_SETS}),
    "clips_followed": lambda models: by_set(models, FOLLOWED, "followed", {name: ("clips_followed", name) for name in CLIP_SETS}),
    "sides": sides,
    "bias": bias,
    "left_out": left_out,
    "colour": colour,
    "worth": worth,
}


def models_of(arguments, usage):
    """Returns (model, folder) of each MODEL=FOLDER; ends the program with its usage where something else is there."""
    if not arguments or not all("=" in model for model in arguments):
        sys.exit(usage)
    return [model.split("=", 1) for model in arguments]


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    page, models = pathlib.Path(sys.argv[1]), {name: load(folder) for name, folder in models_of(sys.argv[2:], __doc__)}
    try:
        text = page.read_text(encoding="utf-8")
    except OSError as e:
        sys.exit(f"{page}: {e.strerror}, expected a page with tables")

    def table(match):
        if match[1] not in TABLES:
            sys.exit(f"{page}: no table {match[1]}, expected one of {', '.join(TABLES)}")
        return f"<!-- table {match[1]} -->\n" + "\n".join(TABLES[match[1]](models)) + "\n\n<!-- end -->"

    page.write_text(re.sub(r"<!-- table (\w+) -->\n.*?<!-- end -->", table, text, flags=re.S), encoding="utf-8")


if __name__ == "__main__":
    main()
