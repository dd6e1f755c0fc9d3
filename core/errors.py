"""What core says when input cannot be used: what was found, what was expected, what to do."""


class CoreError(Exception):
    """Input that cannot be used. The text is meant for the user."""


class ArrayShapeError(CoreError):
    """A record was given an array of the wrong shape or type."""

    def __init__(self, name: str, found: str, expected: str) -> None:
        self.name, self.found, self.expected = name, found, expected
        super().__init__(f"{name}: found {found}, expected {expected}")


class NoFaceError(CoreError):
    """No face was found where one is needed."""

    def __init__(self, where: str) -> None:
        self.where = where
        super().__init__(
            f"no face found in {where}; one face, at least 80 px wide, turned less than about "
            "75 degrees from the camera is needed: check the light and the distance"
        )
