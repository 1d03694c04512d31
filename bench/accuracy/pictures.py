#!/usr/bin/env python3
"""Draws the pictures of docs/accuracy.md from what bench/accuracy/measure left; needs Matplotlib (python3-matplotlib).

    bench/accuracy/pictures.py FOLDER MODEL=FOLDER...
"""
import pathlib
import sys

import matplotlib
from matplotlib import pyplot
from tables import PARTS, load, models_of

matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "vesalius", "font.family": "sans-serif", "font.size": 9, "axes.spines.top": False,
                            "axes.spines.right": False})
COLOURS = ("#0072b2", "#c04c00", "#009e73", "#555555")  # told apart by the colour-blind too


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def curves(models, path):
    """People found, and their visible parts that are right, against the fewest parts of a person: the paper's Figs 9, 13 and 14."""
    figure, axes = pyplot.subplots(1, 3, figsize=(9, 3), sharey=True)
    for axis, name in zip(axes, ("clear", "cluttered", "trained")):
        for colour, (model, runs) in zip(COLOURS, models.items()):
            curve = runs["protocol"][name]["curve_over_parts"]
            for key, dashes, what in (("rate", "-", "people found"), ("part_rate", "--", "their parts right")):
                axis.plot([at["threshold"] for at in curve], [None if at[key] is None else 100 * at[key] for at in curve], dashes, color=colour,
                          label=f"{model}: {what}")
        axis.set(title=name, xlabel="fewest parts", xlim=(1, 25), ylim=(0, 100))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("%")
    axes[0].legend(fontsize=7, frameon=False)
    save(figure, path)


def parts(models, path):
    """Of people found with at least so many parts the share that have each part right: the paper's Figs 10 and 11."""
    names = [side + part for part in PARTS.values() for side in ("l_", "r_")]
    names.insert(4, "neck")
    figure, axes = pyplot.subplots(1, len(models), figsize=(4.5 * len(models), 5.5), sharey=True, squeeze=False)
    for axis, (model, runs) in zip(axes[0], models.items()):
        figures = runs["protocol"]["clear"]["figures"]
        for at, (fewest, colour) in enumerate(zip((4, 8), COLOURS)):
            places = [row + 0.4 * at for row in range(len(names))]
            bars = axis.barh(places, [100 * figures[f"part.right_of_{fewest}.{name}"]["value"] for name in names], 0.36, color=colour,
                             label=f"at least {fewest} parts")
            axis.bar_label(bars, fmt="%.0f", fontsize=5, padding=1)
        axis.set(title=model, xlabel="% right", xlim=(0, 100))
        axis.set_yticks([row + 0.2 for row in range(len(names))], names)
    axes[0][0].invert_yaxis()
    axes[0][0].legend(fontsize=7, frameon=False, loc="lower left", bbox_to_anchor=(0, 1.02))
    save(figure, path)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    folder, models = pathlib.Path(sys.argv[1]), {name: load(path) for name, path in models_of(sys.argv[2:], __doc__)}
    curves(models, folder / "protocol_curves.svg")
    parts(models, folder / "protocol_parts.svg")


if __name__ == "__main__":
    main()
