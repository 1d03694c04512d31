"""What examples should say about frames, as c_reference knows it."""

import subprocess


def run(*command, **options):
    print("$", *command, flush=True)
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True, check=False, **options)
    if done.returncode != 0:
        raise SystemExit(f"{done.stdout}\nexit code {done.returncode}")
    return done.stdout


def expected_frames(reference, frames, folder):
    """[(arguments of an example after the model, what it should print)]."""
    found = []
    for line in run(reference, frames, folder).splitlines(keepends=True):
        if line.startswith("frame "):
            found.append((line.split()[1:], ""))
        else:
            found[-1] = (found[-1][0], found[-1][1] + line)
    if not any(text for _, text in found):
        raise SystemExit("expected people in the frames")
    return found


def expect_same(found, expected, what):
    if found != expected:
        raise SystemExit(f"{what} says:\n{found}\nexpected:\n{expected}")


def expect_example(command, model, frames, **options):
    """Runs an example on every frame."""
    for arguments, expected in frames:
        expect_same(run(*command, model, *arguments, **options), expected, command[-1])
