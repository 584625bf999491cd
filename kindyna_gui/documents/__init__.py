"""The design being worked on: session, undo, files, drafts, recovery, export."""
