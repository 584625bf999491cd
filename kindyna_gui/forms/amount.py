"""Numbers and choices of dialogs before something is written or shown, which no field of the design holds."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtWidgets import QComboBox, QDoubleSpinBox


class Amount(QDoubleSpinBox):
    """A number without trailing zeros, whose arrows step by a tenth of its size."""

    def __init__(self) -> None:
        super().__init__()
        self.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
        self.setGroupSeparatorShown(False)

    def textFromValue(self, value: float) -> str:
        text = f"{value:.{self.decimals()}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text


def fill_choices(box: QComboBox, rows: Mapping[str, str]) -> None:
    """Fill a list; what was chosen stays so where it is still there."""
    before = box.currentData()
    box.clear()
    for name, text in rows.items():
        box.addItem(text, name)
    box.setCurrentIndex(max(0, box.findData(before)))


__all__ = ["Amount", "fill_choices"]
