"""The table of controllers, and a user's own rows beside the settings."""

import pytest

from core.errors import KindynaError
from core.output.controllers.layout import FileTable, written
from core.output.controllers.row import controller, controllers, rows_of, settings_folder

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
    folder = settings_folder()
    folder.mkdir(parents=True)
    (folder / "controllers.toml").write_text(OWN, "utf-8")
    import numpy as np

    table = FileTable(np.array([0.0, 120.0, 360.0]), np.array([0.0, 1.23456789, 0.0]))
    assert written(controller("shop"), table, "", "linear") == b"N=3\n0 0\n1,23457 120\n0 360\nEND\n"
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
            "controllers[0].interpolation = 'quintic-hermite': needs the column velocity",
        ),
        ("digits = 6", "rows = [1, 9]", "controllers[0].rows = [1, 9]: not allowed; allowed: [least, most], from 2 on"),
        ('["master", "slave"]', '["slave"]', "controllers[0].columns = ['slave']: lacks master, which stands in row"),
        ("digits = 6", "digits = ", "not TOML"),
    ],
)
def test_a_wrong_row_is_told_by_its_field(before, after, says):
    with pytest.raises(KindynaError) as raised:
        rows_of(OWN.replace(before, after, 1), "own.toml")
    assert str(raised.value).startswith("own.toml: ")
    assert says in str(raised.value)
