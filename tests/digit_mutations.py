"""Changes of ``core`` and of the window that lose digits, or compute what nobody asked for, which a test must notice; see
mutations.py. Right to first order, each of them: no sign is wrong."""

DIGIT_MUTATIONS: dict[str, list[tuple[str, str, str]]] = {}
