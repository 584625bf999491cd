"""Results of a study: tables as arrays, extremes, findings, profile, points, explanations, files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from core.design import BALANCER
from core.errors import KindynaError
from core.mechanism.mechanism import body_name
from core.output.export import SHAFT_QUANTITIES, balancer_study
from core.study.certificate import certificate_of
from core.study.findings import findings_of
from core.study.study import Study as CoreStudy
from kindyna._checks import Array, brief, number, path_to_write, points, text, unknown, vector, whole
from kindyna._columns import Columns
from kindyna._options import names_arguments
from kindyna._results import Channel, Clearance, Explanation, Extreme, Finding, clearance, explanation, finding, frame

if TYPE_CHECKING:
    from kindyna._pictures import Picture

D = TypeVar("D")


class StudyResults(Generic[D]):
    """Results of a design of type ``D``, each computed when it is first read."""

    def __init__(self, design: D, columns: Columns) -> None:
        self._design, self._columns = design, columns

    @property
    def design(self) -> D:
        """The design."""
        return self._design

    @property
    def angle_deg(self) -> Array:
        """Angles (n,) [deg], the first column of its tables: of cam, driver or machine; of a swing, of its cycle."""
        return self._columns.angle_deg

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Name -> channel: every column over the turn that ``export`` writes. Raises KindynaError where there is no solution."""
        return MappingProxyType(self._columns.channels)

    def __getitem__(self, name: str) -> Array:
        return self._columns.values(name)

    def at(self, angles_deg: ArrayLike) -> Self:
        """Return the study of the same design at other angles.

        Parameters
        ----------
        angles_deg : ndarray (n,) [deg]
            Angles of cam, driver or machine; where a quantity jumps, its right-hand limit is taken.

        Returns
        -------
        Study

        Examples
        --------
        >>> import kindyna as kd
        >>> s = kd.example("transfer_lift").study().at([10.0, 20.0])
        >>> s["displacement_mm"].tolist()
        [150.0, 150.0]
        """
        return type(self)(self._design, self._columns.at(vector("angles_deg", angles_deg)))

    def extreme(self, name: str, of: str = "max") -> Extreme:
        """Return an extreme over the full turn, refined beyond the samples, as in ``summary.json``.

        Parameters
        ----------
        name : str
            A channel.
        of : str
            ``max``, ``min``, or ``abs``: the largest absolute value.

        Raises
        ------
        KeyError
            The design lacks the channel.
        KindynaError
            The channel is an angle that wraps, which has no extremes.

        Examples
        --------
        >>> import kindyna as kd
        >>> kd.example("transfer_lift").study().extreme("pressure_angle_deg")
        Extreme(value=17.60..., angle_deg=58.47..., unit='°')
        """
        return self._columns.extreme(name, of)

    def clearances(self, *pairs: tuple[str, str], tolerance_mm: float = 0.001) -> tuple[Clearance, ...]:
        """Return the least clearances of bodies with outlines over the full turn, proven, as the command ``clearance``.

        Parameters
        ----------
        *pairs : (str, str)
            Names of two bodies, as ``("link 3", "frame")``; every pair that does not touch by design where none is named.
        tolerance_mm : float
            Largest difference of a least distance and its proven bound.

        Raises
        ------
        KindynaError
            The design has no outlines, a body is unknown, or no two bodies have a common layer.

        Examples
        --------
        >>> import kindyna as kd
        >>> s = kd.example("transfer_unit_outlines").study()
        >>> [round(c.least_mm, 2) for c in s.clearances()]
        [40.76, 510.8, 313.05]
        >>> s.clearances(("clamp.follower", "lift.arm"))[0].angle_deg.__round__(1)
        86.0
        """
        from core.output.clearance import clearance_data  # few designs have outlines

        tolerance = number("tolerance_mm", tolerance_mm)
        if not 1e-6 <= tolerance <= 1e3:
            raise ValueError(f"tolerance_mm = {tolerance:g}: allowed: 1e-06 ... 1000")
        found = self._columns.full.clearances
        chosen = tuple(found.pair(pair) for pair in pairs) or found.require_pairs()
        return tuple(clearance(clearance_data(found.least(pair, 1e-3 * tolerance))) for pair in chosen)

    def to_dict(self, *names: str) -> dict[str, Array]:
        """Return channel -> values (n,), as Polars, matplotlib and scipy accept them.

        Parameters
        ----------
        *names : str
            Channels; all where none is named.

        Raises
        ------
        KeyError
            The design lacks a channel.

        Examples
        --------
        >>> import kindyna as kd
        >>> columns = kd.example("transfer_lift").study().to_dict("cam_angle_deg", "drive_torque_nm")
        >>> {name: values.shape for name, values in columns.items()}
        {'cam_angle_deg': (360,), 'drive_torque_nm': (360,)}
        """
        return {name: self[name] for name in names or self.channels}

    def to_frame(self, *names: str) -> Any:
        """Return a pandas DataFrame of channels; its index is the angle, named as its column.

        Parameters
        ----------
        *names : str
            Channels; all where none is named.

        Raises
        ------
        ImportError
            pandas is not installed; the extra ``frames`` installs it.
        KeyError
            The design lacks a channel.

        Examples
        --------
        >>> import kindyna as kd
        >>> frame = kd.example("transfer_lift").study().to_frame("drive_torque_nm")
        >>> frame.index.name, frame.shape
        ('cam_angle_deg', (360, 1))
        """
        index, columns = self._columns.angle, self.to_dict(*names)
        return frame({name: columns[name] for name in columns if name != index}, self.angle_deg, index)

    def profile(self, flank: str = "inner") -> Array:
        """Return the profile of the cam in its own frame.

        Parameters
        ----------
        flank : str
            ``inner``, ``outer`` of a groove, ``second`` of a conjugate pair.

        Returns
        -------
        ndarray (n, 2) [mm]

        Raises
        ------
        KeyError
            The cam has no such flank.
        KindynaError
            The design has no cam.

        Examples
        --------
        >>> import kindyna as kd
        >>> s = kd.example("groove").study()
        >>> s.profile().shape, s.profile("outer").shape
        ((360, 2), (360, 2))
        """
        flanks = {row.name: row for row in self._one_drive("profile").cam.flanks}
        if text("flank", flank) not in flanks:
            raise unknown("flank of this cam", flank, flanks)
        return points(flanks[flank].profile)

    def point(self, link: int | str, name: str) -> Array:
        """Return a point of a link in the global frame.

        Parameters
        ----------
        link : int or str
            Number of a link of a linkage, or the name of a body: ``arm``, ``rod``, ``slider``, ``follower``.
        name : str
            Name of the point.

        Returns
        -------
        ndarray (n, 2) [mm]

        Raises
        ------
        KeyError
            There is no such link, or it has no such point.

        Examples
        --------
        >>> import kindyna as kd
        >>> kd.example("four_bar").study().point(3, "C")[0].round(3).tolist()
        [28.289, 60.184]
        """
        bodies = self._one_drive("point").linkage.bodies
        body = link if isinstance(link, str) else body_name(whole("link", link))
        if body not in bodies:
            raise unknown("link of this design", link, bodies)
        pose = bodies[body]
        if text("name", name) not in pose.points:
            raise unknown(f"point of {body}", name, pose.points)
        return points(np.broadcast_to(pose.position(name), self.angle_deg.shape))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Limits that the design exceeds, errors first. Raises KindynaError where the mechanism has no solution."""
        return tuple(map(finding, findings_of(self._columns.solved)))

    @property
    def certificate(self) -> dict[str, tuple[float, float]]:
        """Name -> residual that is zero in exact arithmetic, and its bound."""
        return {
            name: (float(row.value), float(row.bound)) for name, row in certificate_of(self._columns.solved).items()
        }

    @property
    def drives(self) -> dict[str, Self]:
        """Name -> study of the drive by its own angle, over the full turn; the balance cam is ``balancer``."""
        full = self._columns.full
        studies = dict(full.drives)
        if (balancer := balancer_study(full)) is not None:
            studies[BALANCER] = balancer
        without = SHAFT_QUANTITIES if full.design.listed else frozenset[str]()
        return {name: type(self)(self._design, Columns(study, None, without)) for name, study in studies.items()}

    @names_arguments
    def explain(self, name: str, at_deg: float | None = None) -> Explanation:
        """Return where a number comes from: its equation, and the value and origin of every symbol.

        Parameters
        ----------
        name : str
            A channel, or a figure of ``summary.json`` such as ``needed_inertia_kg_m2``.
        at_deg : float, optional
            Angle; by default that of the largest absolute value.

        Raises
        ------
        KindynaError
            The design lacks the quantity, or it has no value at this angle.

        Examples
        --------
        >>> import kindyna as kd
        >>> e = kd.example("four_bar").study().explain("transmission_B_deg", at_deg=40)
        >>> str(e).splitlines()[0], e.source
        ('Transmission angle at B at 40°: 57.8965400 °', 'angle between the links at the joint')
        """
        from core.output.explain import explained

        at = None if at_deg is None else number("at_deg", at_deg)
        return explanation(explained(self._columns.solved, self._columns.quantity_of(text("name", name)), at))

    def plot(self, *names: str) -> Picture:
        """Return channels over the angle, one plot for each unit, with segments of the motion and marked extremes.

        Parameters
        ----------
        *names : str
            Channels; where none is named, those that say most about the design.

        Raises
        ------
        KeyError
            The design lacks a channel.

        Examples
        --------
        >>> import kindyna as kd
        >>> s = kd.example("rocker_cam").study()
        >>> s.plot("displacement_deg", "drive_torque_nm")
        <kindyna.Picture ... characters of SVG>
        """
        from kindyna._pictures import plot  # no reader of numbers needs pictures

        return plot(self._columns, names)

    def picture(self, at_deg: float = 0.0) -> Picture:
        """Return the mechanism drawn to scale; of several drives all of them.

        Parameters
        ----------
        at_deg : float
            Angle of cam, driver or machine.

        Raises
        ------
        KindynaError
            The mechanism cannot be assembled at this angle.

        Examples
        --------
        >>> import kindyna as kd
        >>> kd.example("four_bar").study().picture(at_deg=40).save("four_bar.svg")
        """
        from kindyna._pictures import machine

        return machine(self._columns, number("at_deg", at_deg))

    @names_arguments
    def export(self, target: str | os.PathLike[str], **options: Any) -> list[Path]:
        """Write files, completely or not at all.

        Parameters
        ----------
        target : str or path
            A folder: tables and summary, as the command ``export``. A name with the ending ``.dxf``, ``.svg``, ``.csv`` or ``.nc``: the
            profile of the cam, as ``profile``. ``.step`` or ``.stl``: its flanks or its solid, as ``surface``.
            ``.html`` or ``.pdf``: a report, as ``report``; a PDF needs the packages of the window.
        **options : number, text, flag or list
            Options of that command, with ``_`` for ``-``, and ``as_``: of ``export`` ``only``; of ``profile`` ``flank``, ``drive``,
            ``samples``, ``spacing``, ``tolerance``, ``as_``, ``cutter``, and those of G-code; of ``surface`` ``solid``, ``flank``,
            ``drive``, ``tolerance``; of ``report`` ``without``, ``paper``, ``customer``, ``author``, ``revision`` and others.

        Returns
        -------
        list of Path

        Raises
        ------
        KeyError
            There is no such option.
        TypeError, ValueError
            An option has a wrong value.
        KindynaError
            There is no such format, the design lacks what it needs, or the file cannot be written.

        Examples
        --------
        >>> import kindyna as kd
        >>> s = kd.example("rocker_cam").study()
        >>> [path.name for path in s.export("cam.dxf", tolerance=0.002, as_="arcs")]
        ['cam.dxf', 'cam.dxf.json']
        >>> [path.name for path in s.export("tables", only=["motion"])]
        ['kinematics.csv', 'summary.json']
        """
        from kindyna._files import export_study  # no reader of results needs the formats of files

        columns = self._columns
        return export_study(columns.full, path_to_write("target", target), options, columns.without)

    @names_arguments
    def ecam(self, controller: str, out: str | os.PathLike[str] | None = None, **options: Any) -> dict[str, Any]:
        """Compute a table for a servo controller, and the error of the curve that the controller makes of it.

        Parameters
        ----------
        controller : str
            Name in the table of controllers, as ``sew-tab``.
        out : str or path, optional
            File to write the table to.
        **options : number, text, flag or list
            Options of the command ``ecam``, with ``_`` for ``-``, and ``as_``: ``points``, ``error``, ``of``, ``drive``
            and others.

        Returns
        -------
        dict
            As ``ecam --json``: rows, whether the error is certified, the largest errors with their angles.

        Raises
        ------
        KeyError
            There is no such option.
        TypeError, ValueError
            An option has a wrong value.
        KindynaError
            There is no such controller or table, or the file cannot be written.

        Examples
        --------
        >>> import kindyna as kd
        >>> table = kd.example("rocker_cam").study().ecam("sew-tab", out="sew.txt", error=0.002)
        >>> table["rows"], table["certified"], table["deviation_deg"] < 0.002
        (125, True, True)
        """
        from kindyna._files import ecam_table  # no reader of results needs the formats of files

        path = None if out is None else path_to_write("out", out)
        return ecam_table(self._columns.full, text("controller", controller), path, options)

    @names_arguments
    def valves(self, at_mm: ArrayLike | None = None) -> dict[str, Any]:
        """Compute the figures of the valves of an engine: events over the crank, lifts, springs, clearance, and overlap.

        Parameters
        ----------
        at_mm : ndarray (n,) [mm], optional
            Lifts of the events; by default those of a cam card: 0.1524, 1.27 and 1 mm.

        Returns
        -------
        dict
            As ``valve --json``: ``valves``, and ``pairs`` of inlet and exhaust.

        Raises
        ------
        ValueError
            A lift is not positive.
        KindynaError
            No drive moves a valve, or a train does not open it.

        Examples
        --------
        >>> import kindyna as kd
        >>> figures = kd.example("valve_train").study().valves([1.27])
        >>> figures["pairs"][0]["separation_deg"]
        109.0
        >>> round(figures["valves"][0]["clearance"]["least_mm"], 3)
        4.857
        """
        from core.valves import LIFTS, require_opening, valve_data, valve_timings  # few designs have valves

        lifts = LIFTS if at_mm is None else tuple(vector("at_mm", at_mm).tolist())
        if min(lifts) <= 0.0:
            raise ValueError(f"at_mm = {min(lifts):g}: a lift above 0 is needed")
        timings = valve_timings(self._columns.full.design)
        require_opening(timings)
        return valve_data(timings, lifts)

    def _repr_html_(self) -> str:
        from kindyna._html import study_html  # only notebooks need it

        return study_html(self._columns, self._kind)

    @property
    def _kind(self) -> str:
        full = self._columns.full.design
        return "shaft" if full.listed else full.drive.kind

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.channels)

    def __repr__(self) -> str:
        return brief(f"<kindyna.Study {self.angle_deg.size} angles of {self._columns.full.design.name!r}>")

    def _one_drive(self, what: str) -> CoreStudy:
        full = self._columns.full
        if full.design.listed:
            raise KindynaError(f"{what}: of one drive; choose it with drives[NAME]: {', '.join(full.drives)}")
        return self._columns.core
