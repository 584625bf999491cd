"""The command ``stability``: chart and forbidden speeds of a flexible camshaft."""

from core.charting import stability_command as run
from core.charting import stability_words as words

__all__ = ["run", "words"]
