"""The table of controllers, and a user's own rows beside the settings."""

import json

import pytest

from core.errors import KindynaError
from core.output.controllers.layout import FileTable, file_bytes
from core.output.controllers.rows import controller, controllers, parse_rows
from core.process import user_folder
from kindyna_gui.__main__ import main
from kindyna_gui.places import example

SHIPPED = (
    "codesys-xyva", "codesys-xy", "codesys-x", "codesys-cambuilder", "twincat-points", "twincat-table", "beckhoff-ascii",
    "beckhoff-zebra", "sew-tab", "sew-semicolon", "lenze-loader", "schneider-asc", "kollmorgen-csv", "technosoft", "inventor", "general",
)  # fmt: skip
OWN = """[[controllers]]
slug = "shop"
label = "The shop's drive"
source = "its manual"
interpolation = ["linear"]
columns = ["master", "slave"]
header = "N={rows}\\n"
row = "{slave}{sep}{master}"
separator = " "
decimal = ","
digits = 6
footer = "\\nEND\\n"
"""


def test_these_rows_are_there():
    assert tuple(controllers()) == SHIPPED
    assert controller("sew-tab").rows == (2, 1024)
    with pytest.raises(KindynaError, match="--controller nobody: no row of that name; allowed: codesys-xyva"):
        controller("nobody")


def test_twelve_lines_beside_the_settings_are_a_controller_more():
    folder = user_folder("settings")
    folder.mkdir(parents=True)
    (folder / "controllers.toml").write_text(OWN, "utf-8")
    import numpy as np

    table = FileTable(np.array([0.0, 120.0, 360.0]), np.array([0.0, 1.23456789, 0.0]))
    assert file_bytes(controller("shop"), table, "", "linear") == b"N=3\n0 0\n1,23457 120\n0 360\nEND\n"
    assert tuple(controllers()) == (*SHIPPED, "shop")
    (folder / "controllers.toml").write_text(OWN.replace('"shop"', '"sew-tab"'), "utf-8")
    assert controller("sew-tab").label == "The shop's drive"


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ('label = "The shop\'s drive"\n', "", "controllers[0].label: is missing"),
        ('["linear"]', '["linar"]', "controllers[0].interpolation = ['linar']: not allowed; allowed: a list of linear"),
        ("digits = 6", "digits = 30", "controllers[0].digits = 30: not allowed; allowed: 1 ... 17"),
        ("digits = 6", "digit = 6", "controllers[0].digit = 6: unknown key"),
        ("{slave}{sep}{master}", "{slave}", "controllers[0].row = '{slave}': lacks {master}"),
        (
            "{slave}{sep}{master}",
            "{slave}{master}{speed}",
            "controllers[0].row = '{slave}{master}{speed}': not allowed",
        ),
        (
            '["linear"]',
            '["quintic-hermite"]',
            "controllers[0].interpolation = 'quintic-hermite': requires the column velocity",
        ),
        ("digits = 6", "rows = [1, 9]", "controllers[0].rows = [1, 9]: not allowed; allowed: [least, most], from 2 on"),
        ('["master", "slave"]', '["slave"]', "controllers[0].columns = ['slave']: lacks master, which is in row"),
        ("digits = 6", "digits = ", "not TOML"),
        ("digits = 6", "digits = 0", "controllers[0].digits = 0: not allowed"),
        ("digits = 6", "digits = true", "controllers[0].digits = True: not allowed"),
        ("digits = 6", "rows = [2, 10000001]", "controllers[0].rows = [2, 10000001]: not allowed"),
        ("digits = 6", 'encoding = "rot13"', "controllers[0].encoding = 'rot13': not allowed; allowed: 'utf-8'"),
        ("digits = 6", "encoding = 8", "controllers[0].encoding = 8: not allowed"),
    ],
)
def test_a_wrong_row_is_told_by_its_field(before, after, says):
    with pytest.raises(KindynaError) as raised:
        parse_rows(OWN.replace(before, after, 1), "own.toml")
    assert str(raised.value).startswith("own.toml: ")
    assert says in str(raised.value)


NAMES = (
    "./../../evil.txt", "/evil.txt", ".\\..\\evil.txt", ".:evil", ".a/b", ".a\u0000b", ".", "..", ".txt.", ".txt ", ". txt", "txt", "",
    ".12345678901234567", ".a\nb", ".캠", ".a*", "../x",
)  # fmt: skip


@pytest.mark.parametrize("extension", NAMES)
def test_an_extension_is_the_end_of_a_name_and_never_a_path(extension):
    with pytest.raises(KindynaError) as raised:
        parse_rows(OWN + f"extension = {json.dumps(extension)}\n", "own.toml")
    assert str(raised.value).startswith("own.toml: shop: controllers[0].extension = ")
    assert "a dot, then 1 ... 16 letters, digits, dots, _ or -" in str(raised.value)


@pytest.mark.parametrize("extension", [".txt", ".1234567890abcdef", ".tar.gz", ".a_b-c", ".S7"])
def test_an_extension_of_a_dot_and_some_letters_is_taken(extension):
    assert parse_rows(OWN + f'extension = "{extension}"\n', "own.toml")["shop"].extension == extension


def test_a_handover_with_an_extension_that_leads_elsewhere_writes_nothing(tmp_path, capsys):
    folder = user_folder("settings")
    folder.mkdir(parents=True)
    (folder / "controllers.toml").write_text(OWN + 'extension = "./../../evil.txt"\n', "utf-8")
    out = tmp_path / "deep" / "er" / "out"
    words = ["--headless", "handover", str(example("card_picker")), "--controller", "shop", "--out", str(out)]
    assert main(words) == 2
    assert "controllers[0].extension" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
