"""What cannot be used."""


class InputError(Exception):
    """Says in one line which file cannot be used, the place in it, and what was expected."""
