"""Every test that guards a formula has been seen to fail (see mutations.py); a few minutes."""

import mutations
import pytest


@pytest.mark.stress
@pytest.mark.parametrize("file", mutations.MUTATIONS)
def test_a_changed_sign_turns_a_test_red(file: str) -> None:
    assert list(mutations.check([file])) == []
