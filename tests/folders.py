"""What a folder holds, to be compared with what it holds later."""

from pathlib import Path


def content(folder: Path) -> dict[str, bytes | str | None]:
    """All below a folder: bytes of files, targets of links; None for a folder, and for what is no ordinary file."""
    return {
        str(path.relative_to(folder)): str(path.readlink())
        if path.is_symlink()
        else path.read_bytes()
        if path.is_file()
        else None
        for path in sorted(folder.rglob("*"))
    }
