"""The window: menus, docks, player bar, help, and the views of what the program itself has to say."""
