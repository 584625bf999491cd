"""Linkages as people draw them: where things stand on the sheet, edits of what is drawn, copies, and how a drawing is put together."""
