"""All outputs of one track: none of them appears before the track is complete."""

from types import TracebackType
from typing import Self

from app.errors import AppError
from app.recording.sink import Sink, reason
from core.records import FaceState, Frame


class DiskError(AppError):
    """The disk took no more while a track was being written."""

    def __init__(self, why: str) -> None:
        super().__init__(
            f"cannot go on writing the track: {why}; what was there before is unchanged. Make "
            "room, or choose another place"
        )


class Outputs:
    """Hands every frame to several sinks; completes all on success, discards all on an error."""

    def __init__(self) -> None:
        self._sinks: list[Sink] = []

    def add(self, sink: Sink) -> None:
        """Take over a sink."""
        self._sinks.append(sink)

    def write(self, frame: Frame, state: FaceState) -> None:
        """Take the next frame.

        Raises:
            DiskError: A sink could not write it.
        """
        try:
            for sink in self._sinks:
                sink.write(frame, state)
        except OSError as error:
            raise DiskError(reason(error)) from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        left = list(self._sinks)
        try:
            while left and error is None:
                left[0].finish()
                left.pop(0)
        except OSError as failed:
            raise DiskError(reason(failed)) from None
        finally:
            for sink in left:
                sink.discard()
