"""The current design: session, undo, incomplete designs, pinned variants, texts about designs."""
