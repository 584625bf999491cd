"""The files of a graph: read beside the window, watched, and kept as they were last read where they change or vanish."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PySide6.QtCore import QFileSystemWatcher, QObject, QTimer, Signal

from core.errors import KindynaError
from core.numerics.lazy import Cancelled
from core.output.graph import DesignSource, Source, read_source
from kindyna_gui.background import Background

PAUSE_MS, PROGRESS_MS = 100, 100
Stamp = tuple[int, int, int] | None
READING, CANCELLED = "is being read", "reading was cancelled; Files > Read files again reads it"


def _stamp(path: str) -> Stamp:
    """By which a file is seen to be another; None where there is none."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


@dataclass
class _File:
    """source: as last read, None where it never was; fault: why it could not be, now; note: why it may be out of date."""

    source: Source | None = None
    fault: str = READING
    note: str = ""
    stamp: Stamp = None
    wanted: bool = True  # is to be read


class GraphSources(QObject):
    """What the rows of a graph name, by the path of its file.

    changed    a source has come, changed, or vanished
    progress   (what is being read, 0 ... 1); an empty text: nothing is
    """

    changed = Signal()
    progress = Signal(str, float)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.design: DesignSource | None = None
        self._files: dict[str, _File] = {}
        self._done: dict[str, float] = {}
        self._work = Background(self, 20)
        self._work.result.connect(self._take)
        self._system = QFileSystemWatcher(self)
        self._soon = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._soon.timeout.connect(self.compare)
        self._system.fileChanged.connect(lambda _: self._soon.start())
        self._system.directoryChanged.connect(lambda _: self._soon.start())
        self._ticking = QTimer(self, interval=PROGRESS_MS)
        self._ticking.timeout.connect(self._tell)

    # -- what there is --------------------------------------------------------------------------------------

    def __call__(self, name: str) -> Source:
        """The source of a row. Raises KindynaError where it is not there, or not yet."""
        if not name:
            if self.design is None:
                raise KindynaError("there is no design")
            return self.design
        file = self._files.get(name)
        if file is None or file.source is None:
            raise KindynaError(f"{Path(name).name}: {file.fault if file else READING}")
        return file.source

    def note(self, name: str) -> str:
        """Why what is shown of a file may be out of date; empty where it is not."""
        file = self._files.get(name)
        return f"{Path(name).name} {file.note}" if file is not None and file.note else ""

    @property
    def names(self) -> tuple[str, ...]:
        """The files, in the order in which they came."""
        return tuple(self._files)

    @property
    def reading(self) -> bool:
        """Whether there are files whose numbers are still to come."""
        return self._work.busy

    @property
    def busy(self) -> bool:
        return self.reading or self._soon.isActive()

    # -- reading --------------------------------------------------------------------------------------------

    def want(self, names: Iterable[str]) -> None:
        """These files and no others: what is new is read."""
        wanted = [name for name in dict.fromkeys(names) if name]
        new = [name for name in wanted if name not in self._files]
        if set(self._files) == set(wanted):
            return
        self._files = {name: self._files.get(name) or _File() for name in wanted}
        self._watch()
        if new:
            self._read()

    def read_again(self) -> None:
        """All files, also those that could not be read, or whose reading was cancelled."""
        for file in self._files.values():
            file.wanted = True
        self._read()

    def _read(self) -> None:
        open_ones = [name for name, file in self._files.items() if file.wanted]
        if not open_ones:
            return
        self._done = dict.fromkeys(open_ones, 0.0)
        for name in open_ones:
            self._files[name].stamp = _stamp(name)
        self._work.start([(name, partial(self._job, self._done, name)) for name in open_ones])
        self._ticking.start()

    @staticmethod
    def _job(done: dict[str, float], name: str) -> Source:
        return read_source(Path(name), partial(done.__setitem__, name))

    def cancel(self) -> None:
        """Read no further; the rows of what was not read say so."""
        self._work.cancel()

    def _take(self, name: str, result: object) -> None:
        self._done.pop(name, None)
        stopped = isinstance(result, Cancelled)
        for each in [key for key, file in self._files.items() if file.wanted] if stopped else [name]:
            if each in self._files:
                self._keep(self._files[each], result)
        if stopped or not self._done:
            self._ticking.stop()
            self.progress.emit("", 0.0)
        self.changed.emit()

    @staticmethod
    def _keep(file: _File, result: object) -> None:
        file.wanted = False
        if isinstance(result, Cancelled | KindynaError):
            file.fault = (
                CANCELLED
                if isinstance(result, Cancelled)
                else str(result).split("\n")[0].partition(": ")[2] or str(result)
            )
            if file.source is not None:
                file.note = f"has changed and cannot be read ({file.fault}); shown as it was read last"
        else:
            file.source, file.fault, file.note = result, "", ""  # type: ignore[assignment]

    def _tell(self) -> None:
        if self._done:
            name = next(iter(self._done))
            self.progress.emit(Path(name).name, self._done[name])

    # -- watching -------------------------------------------------------------------------------------------

    def compare(self) -> None:
        """Look at all files now: what has changed is read again, what has vanished is kept as it was."""
        self._soon.stop()
        self._watch()
        changed = False
        for name, file in self._files.items():
            stamp = _stamp(name)
            if stamp == file.stamp:
                continue
            changed = True
            file.stamp = stamp
            if stamp is None:
                file.note = "has vanished; shown as it was read last" if file.source is not None else ""
            else:
                file.wanted = True
        if any(file.wanted for file in self._files.values()):
            self._read()
        if changed:
            self.changed.emit()

    def _watch(self) -> None:
        wanted = {str(each) for name in self._files for each in (Path(name), Path(name).parent) if each.exists()}
        watched = {*self._system.files(), *self._system.directories()}
        if watched - wanted:
            self._system.removePaths(sorted(watched - wanted))
        if wanted - watched:
            self._system.addPaths(sorted(wanted - watched))

    def close(self) -> None:
        """Nothing is read any longer."""
        self._ticking.stop()
        self._work.close()


__all__ = ["GraphSources"]
