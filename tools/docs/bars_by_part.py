#!/usr/bin/env python3
"""Draws how often each part of people found is right, with at least four and eight parts (docs/metrics.md, part.right_of_*).

    tools/docs/bars_by_part.py OUT.svg SET NAME=figures.csv [NAME=figures.csv ...]

Each figures.csv, as `vesalius evaluate --report` writes it, becomes a column of bars with NAME above it.
"""
import csv
import pathlib
import sys

FEWEST = {"4": "#0072b2", "8": "#c04c00"}
LABELS, COLUMN, BAR, ROW, TOP = 110, 330, 240, 18, 52  # pixels


def shares(path, name):
    """Returns {fewest parts: {part: share}} of the set of that name."""
    found = {fewest: {} for fewest in FEWEST}
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            family, _, part = row["figure"].rpartition(".")
            fewest = family.removeprefix("part.right_of_")
            if row["set"] == name and family != fewest and fewest in found:
                found[fewest][part] = float(row["value"])
    if not all(found.values()):
        sys.exit(f"{path}: no part.right_of_* of set {name}, expected those of a set with labelled parts")
    return found


def text(x, y, words, more=""):
    return f'<text x="{x}" y="{y}" {more}>{words}</text>'


def bars(x, of_model):
    for fewest, colour in FEWEST.items():
        for row, (_, share) in enumerate(of_model[fewest].items()):
            y = TOP + ROW * row + (0 if fewest == "4" else 7)
            yield f'<rect x="{x}" y="{y}" width="{BAR * share:.1f}" height="6" fill="{colour}"/>'
            yield text(f"{x + BAR * share + 4:.1f}", y + 6, f"{100 * share:.0f}", f'font-size="8" fill="{colour}"')


def picture(models):
    parts = list(next(iter(models.values()))["4"])
    width, height = LABELS + COLUMN * len(models), TOP + ROW * len(parts) + 10
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
             f'<rect width="{width}" height="{height}" fill="#ffffff"/>']
    for row, part in enumerate(parts):
        lines.append(text(LABELS - 8, TOP + ROW * row + 10, part, 'text-anchor="end"'))
    for column, (name, of_model) in enumerate(models.items()):
        x = LABELS + COLUMN * column
        lines.append(text(x, 18, name, 'font-size="13"'))
        for at, (fewest, colour) in enumerate(FEWEST.items()):
            lines.append(text(x + 130 * at, 38, f"at least {fewest} parts, %", f'fill="{colour}"'))
        lines += bars(x, of_model)
    return "\n".join([*lines, "</svg>"]) + "\n"


def draw(out, name, tables):
    """Draws the set of that name of each of `tables`: {title: path of a figures.csv}."""
    pathlib.Path(out).write_text(picture({title: shares(path, name) for title, path in tables.items()}), encoding="utf-8")


def main():
    if len(sys.argv) < 4 or not all("=" in model for model in sys.argv[3:]):
        sys.exit(__doc__)
    draw(sys.argv[1], sys.argv[2], dict(model.split("=", 1) for model in sys.argv[3:]))


if __name__ == "__main__":
    main()
