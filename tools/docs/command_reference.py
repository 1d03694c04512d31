"""The reference of commands: what `vesalius --help` and the help of each command say."""

import re
import subprocess


def write(program, staged):
    def told(*words):
        return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout.strip()

    overview = told()
    names = re.findall(r"^  ([a-z0-9]+) {2,}", overview.split("Subcommands:")[1], re.MULTILINE)
    text = "# Commands\n\nWhat `vesalius --help` says, and `vesalius COMMAND --help` of each command.\n\n```text\n" + overview + "\n```\n"
    for name in names:
        text += f"\n## vesalius {name}\n\n```text\n{told(name)}\n```\n"
    page = staged / "reference/commands.md"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(text)
