"""The window: menus, docks, player bar, help, and the views on the program itself: findings, certificate, log."""
