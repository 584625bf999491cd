"""The application object that Qt wants before anything is drawn, with or without a window."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from functools import cache, wraps
from types import FunctionType
from typing import Any

from PySide6.QtCore import QMetaMethod
from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import QApplication
from shiboken6 import Shiboken

from kindyna_gui.background import tidy_in_this_thread
from kindyna_gui.pictures.style import font

_ROOT: Any = Shiboken.Object  # of every class of Qt


def ensure_app(offscreen: bool = False) -> QApplication:
    """The one application; made now where there is none yet.

    offscreen: draw without any display, so that pictures are the same on every machine. Without a display on Linux
    this is so anyway.
    """
    existing = QApplication.instance()
    if isinstance(existing, QApplication):
        return existing
    displays = ("DISPLAY", "WAYLAND_DISPLAY")
    if offscreen or (sys.platform.startswith("linux") and not any(os.environ.get(name) for name in displays)):
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    app = QApplication([sys.argv[0] or "kindyna"])
    tidy_in_this_thread(app)
    let_errors_through()
    app.setFont(font())
    if not QFontDatabase.families():
        print("no fonts on this machine, texts are missing in pictures: install fonts-dejavu-core", file=sys.stderr)
    return app


# -- what handlers raise ------------------------------------------------------------------------------------


def let_errors_through() -> None:
    """Make all classes that there are, and those to come, hand on what their handlers raise.

    Before Python 3.12 an exception that C code raises, of a division by zero or a widget that Qt has deleted, is an
    exception only once somebody handles it; until then it is a class and a message. PySide takes that message for the exception, and the
    process dies. So every method of ours and of pyqtgraph's in place of one of Qt's handles what it raises, and raises it again.
    """
    if sys.version_info >= (3, 12) or "__init_subclass__" in vars(_ROOT):
        return
    _ROOT.__init_subclass__ = classmethod(_created)
    for cls in _below(_ROOT):
        _wrap(cls)


def _created(cls: type, /, **keywords: Any) -> None:
    super(_ROOT, cls).__init_subclass__(**keywords)
    _wrap(cls)


def _below(cls: Any) -> Iterator[type]:
    for each in cls.__subclasses__():
        yield each
        yield from _below(each)


def _wrap(cls: type) -> None:
    """Methods in place of one of Qt's, those of mixins too."""
    if _is_of_qt(cls):
        return
    called = frozenset[str]().union(*(_methods(each) for each in cls.__mro__ if _is_of_qt(each)))
    for each in cls.__mro__:
        if each is not object and not _is_of_qt(each):
            for name in called & vars(each).keys():
                method = vars(each)[name]
                if isinstance(method, FunctionType) and method.__code__ is not _CODE:
                    setattr(each, name, _raised_whole(method))


def _is_of_qt(cls: type) -> bool:
    return cls is _ROOT or cls.__module__.startswith("PySide6.")


@cache
def _methods(cls: Any) -> frozenset[str]:
    """Names of the methods of a class of Qt but its slots: how many values a signal hands on is read off what it is connected to."""
    meta = getattr(cls, "staticMetaObject", None)
    methods = () if meta is None else map(meta.method, range(meta.methodCount()))
    slots = {m.name().data().decode() for m in methods if m.methodType() == QMetaMethod.MethodType.Slot}
    return frozenset(name for name in vars(cls) if not name.startswith("__")) - slots


def _raised_whole(method: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(method)
    def called(*args: Any, **keywords: Any) -> Any:
        try:
            return method(*args, **keywords)
        except BaseException:
            raise

    return called


_CODE = _raised_whole(len).__code__  # of all that handle what they raise already
