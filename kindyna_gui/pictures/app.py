"""The application object that Qt needs before it draws, with or without a window."""

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

_ROOT: Any = Shiboken.Object  # base of all classes of Qt


def ensure_app(offscreen: bool = False) -> QApplication:
    """Return the application, and create it first where there is none.

    Parameters
    ----------
    offscreen : bool
        Draw without a display, so that images are the same on every machine. Linux without a display always does.
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
        print("No fonts are installed, so images have no texts: install fonts-dejavu-core", file=sys.stderr)
    return app


# -- exceptions in overridden methods -----------------------------------------------------------------------


def let_errors_through() -> None:
    """Make overridden methods of Qt's classes raise exceptions that PySide can handle.

    Before Python 3.12 an exception raised by C code, such as a division by zero, consists of a class and a message
    until Python code handles it. PySide mistakes the message for the exception, and the process crashes. Therefore
    each method that overrides one of Qt's, in present and future classes, catches its exceptions and raises them again.
    """
    if sys.version_info >= (3, 12) or "__init_subclass__" in vars(_ROOT):
        return
    _ROOT.__init_subclass__ = classmethod(_init_subclass)
    for cls in _subclasses(_ROOT):
        _wrap(cls)


def _init_subclass(cls: type, /, **keywords: Any) -> None:
    super(_ROOT, cls).__init_subclass__(**keywords)
    _wrap(cls)


def _subclasses(cls: Any) -> Iterator[type]:
    for subclass in cls.__subclasses__():
        yield subclass
        yield from _subclasses(subclass)


def _wrap(cls: type) -> None:
    """Wrap the methods that override one of Qt's, those of mixins too."""
    if _is_qt_class(cls):
        return
    overridable = frozenset[str]().union(*(_methods(base) for base in cls.__mro__ if _is_qt_class(base)))
    for base in cls.__mro__:
        if base is not object and not _is_qt_class(base):
            for name in overridable & vars(base).keys():
                method = vars(base)[name]
                if isinstance(method, FunctionType) and method.__code__ is not _CODE:
                    setattr(base, name, _raising_again(method))


def _is_qt_class(cls: type) -> bool:
    return cls is _ROOT or cls.__module__.startswith("PySide6.")


@cache
def _methods(cls: Any) -> frozenset[str]:
    """Names of the methods of a class of Qt without its slots, whose signature tells how many values a signal passes."""
    meta = getattr(cls, "staticMetaObject", None)
    methods = () if meta is None else map(meta.method, range(meta.methodCount()))
    slots = {m.name().data().decode() for m in methods if m.methodType() == QMetaMethod.MethodType.Slot}
    return frozenset(name for name in vars(cls) if not name.startswith("__")) - slots


def _raising_again(method: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(method)
    def called(*args: Any, **keywords: Any) -> Any:
        try:
            return method(*args, **keywords)
        except BaseException:
            raise

    return called


_CODE = _raising_again(len).__code__  # of all methods that are wrapped already
