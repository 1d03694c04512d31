"""How people show themselves, as text and in a notebook."""

from __future__ import annotations

import base64
import html
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._vesalius import Event, Floor, People, Person

_STYLE = "text-align: left; padding: 2px 8px"
_MOST_WIDTH = 640  # pixels of a notebook


def _distance(person: Person) -> float:
    """Metres from the camera to the trunk, or to the middle of the parts of whom nobody follows; NaN where unknown."""
    if person.position is not None:
        return math.hypot(*person.position)
    parts = person.parts[[state == "observed" for state in person.part_states]]
    return math.hypot(*parts.mean(axis=0)) if len(parts) else math.nan


def _facts(person: Person, index: int | None = None) -> dict[str, str]:
    """What a table has of somebody, by its heads; an empty text where it is not known."""
    distance = _distance(person)
    observed = sum(state == "observed" for state in person.states())
    return {
        "person": str(person.id if person.id is not None else "" if index is None else index),
        "state": person.state,
        "stance": "" if person.stance == "unknown" else person.stance,
        "score": f"{person.score:.2f}",
        "distance": "" if math.isnan(distance) else f"{distance:.2f} m",
        "stature": "" if person.stature is None else f"{person.stature:.2f} m",
        "joints observed": f"{observed} of {len(person.states())}",
    }


def _words(facts: dict[str, str]) -> str:
    said = [facts["state"], facts["stance"], f"score {facts['score']}", facts["distance"] and f"{facts['distance']} away",
            f"{facts['joints observed']} joints observed"]
    return ", ".join(word for word in said if word)


def person_text(person: Person) -> str:
    facts = _facts(person)
    return f"<vesalius.Person {facts['person']}{': ' if facts['person'] else ''}{_words(facts)}>"


def people_text(people: People) -> str:
    facts = [_facts(person, index) for index, person in enumerate(people)]
    where = f" in frame {people.frame}" if people.frame else ""
    return "".join([f"<vesalius.People: {len(facts)}{where}", *(f"\n  {each['person']}: {_words(each)}" for each in facts), ">"])


def floor_text(floor: Floor) -> str:
    return (f"<vesalius.Floor {floor.height:.2f} m below the camera, tilt {math.degrees(floor.tilt):.1f} degrees, "
            f"roll {math.degrees(floor.roll):.1f} degrees>")


def event_text(event: Event) -> str:
    return f"<vesalius.Event: at {event.time:.2f} s person {event.id} {event.what}>"


def _row(cells: list[str], tag: str) -> str:
    return "<tr>" + "".join(f'<{tag} style="{_STYLE}">{html.escape(cell)}</{tag}>' for cell in cells) + "</tr>"


def people_html(people: People, jpeg: bytes) -> str:
    """A table with a row for each person, and the picture under it."""
    facts = [_facts(person, index) for index, person in enumerate(people)]
    heads = [head for head in (facts[0] if facts else {}) if any(each[head] for each in facts)]
    time = "" if people.time is None else f", {people.time:.2f} s"
    caption = html.escape(f"{len(facts)} {'person' if len(facts) == 1 else 'people'} in frame {people.frame}{time}")
    happened = [html.escape(f"{event.time:.2f} s: person {event.id} {event.what}") for event in people.events]
    rows = [_row(heads, "th"), *(_row([each[head] for head in heads], "td") for each in facts)] if facts else []
    picture = base64.b64encode(jpeg).decode("ascii")
    return "".join([
        f"<div><div>{'<br>'.join([caption, *happened])}</div>",
        f"<table>{''.join(rows)}</table>" if rows else "",
        f'<img alt="{caption}" style="max-width: min(100%, {_MOST_WIDTH}px)" src="data:image/jpeg;base64,{picture}"></div>',
    ])
