"""Every test that guards a formula has been seen to fail (see mutations.py); a few minutes."""

import re

import mutations
import pytest


def test_every_change_still_stands_in_its_file_and_its_test_exists() -> None:
    """So that no row goes stale between two runs of them all."""
    texts: dict[str, str] = {}
    for mutation in mutations.mutations():
        source = texts.setdefault(mutation.file, (mutations.ROOT / mutation.file).read_text(encoding="utf-8"))
        assert source.count(mutation.old) == 1, mutation
        assert mutation.new != mutation.old
        for test in mutation.tests:
            file, name = re.match(r"(.*)::(\w+)", test).groups()  # type: ignore[union-attr]
            tests = texts.setdefault(file, (mutations.ROOT / file).read_text(encoding="utf-8"))
            assert f"def {name}(" in tests, mutation


@pytest.mark.stress
@pytest.mark.parametrize("file", mutations.MUTATIONS)
def test_a_changed_sign_turns_a_test_red(file: str) -> None:
    assert list(mutations.check([file])) == []
