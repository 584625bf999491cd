"""Mechanisms of other programs as joints, links, slots and inputs; solved by Newton's method on all loop equations at once, and written
as a .linkage2 file or as an address of PMKS+."""

import math
from dataclasses import dataclass

import numpy as np

FRAME = "frame"


@dataclass(frozen=True, kw_only=True)
class Model:
    """``at``: joint -> its position as drawn; links: name -> joints; anchors on the frame; slots: sliding joint -> (carrier, start, end,
    radius), radius > 0 with the centre left of start -> end; turning: joint -> (turn of its link [rad] over time [s], link, against);
    lengths: link of two joints -> its change over time; wheels: (first, second, carrier, ratio); level: (link, on) that do not turn."""

    at: dict
    links: dict
    anchors: tuple = ()
    slots: dict = None
    turning: dict = None
    lengths: dict = None
    wheels: tuple = ()
    level: tuple = ()

    def arc_centre(self, joint):
        _, start, end, radius = self.slots[joint]
        a, b = self.at[start], self.at[end]
        half = abs(b - a) / 2.0
        return (a + b) / 2.0 + 1j * math.copysign(math.sqrt(radius**2 - half**2), radius) * (b - a) / (2.0 * half)

    def solved(self, times):
        """Joint -> its positions (n,) at rising times from 0, each solved from the one before it."""
        self_rigid = [link for link in self.links if link not in (self.lengths or {})]
        count = 3 * len(self_rigid)
        columns = {link: 3 * i for i, link in enumerate(self_rigid)}

        def place(state, link, z):
            """Position of the point of a link that was drawn at z."""
            if link == FRAME:
                return z
            x, y, turn = state[columns[link] : columns[link] + 3]
            return z * np.exp(1j * turn) + complex(x, y)

        def turn(state, link):
            return 0.0 if link == FRAME else state[columns[link] + 2]

        on = {joint: [link for link in self_rigid if joint in self.links[link]] for joint in self.at}
        for joint in self.anchors:
            on[joint] = [FRAME, *on[joint]]

        def point(state, joint):
            return place(state, on[joint][0], self.at[joint])

        def open_by(state, time):
            """How far each loop is open."""
            gaps = []
            for joint, links in on.items():
                gaps += [point(state, joint) - place(state, link, self.at[joint]) for link in links[1:]]
            real = [part for gap in gaps for part in (gap.real, gap.imag)]
            for joint, (carrier, start, end, radius) in (self.slots or {}).items():
                here = point(state, joint)
                if radius:
                    real.append(abs(here - place(state, carrier, self.arc_centre(joint))) - abs(radius))
                else:
                    a, b = (place(state, carrier, self.at[each]) for each in (start, end))
                    real.append(((here - a) * np.conj(b - a)).imag / abs(b - a))
            for law, link, against in (self.turning or {}).values():
                real.append((turn(state, link) - turn(state, against) - law(time)) * 10.0)
            for link, law in (self.lengths or {}).items():
                one, two = self.links[link]
                drawn = abs(self.at[one] - self.at[two])
                real.append(abs(point(state, one) - point(state, two)) - drawn - law(time))
            for first, second, carrier, ratio in self.wheels:
                against = turn(state, carrier)
                real.append((turn(state, second) - against - ratio * (turn(state, first) - against)) * 10.0)
            real += [(turn(state, link) - turn(state, against)) * 10.0 for link, against in self.level]
            return np.array(real)

        state, rows = np.zeros(count), []
        for time in times:
            for _ in range(40):
                gap = open_by(state, time)
                if np.abs(gap).max() < 1e-11:
                    break
                step = 1e-6 * np.eye(count)
                slopes = np.array([(open_by(state + d, time) - open_by(state - d, time)) / 2e-6 for d in step])
                state = state - np.linalg.lstsq(slopes.T, gap, rcond=1e-10)[0]
            assert np.abs(gap).max() < 1e-9, (time, gap)
            rows.append([point(state, joint) for joint in self.at if on[joint]])
        return dict(zip((joint for joint in self.at if on[joint]), np.array(rows).T, strict=True))


def linkage2(model, flags=None, link_flags=None, program='units="Millimeters"', ratios="", ids=None):
    """The file: positions in 1/96 in; flags: joint -> its further attributes, link_flags: link -> its own; ids: link -> its id."""
    number = {joint: i for i, joint in enumerate(model.at)}
    lines = [f'<linkage2><program zoom="1" {program}/>']
    for joint, z in model.at.items():
        anchor = ' anchor="true"' * (joint in model.anchors)
        place = f'x="{float(z.real)!r}" y="{float(z.imag)!r}"'
        head = f'<connector id="{number[joint]}" layer="16" {place}{anchor} {(flags or {}).get(joint, "")}'
        if joint in (model.slots or {}):
            _, start, end, radius = model.slots[joint]
            arc = f' slideradius="{radius!r}"' if radius else ""
            limits = "".join(f'<slidelimit id="{number[each]}"/>' for each in (start, end))
            lines.append(f'{head} slider="true"{arc}>{limits}</connector>')
        else:
            lines.append(head + "/>")
    for i, (link, joints) in enumerate(model.links.items()):
        key = (ids or {}).get(link, i)
        inside = "".join(f'<connector id="{number[joint]}"/>' for joint in joints)
        lines.append(f'<Link id="{key}" layer="16" {(link_flags or {}).get(link, "")}>{inside}</Link>')
    return "\n".join([*lines, f"<ratios>{ratios}</ratios>", "</linkage2>"])


_LETTERS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"


def packed(value, scale=1000.0):
    """A number of an address."""
    whole, digits = round(abs(value) * scale), ""
    while whole:
        whole, digit = divmod(whole, 64)
        digits = _LETTERS[digit] + digits
    return ("0" if value < 0.0 else "") + (digits or "0")


def address(joints, links, rpm=10, clockwise=False):
    """An address with its checksum: joints (flags, id, position, angle, slot parts...), links (kind, id, joints)."""
    rows = [
        f"{_LETTERS[flags]}{key},{key},{packed(z.real)},{packed(z.imag)},{packed(angle)}"
        + "".join(f",{p}" for p in slot)
        for flags, key, z, angle, *slot in joints
    ]
    bars = [f"{kind}{key},{key},0,0,0,0,808080,{','.join(on)},," for kind, key, on in links]
    body = f"{'01' if clockwise else '00'}.Fe.{packed(rpm, 1.0)},0.101.{'.'.join(rows)}..{'.'.join(bars)}...N"
    return body + _LETTERS[len(body) % 62]


def triangle(x, stroke):
    """Out and back over a stroke at constant speed, at a way x from its beginning."""
    x = math.fmod(x, 2.0 * stroke)
    return x if x <= stroke else 2.0 * stroke - x
