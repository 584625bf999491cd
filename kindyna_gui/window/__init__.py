"""Menus, docks, tasks, player bar, dialogs and pages of the main window."""
