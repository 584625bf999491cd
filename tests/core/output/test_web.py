"""The web page of a design: what it holds against the study, that it asks nobody for anything, and how a browser shows it."""

import json
import math
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import LIFT
from sampled import stressed

from core.output.handover import web_page
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
MM = 1e3


class Page(HTMLParser):
    """What stands in a page: its data, its groups that move, every address that it names."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.data: dict[str, Any] = {}
        self.groups: dict[str, str] = {}
        self.addresses: list[str] = []
        self.policy = ""
        self.tags: set[str] = set()
        self._in_data = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.tags.add(tag)
        self._in_data = tag == "script" and given.get("id") == "data"
        self.addresses += [given[name] or "" for name in ("src", "href", "action", "data", "srcset") if name in given]
        if tag == "meta" and given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"] or ""
        if tag == "g" and "data-body" in given:
            self.groups[given["data-body"] or ""] = given.get("transform") or ""

    def handle_data(self, data: str) -> None:
        if self._in_data:
            self.data = json.loads(data)
            self._in_data = False


def places(study: Study) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Body -> where its origin is [mm], how far it is turned [deg]."""
    bodies = {name: (pose.origin[0] * MM, np.rad2deg(pose.turn[0])) for name, pose in study.linkage.bodies.items()}
    if "cam" in study.stages:
        bodies["cam"] = (np.zeros(study.theta.size), study.sense * np.rad2deg(study.theta))
    return bodies


@pytest.mark.parametrize(
    "name",
    [
        "transfer_lift",
        stressed("tappet_flat"),
        stressed("conjugate"),
        stressed("lecture_six_bar"),
        stressed("four_bar_coupler_cam"),
    ],
)
def test_the_page_holds_the_places_and_curves_of_the_study(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    study, text = Study(design, 720), web_page(Study(design))
    page = Page(text)
    (machine,) = page.data["machines"]
    for body in machine["bodies"]:
        origin, turn = places(study)[body["name"]]
        assert np.allclose(np.array(body["x"]) + 1j * np.array(body["y"]), origin, rtol=0.0, atol=1e-9)
        assert np.allclose(body["turn"], turn, rtol=0.0, atol=1e-9)
    if "cam" in study.stages:
        for drawn, flank in zip(machine["cam"]["flanks"], study.cam.flanks, strict=True):
            assert np.allclose(np.array(drawn) @ [1, 1j], flank.profile * MM, rtol=0.0, atol=1e-9)
    shown = {curve["slug"]: np.array(curve["values"]) for curve in machine["curves"]}
    wanted = "drive_torque_nm" if "cam" in study.stages else "driver_torque_nm"
    torque = study.dynamics.torque if "cam" in study.stages else study.dynamics.driver
    assert np.allclose(shown[wanted], torque, rtol=1e-6, atol=1e-9 * np.abs(torque).max())
    assert len(text.encode()) <= 1_500_000


def test_the_page_opens_with_curves_that_say_something() -> None:
    """Of a crank without loads the torque is 0 throughout: angular velocities and transmission angles stand there instead."""
    text = web_page(Study(load(EXAMPLES / "four_bar.toml")))
    (machine,) = Page(text).data["machines"]
    shown = [curve for curve in machine["curves"] if curve["shown"]]
    assert {"link3_rad_s", "link4_rad_s"} <= {curve["slug"] for curve in shown}
    assert all(len(set(curve["values"])) > 10 for curve in shown)
    assert "At a glance" not in text, "no heading without anything below"


@pytest.mark.parametrize(
    ("name", "size", "at", "radius"),
    [("barrel_feeder", (110.0, 164.0), 0.0, 82.0), stressed("globoidal_indexer", (192.7, 114.3), 56.0, 98.35)],
)
def test_a_cam_in_space_has_its_side_view_its_end_view_and_rollers_that_move_with_the_output(
    name: str, size: tuple[float, float], at: float, radius: float
) -> None:
    """Sizes of the blank [mm]; the roller of a turret is 56 mm from its pivot, that of a slide below it."""
    study = Study(load(EXAMPLES / f"{name}.toml"))
    text = web_page(study)
    (machine,) = Page(text).data["machines"]
    space = machine["space"]
    outline = np.array(space["poses"][0][0]) @ [1, 1j]
    assert np.ptp(outline.real) == pytest.approx(size[0], abs=5.0)
    assert np.ptp(outline.imag) == pytest.approx(size[1], abs=0.1)
    assert space["radii"][0] == pytest.approx(radius, abs=0.1)
    assert len(space["poses"]) == 120
    output = next(body for body in machine["bodies"] if body["rollers"])
    rollers = [np.array(corners) @ [1, 1j] for corners in output["rollers"]]
    assert len(rollers) == study.design.drive.cam.rollers
    middle = 0.5 * (rollers[0].max() + rollers[0].min()) if at == 0.0 else rollers[0].mean()
    assert middle.real == pytest.approx(at, abs=0.5)
    assert len(text.encode()) <= 1_500_000
    assert text == web_page(study)


@pytest.mark.stress
def test_drives_of_a_shaft_stand_side_by_side_each_with_its_phase() -> None:
    design = load(EXAMPLES / "transfer_unit.toml")
    data = Page(web_page(Study(design))).data
    assert [(each["name"], each["phase"]) for each in data["machines"]] == [
        (d.name, d.phase_deg) for d in design.drives
    ]
    assert data["angle"] == "machine angle"


def test_the_page_asks_nobody_for_anything_and_names_stay_text() -> None:
    study = Study(replace(LIFT, name="</script><b>lift</b> & <img src=x>"))
    text = web_page(study)
    page = Page(text)
    assert page.addresses == []
    assert not {"img", "b", "link", "iframe"} & page.tags
    assert "default-src 'none'" in page.policy
    assert "unsafe-inline" not in page.policy.partition("script-src")[2].partition(";")[0]
    assert page.data["name"] == "</script><b>lift</b> & <img src=x>"
    outside = re.findall(r"https?://[^\s\"'<]+", text)
    assert {address for address in outside if "www.w3.org" not in address} == set()
    assert text == web_page(study)


def test_its_program_is_small() -> None:
    assert (EXAMPLES.parent / "web_page.js").stat().st_size <= 25_000


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here; make test-web installs it")
@pytest.mark.parametrize(("name", "angle"), [("transfer_lift", 62.5), ("lecture_six_bar", 200.0), ("rocker_shoe", 0.0)])
def test_a_browser_shows_each_body_where_the_study_has_it(name: str, angle: float, tmp_path: Path) -> None:
    """Opened at an angle of the turn, by what a browser makes of the page."""
    assert BROWSER is not None
    design = load(EXAMPLES / f"{name}.toml")
    (tmp_path / "page.html").write_text(web_page(Study(design)), "utf-8")
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}"]
    address = f"{(tmp_path / 'page.html').as_uri()}#{angle}"
    done = subprocess.run(
        [*command, "--dump-dom", address], capture_output=True, text=True, timeout=120, check=True, encoding="utf-8"
    )
    shown = Page(done.stdout)
    study = Study(design, 720)
    index = round(angle * 2)
    for body, (origin, turn) in places(study).items():
        if body == "frame":
            continue
        x, y, turned = map(float, re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", shown.groups[body]))
        assert math.hypot(x - origin[index].real, y - origin[index].imag) <= 1e-9
        assert turned == pytest.approx(turn[index], abs=1e-9)
    assert re.search(rf"angle {angle:.1f}°", done.stdout)
