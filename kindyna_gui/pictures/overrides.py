"""An exception that leaves a method which Qt calls.

Before Python 3.12 an exception that C code raises, ``{}["a"]`` inside of a handler as well as a widget that Qt has deleted, is an
exception only once somebody handles it; until then it is a class and a message. PySide takes that message for the exception, and the
process dies. So every method of ours and of pyqtgraph's in place of one of Qt's handles what it raises, and raises it again.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import cache, wraps
from types import FunctionType
from typing import Any

from PySide6.QtCore import QMetaMethod
from shiboken6 import Shiboken

_ROOT: Any = Shiboken.Object  # of every class of Qt


def let_errors_through() -> None:
    """Of all classes that there are, and of those to come."""
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

__all__ = ["let_errors_through"]
