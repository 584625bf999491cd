"""Kinds of followers, one row each: the classes of their tables in the file, and the unit of their motion."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.design.fields import (
    words_of,
)
from core.design.followers import (
    FACE,
    FORM,
    Flat,
    Rolling,
)
from core.design.parts import (
    Cam,
    CamSlider,
    CamSliderLoads,
    DiskCam,
    Follower,
    Loads,
    Oscillating,
    OscillatingFlat,
    OscillatingFlatLoads,
    OscillatingLoads,
    Pushrod,
    PushrodLoads,
    Rocker,
    RockerLoads,
    RollerCam,
    Translating,
    TranslatingLoads,
)
from core.design.spatial import SPATIAL_CAMS
from core.frozen import frozen

# -- kinds of followers ------------------------------------------------------------------------------------


@frozen
class FollowerKind:
    """Kind of follower: the classes of its tables in the file, and the unit of its motion.

    ``flat`` lists the classes of follower and loads with a flat face, where they differ.
    """

    label: str
    follower: type[Follower]
    loads: type[Loads]
    motion_unit: str
    flat: tuple[type[Follower], type[Loads]] | None = None

    @property
    def faces(self) -> Mapping[str, type]:
        """Word of the file -> class of the faces that it can have."""
        return words_of(self.follower, FACE)

    @property
    def forms(self) -> Mapping[str, type]:
        """Word of the file -> class of the forms that its cam can have with a roller."""
        return words_of(self.under(Rolling.face)[1], FORM)

    @property
    def followers(self) -> tuple[type[Follower], ...]:
        """Classes of its table ``[follower]``."""
        return (self.follower, *(self.flat or ())[:1])

    def under(self, face: str) -> tuple[type[Follower], type[Cam], type[Loads]]:
        """Classes of follower, cam and loads with a face."""
        follower, loads = self.flat if self.flat and face == Flat.face else (self.follower, self.loads)
        return follower, RollerCam if face == Rolling.face else DiskCam, loads


FOLLOWER_KINDS: Mapping[str, FollowerKind] = MappingProxyType(
    {
        "cam-slider": FollowerKind("Cam-driven slider", CamSlider, CamSliderLoads, "mm"),
        "translating": FollowerKind("Translating follower", Translating, TranslatingLoads, "mm"),
        "oscillating": FollowerKind(
            "Oscillating follower", Oscillating, OscillatingLoads, "deg", (OscillatingFlat, OscillatingFlatLoads)
        ),
        "rocker": FollowerKind("Valve rocker", Rocker, RockerLoads, "mm"),
        "pushrod": FollowerKind("Pushrod train", Pushrod, PushrodLoads, "mm"),
    }
)


KIND_LABELS: Mapping[str, str] = MappingProxyType(
    {kind: row.label for kind, row in FOLLOWER_KINDS.items()} | {kind: row.label for kind, row in SPATIAL_CAMS.items()}
)
"""Kind of a drive with a cam and without links -> its label: followers, then cams in space."""


def kind_of(follower: Follower) -> str:
    """Slug of a follower's kind."""
    return next(slug for slug, row in FOLLOWER_KINDS.items() if type(follower) in row.followers)
