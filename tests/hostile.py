"""Hostile files for every reader: seeds of a generator, each read in a process of its own with little time and memory.

``python tests/hostile.py`` takes lines of JSON, ``["measured", 17]`` or ``["measured", "FILE"]``, and prints a line for each: what
became of that number of the generator, or of that file.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import traceback
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from math import cos, log, radians
from pathlib import Path
from random import Random
from typing import Any

EXAMPLES = Path(__file__).resolve().parents[1] / "resources" / "examples"
LIFT = EXAMPLES / "transfer_lift.toml"
SIZE = 1_000_000  # bytes of a file
CPU_S, MEMORY = 10, 700 << 20
CRASHED = 70  # exit code of a command that raised

Read = Callable[[Path, Path], int]
"""Reads a file; the second folder is for what it writes. The exit code."""

NUMBERS = (
    "nan", "inf", "-inf", "1e999", "-1e-999", "1e400", "0x7f", "1_000", "--1", "1e", "٣", "½", "1,5", "1e9999999999", "true", "", "-0",
    "1e308",
    "4294967296", "9223372036854775808", "2147483648",
)  # fmt: skip
WORDS = (
    "\0",
    "\ufeff",
    "\u2028",
    "\x85",
    "\x1b[31m",
    "é",
    "각도",
    "😀",
    "\x0c",
    "%s",
    "{0}",
    "..",
    "/",
    "\\",
    "'",
    '"',
    '"""',
    "#",
    "[",
    "(",
)


@dataclass(frozen=True)
class Reader:
    """How a reader's files begin to be hostile: good ones, pieces of its grammar, and what is run on a file."""

    run: Read
    good: Callable[[], Sequence[str]] = lambda: ("",)
    pieces: Sequence[str] = ()
    name: str = "file.txt"
    data: Callable[[Random], bytes] | None = field(default=None)  # instead of a text


def _count(rng: Random, most: int) -> int:
    """1 ... most, small numbers as often as large ones, and the largest often."""
    return most if rng.random() < 0.3 else max(1, round(2.0 ** (rng.random() * log(max(most, 2), 2))))


def hostile(reader: Reader, rng: Random) -> bytes:
    """A file that is wrong, or only strange, or neither."""
    if reader.data is not None:
        return reader.data(rng)
    text = rng.choice(reader.good())
    for _ in range(rng.choice((1, 1, 1, 1, 2, 3))):
        text = rng.choice(_CHANGES)(text, reader.pieces, rng)[:SIZE]
    data = text.encode(rng.choice(("utf-8",) * 30 + ("utf-16", "utf-8-sig", "cp949")), "replace")[:SIZE]
    if rng.random() < 0.15 and data:
        at = rng.randrange(len(data))
        data = data[:at] + rng.randbytes(rng.choice((1, 4, 100))) + data[at + rng.choice((0, 1, 100)) :]
    return data


def _piece(pieces: Sequence[str], rng: Random) -> str:
    piece = "".join(rng.choice((*pieces, rng.choice(WORDS))) for _ in range(rng.choice((1, 1, 1, 2, 3))))
    return piece * _count(rng, SIZE // max(len(piece), 1))


def _repeated(text: str, pieces: Sequence[str], rng: Random) -> str:
    at = rng.choice((0, 0, len(text), rng.randrange(len(text) + 1)))
    return text[:at] + _piece(pieces, rng) + rng.choice((text[at:], "", "x"))


def _number(text: str, pieces: Sequence[str], rng: Random) -> str:
    spots = [match.span() for match in re.finditer(r"-?\d[\d.e]*", text[:100_000])]
    if not spots:
        return text
    begin, end = rng.choice(spots)
    digit = rng.choice("0159")
    value = rng.choice(
        (*NUMBERS, digit * _count(rng, SIZE), f"0.{digit * _count(rng, SIZE)}", f"1{'_1' * _count(rng, 99_999)}")
    )
    return text[:begin] + value + text[end:]


def _lines(text: str, pieces: Sequence[str], rng: Random) -> str:
    lines = text.split("\n")
    i = rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0:
        del lines[i]
    elif kind == 1:
        lines[i : i + 1] = [lines[i]] * _count(rng, SIZE // (len(lines[i]) + 1))
    elif kind == 2:
        rng.shuffle(lines)
    elif kind == 3:
        lines[i] = _piece(pieces, rng)
    else:
        lines[i] = lines[i].replace(rng.choice(lines[i]), _piece(pieces, rng)[:1000]) if lines[i] else "\t"
    return "\n".join(lines)


def _cut(text: str, pieces: Sequence[str], rng: Random) -> str:
    return text[: rng.randrange(len(text) + 1)]


def _joined(text: str, pieces: Sequence[str], rng: Random) -> str:
    return text.replace(rng.choice("\n ,;=\t."), rng.choice((*pieces, *WORDS)))


_CHANGES = (_repeated, _repeated, _number, _number, _lines, _lines, _cut, _joined)


# -- the readers ------------------------------------------------------------------------------------------


def _command(*words: str) -> Read:
    """A command of the shell; FILE and OUT stand for the file and for a folder."""

    def run(file: Path, out: Path) -> int:
        from core.__main__ import main

        return main([word.replace("FILE", str(file)).replace("OUT", str(out)) for word in words])

    return run


def _function(read: Callable[[Path], Any]) -> Read:
    """A reader of the window, which has no command: what it raises for the user counts as 2."""

    def run(file: Path, out: Path) -> int:
        from core.errors import KindynaError

        try:
            read(file)
        except KindynaError as error:
            print(error, file=sys.stderr)
            return 2
        return 0

    return run


def _controllers(file: Path, out: Path) -> int:
    (out / "KINDYNA").mkdir()
    (out / "KINDYNA" / "controllers.toml").write_bytes(file.read_bytes())
    os.environ["XDG_CONFIG_HOME"] = str(out)
    return _command("ecam", str(LIFT), "--controller", "own", "--error", "1", "--out", "OUT/cam.txt")(file, out)


def _underlay(file: Path) -> None:
    from core.contour.underlay import read_lines

    drawn = read_lines(file)
    assert sum(len(line) - 1 for line in drawn.lines) <= 200_000


def _beside(file: Path) -> None:
    from core.contour.underlay import read_underlay

    read_underlay(file.with_name("file.toml"))


def _logo(file: Path) -> None:
    from core.output.files.sheet import Letterhead, read_logo

    read_logo(Letterhead(logo=str(file)))


def _designs() -> Sequence[str]:
    return [path.read_text("utf-8") for path in sorted(EXAMPLES.glob("*.toml"))]


def _tables() -> Sequence[str]:
    made = []
    for mark, point in (",.", ";,", "\t.", " ."):
        rows = [(f"{a:.4f}", f"{5.0 - 5.0 * cos(radians(a)):.5f}") for a in range(0, 360, 4)]
        head = ["angle [deg]", "lift [mm]"]
        made.append("\n".join(mark.join(row).replace(".", point) for row in (head, *rows)))
    return made


_PYSLVS = (
    "M[J[R, color[green], P[0.0, 0.0], L[ground, link_1]], J[R, P[12.92, 32.53], L[link_1, link_2]], "
    "J[R, P[73.28, 67.97], L[link_2, link_3]], J[RP, A[30.0], P[33.3, 66.95], L[link_2, link_5]], J[R, P[90.0, 0.0], L[ground, link_3]]]"
)
_PMKS = "https://app.pmksplus.com/?00.Fe.A,0.101.6A,A,0,0,0.0B,B,NS,7q,0.1S,S,NS,7q,0Ta,DE,D,E.4D,D,0,0_W,0.0E,E,Yc,fH,0..YRAB,AB,Fe,Fe,0,0,808080,A,B,,.YPBS,BS,Fe,Fe,0,0,808080,B,S,,.YRDE,DE,Fe,Fe,0,0,808080,D,E,,...Nx"
_LINKAGE2 = """<linkage2><program releasenumber="3" units="Millimeters" scalefactor="1"/>
<connector id="0" layer="0" x="0" y="0" anchor="true" input="true" rpm="30"/><connector id="1" layer="0" x="8" y="21"/>
<connector id="2" layer="0" x="70" y="48"/><connector id="3" layer="0" x="80" y="0" anchor="true"/>
<Link id="1"><connector id="0"/><connector id="1"/></Link><Link id="2"><connector id="1"/><connector id="2"/></Link>
<Link id="3"><connector id="2"/><connector id="3"/></Link></linkage2>"""
_ALPHABET = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"


def _address(rng: Random) -> bytes:
    """An address with its checksum, so that what is behind it is read."""
    body = hostile(
        Reader(
            _command(),
            lambda: (_PMKS.partition("?")[2],),
            (".", ",", "Y", "0", "00", "..", "Z", "YRAB,AB,", "4D,D,0,0,0."),
        ),
        rng,
    )
    text = re.sub(rf"[^{re.escape(_ALPHABET)},.]", "", body.decode("utf-8", "ignore"))[:-1]
    return f"?{text}{_ALPHABET[len(text) % 62]}".encode()


_DXF = """0
SECTION
2
HEADER
9
$INSUNITS
70
4
0
ENDSEC
0
SECTION
2
TABLES
0
LAYER
2
0
62
7
0
ENDSEC
0
SECTION
2
BLOCKS
0
BLOCK
2
B
10
0
20
0
0
LINE
10
0
20
0
11
1
21
1
0
CIRCLE
10
0
20
0
40
2
0
ENDBLK
0
ENDSEC
0
SECTION
2
ENTITIES
0
INSERT
2
B
10
1
20
2
41
2
50
30
70
2
71
3
44
5
45
6
0
LWPOLYLINE
8
0
70
1
10
40
20
0
42
1
10
-40
20
0
42
1
0
SPLINE
71
2
40
0
40
0
40
0
40
1
40
1
40
1
10
0
20
0
30
0
10
5
20
3
30
0
10
9
20
0
30
0
0
ELLIPSE
10
0
20
0
11
4
21
0
40
0.5
0
ENDSEC
0
EOF
"""
_DXF_PIECES = (
    "0\nINSERT\n2\nB\n10\n1\n", "70\n30000\n71\n30000\n", "0\nLINE\n10\n0\n20\n0\n11\n1\n21\n1\n", "0\nBLOCK\n2\nB\n", "0\nENDBLK\n",
    "0\nLWPOLYLINE\n70\n1\n", "10\n3\n20\n4\n42\n0.5\n", "0\nVERTEX\n10\n1\n20\n1\n", "0\nPOLYLINE\n66\n1\n", "0\n", "\n", "40\n1\n",
    "210\n1\n",
    "0\nARC\n10\n0\n20\n0\n40\n5\n50\n0\n51\n90\n", "0\nENDSEC\n", "0\nSECTION\n2\nENTITIES\n", "0\nSPLINE\n71\n3\n",
)  # fmt: skip
_CONTROLLER = """[[controllers]]
slug = "own"
label = "Own"
interpolation = ["linear"]
columns = ["master", "slave"]
header = "{rows} {name}\\n"
row = "{master}{sep}{slave}"
footer = "\\nend"
between = ["\\n"]
words = { linear = "1" }
encoding = "utf-8"
digits = 9
rows = [2, 1000]
extension = ".txt"
step_units = [1]
"""
_GRAPH = json.dumps(
    {
        "title": "t", "x": {"low": 0.0}, "left": {}, "right": {},
        "curves": [
            {"key": "c1", "source": "file.csv", "y": "2", "width": 2.0},
            {"key": "c2", "source": "file.csv", "y": "1", "minus": "c1"},
        ],
    }
)  # fmt: skip
_STUDY = """design = "card.toml"
[[vary]]
field = "cam.base_radius_mm"
low = 50.0
high = 60.0
steps = 3
[[quantities]]
quantity = "pressure_angle_deg"
of = "max"
"""
_CAM = "\n".join(
    [
        "aCam : ARRAY[0..89] OF ARRAY[0..1] OF LREAL := [",
        ",\n".join(f"  [{a}, {a * (360 - a) / 100}]" for a in range(0, 360, 4)),
        "];",
    ]
)


def _study(file: Path, out: Path) -> int:
    (file.parent / "card.toml").write_bytes((EXAMPLES / "card_picker.toml").read_bytes())
    (out / "s.toml").write_bytes(file.read_bytes())
    (out / "card.toml").write_bytes((EXAMPLES / "card_picker.toml").read_bytes())
    from core.errors import KindynaError
    from core.varying.request import load_study

    try:
        load_study(out / "s.toml")
    except KindynaError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _segment(file: Path, out: Path) -> int:
    (out / "lift.toml").write_bytes(LIFT.read_bytes())
    return _command("measured", "FILE", "--as", "segment", "--segment", "1", "--into", "OUT/lift.toml")(file, out)


def _graph_setup(file: Path, out: Path) -> int:
    (file.parent / "file.csv").write_text(_tables()[0], "utf-8")
    return _command("graph", "--setup", "FILE", "--at", "3")(file, out)


_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_RELATIONS = "http://schemas.openxmlformats.org/package/2006/relationships"


def workbook(cells: str, sheets: str = '<sheet name="S" sheetId="1" r:id="rId1"/>', without: str = "") -> bytes:
    """A workbook of one sheet with these cells, in XML; without: a part that is left out."""
    parts = {
        "_rels/.rels": _relation("officeDocument", "xl/workbook.xml"),
        "xl/_rels/workbook.xml.rels": _relation("worksheet", "worksheets/s.xml"),
        "xl/workbook.xml": f'<workbook xmlns="{_MAIN}" xmlns:r="{_OFFICE}"><sheets>{sheets}</sheets></workbook>',
        "xl/worksheets/s.xml": f'<worksheet xmlns="{_MAIN}"><sheetData>{cells}</sheetData></worksheet>',
    }
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            if name != without:
                archive.writestr(name, text)
    return stream.getvalue()


def _relation(kind: str, target: str) -> str:
    return f'<Relationships xmlns="{_RELATIONS}"><Relationship Id="rId1" Type="{_OFFICE}/{kind}" Target="{target}"/></Relationships>'


CELLS = "".join(
    f'<row><c r="A{i + 1}"><v>{4 * i}</v></c><c r="B{i + 1}"><v>{i * (90 - i) / 100}</v></c></row>' for i in range(90)
)
_REFERENCES = (
    "XFD1048576",
    "ZZ100000",
    "A0",
    "",
    "1A",
    "A99999999999999999999",
    "ZZZZZZZZZZ1",
    "XFE1",
    "A1:B2",
    "é1",
    "$A$1",
    "B1048576",
    "AA1",
)


def _workbook(rng: Random) -> bytes:
    """A workbook with something wrong in its cells, its parts or its bytes."""
    cells, kind = CELLS, rng.randrange(8)
    if kind <= 2:
        value, sort = rng.choice(("1", "99999999", "x", "")), rng.choice(("n", "s", "b", "e", "str", "x"))
        cells += f'<row><c r="{rng.choice(_REFERENCES)}" t="{sort}"><v>{value}</v></c></row>'
    elif kind == 3:
        cells = rng.choice(_CHANGES)(cells, ("<c>", "<row>", '<c r="', "</v>", "&#x0;", "&amp;"), rng)[:SIZE]
    elif kind == 4:
        cells += f"<row><c r='C1' t='inlineStr'><is><t>{' x' * _count(rng, 40_000_000)}</t></is></c></row>"
    name = "" if kind == 5 else "S" * _count(rng, 10_000)
    sheets = f'<sheet name="{name}" sheetId="1" r:id="rId1"/>' if rng.random() < 0.9 else ""
    data = workbook(
        cells, sheets, rng.choice(("_rels/.rels", "xl/workbook.xml", "xl/worksheets/s.xml")) if kind == 6 else ""
    )
    if kind == 7:
        at = rng.randrange(len(data))
        data = data[:at] + rng.randbytes(rng.choice((1, 8))) + data[at + rng.choice((0, 1, 50)) :]
    return b"PK\x03\x04" + data[4:]


def _picture(rng: Random) -> bytes:
    """A picture of any size, cut or changed somewhere; or an SVG."""
    if rng.random() < 0.3:
        svg = Reader(
            _command(),
            lambda: ('<svg xmlns="http://www.w3.org/2000/svg" width="9"><g><path d="M0 0"/></g></svg>',),
            ("<g>", "</g>", "&a;", "<!", "<?x?>"),
        )
        return hostile(svg, rng)
    from PIL import Image

    stream = io.BytesIO()
    Image.new("1" if (big := rng.random() < 0.3) else "RGB", (12_000, 9_000) if big else (30, 20)).save(
        stream, "PNG" if big else rng.choice(("PNG", "JPEG"))
    )
    data = bytearray(stream.getvalue())
    kind = rng.randrange(3)
    if kind == 0:
        return bytes(data[: rng.randrange(len(data))])
    for _ in range(kind * rng.randrange(1, 9)):
        data[rng.randrange(8, len(data))] = rng.randrange(256)
    return bytes(data)


def _arguments(file: Path, out: Path) -> int:
    """Words of a command line that are any bytes."""
    from core.__main__ import main

    os.chdir(out)
    words = [os.fsdecode(word) for word in file.read_bytes().replace(b"\0", b"").split(b"\n")]
    return main(words)


_LINES = (
    "check\nX", f"report\n{LIFT}\n--out\nr\n--author\nX", f"explain\n{LIFT}\nX\n--at\n0", f"graph\n{LIFT}\n--curve\nX",
    "linkage-from\nX\n--out\no.toml", f"find\n{LIFT}\nX", f"ecam\n{LIFT}\n--controller\nX\n--out\nX", "blend\nX",
    f"profile\n{LIFT}\n--out\nX.csv\n--samples\n9", f"motion\n{LIFT}\n--out\nX.toml", f"measured\n{LIFT}\n--column\nX",
    f"compare\n{LIFT}\nX", f"centres\n{LIFT}\n--at\nX", f"export\n{LIFT}\n--only\nX", "X", "laws\nX",
)  # fmt: skip


def _words(rng: Random) -> bytes:
    word = rng.choice((
        rng.randbytes(rng.randrange(1, 9)), b"\xff\xfe", b"1" * _count(rng, 50_000), b"[" * _count(rng, 50_000), b"a." * _count(rng, 9_000),
        b"X[" + b"9" * 5000 + b"]", b"=,=" * 50, b"1e999", b"-1", b"nan", b"\xed\xa0\x80", b"", b"..", b"%s", b"{0}", b"a" * 300,
        b"y=" + b"8" * 4500,
        b"loads.friction[" + b"1" * 5000 + b"]", "é".encode(), "\u202e".encode(), b"y=1,minus=" + b"7" * 5000,
    ))  # fmt: skip
    return rng.choice(_LINES).encode().replace(b"X", word.replace(b"\n", b""))


_CELLS = (
    "1",
    ",",
    ";",
    "\t",
    " ",
    '"',
    '""',
    '"a',
    "(",
    "[",
    "[(",
    "{",
    "\n",
    "\r",
    "a",
    "#",
    "//",
    "1,",
    "1;2\n",
    "-",
    "e5",
    "_",
    "in ",
    " /",
    "mm",
    ".5",
    "1 2\n",
    "°",
)
_TOML = (
    "[",
    "{",
    "]",
    "}",
    "a.",
    "a = ",
    '"',
    "'''",
    "#",
    "\n",
    "1",
    ",",
    "[[a]]\n",
    "[a]\n",
    "\\u0041",
    "1979-05-27",
    "=",
    "\t",
    "[[drives]]\n",
)
_CARD = str(EXAMPLES / "card_picker.toml")
_LINKAGE = _command("linkage-from", "FILE", "--out", "OUT/o.toml")
_PIECES: dict[str, Sequence[str]] = {
    "controllers": (*_TOML, "{slave}", "{master.__class__}", "{{", "{rows}", "\\\\", "{sep}"),
    "pyslvs": ("#[", "#]", "J[R,P[1,2],L[ground,a]],", "[", "]", "A[", " ", ",", "M[", "\n"),
    "linkage2": ("<a>", "</a>", "<connector id='9'/>", "&lt;", "<!--", "<!DOCTYPE a [", "<Link id='7'>", "'"),
    "graph": ("[", "{", '{"a":', "1,", '"', ":", "\\u0000", "{},"),
}
_BESIDE = 'file = "a.dxf"\nx_mm = 1.0\nopacity = 0.5\nlocked = true\n'
_NO_SPLINE = f"{_DXF[: _DXF.index('0' + chr(10) + 'SPLINE')]}0\nENDSEC\n0\nEOF\n"
READERS: dict[str, Reader] = {
    "design": Reader(_command("check", "FILE"), _designs, _TOML, "file.toml"),
    "study": Reader(_study, lambda: (_STUDY,), _TOML, "s.toml"),
    "controllers": Reader(_controllers, lambda: (_CONTROLLER,), _PIECES["controllers"], "c.toml"),
    "measured": Reader(_command("measured", "FILE"), _tables, _CELLS, "file.csv"),
    "measured-segment": Reader(_segment, _tables, _CELLS, "file.csv"),
    "inspection": Reader(
        _command("inspection", _CARD, "--out", "OUT/i.csv", "--measured", "FILE"), _tables, _CELLS, "file.csv"
    ),
    "controller-file": Reader(
        _command("measured", "FILE", "--controller", "codesys-xy"),
        lambda: (_CAM,),
        (*_CELLS, "[1, 2],\n", "dX := "),
        "cam.txt",
    ),
    "graph": Reader(_command("graph", "FILE", "--at", "3", "--json"), _tables, _CELLS, "file.csv"),
    "graph-setup": Reader(_graph_setup, lambda: (_GRAPH,), _PIECES["graph"], "file.json"),
    "pyslvs": Reader(_LINKAGE, lambda: (_PYSLVS,), _PIECES["pyslvs"], "file.txt"),
    "linkage2": Reader(_LINKAGE, lambda: (_LINKAGE2,), _PIECES["linkage2"], "file.linkage2"),
    "pmks": Reader(_LINKAGE, name="file.txt", data=_address),
    "motion-from": Reader(
        _command("motion-from", _CARD, "FILE", "--units", "mm", "--out", "OUT/o.toml"),
        lambda: (_DXF, _NO_SPLINE),
        _DXF_PIECES,
        "file.dxf",
    ),
    "underlay": Reader(_function(_underlay), lambda: (_DXF,), _DXF_PIECES, "file.dxf"),
    "beside": Reader(_function(_beside), lambda: (_BESIDE,), _TOML, "file.underlay.toml"),
    "logo": Reader(_function(_logo), name="logo.png", data=_picture),
    "workbook": Reader(_command("measured", "FILE"), name="file.xlsx", data=_workbook),
    "arguments": Reader(_arguments, name="words", data=_words),
}


# -- one after the other, each in a process of its own -----------------------------------------------------


def _limited(reader: Reader, file: Path, out: Path, log: Path) -> int:
    """In a child process: the exit code of what is run, with its output in a file."""
    with open(log, "w", encoding="utf-8", errors="backslashreplace") as stream:
        pages = int(Path("/proc/self/statm").read_text("utf-8").split()[0])
        most = pages * resource.getpagesize() + MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with contextlib.redirect_stderr(stream), contextlib.redirect_stdout(io.StringIO()):
            try:
                return reader.run(file, out)
            except BaseException:
                traceback.print_exc()
                return CRASHED


def outcome(name: str, which: int | str) -> dict[str, Any]:
    """What becomes of a number of the generator, or of a file: exit code (negative: killed by that signal), what was said, seconds of
    CPU, megabytes, size."""
    reader = READERS[name]
    with tempfile.TemporaryDirectory() as folder:
        file, out, log = Path(folder) / reader.name, Path(folder) / "out", Path(folder) / "log"
        out.mkdir()
        data = hostile(reader, Random(f"{name} {which}")) if isinstance(which, int) else Path(which).read_bytes()
        file.write_bytes(data)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        process = os.fork()
        if not process:
            code = CRASHED
            try:
                code = _limited(reader, file, out, log)
            finally:
                os._exit(code)
        _, status, usage = os.wait4(process, 0)
        said = log.read_text("utf-8") if log.exists() else ""
        return {
            "reader": name, "which": which, "code": os.waitstatus_to_exitcode(status), "said": said[-4000:], "lines": said.count("\n"),
            "cpu_s": round(usage.ru_utime + usage.ru_stime, 2), "mb": max(0, usage.ru_maxrss - before) // 1024, "bytes": len(data),
        }  # fmt: skip


@cache
def _warm(name: str) -> None:
    """What a reader imports is imported once, not in each of the processes."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        (Path(folder) / "out").mkdir()
        file = Path(folder) / READERS[name].name
        file.write_text(READERS[name].good()[0], "utf-8")
        with contextlib.redirect_stderr(io.StringIO()):
            READERS[name].run(file, Path(folder) / "out")


def outcomes(rows: Sequence[tuple[str, int | str]]) -> list[dict[str, Any]]:
    """What becomes of each, of a reader and a number or file, read by one process that is started for it."""
    lines = "".join(json.dumps(row) + "\n" for row in rows)
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, __file__],
        input=lines,
        capture_output=True,
        text=True,
        env=environment,
        check=True,
        encoding="utf-8",
    )
    return [json.loads(line) for line in done.stdout.splitlines()]


if __name__ == "__main__":
    for _line in sys.stdin:
        _name, _which = json.loads(_line)
        if READERS[_name].data is None:
            _warm(_name)
        print(json.dumps(outcome(_name, _which)), flush=True)
