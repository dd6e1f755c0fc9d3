"""An entry of a list to choose from."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Choice:
    """One entry: what the program calls it and what people read.

    Attributes:
        key: For the program.
        text: For people, short.
        details: For people who point at it, or empty.
        picture: Path of a small picture of it, or empty.
    """

    key: str
    text: str
    details: str = ""
    picture: str = ""
