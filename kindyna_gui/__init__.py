"""The window, and the pictures that commands write.

Its floors, from the top down; each imports only from those below it (pyproject.toml holds them):

window        menus, docks, tasks and layouts; what menus do with the design
export        what leaves the program besides the design, with the dialogs that ask for it
views         a room for each subject: motion, linkage, shaft, graph, stability, find, timing ...
files, forms  the design's file; fields, tables and dialogs of numbers
view          what every view shares, and what it may ask of the window
documents     the session: the design in place, what is typed of it, its steps to undo
pictures      drawings and plots, on the screen and as files, with the units they are read in
player ...    the cam angle; words, settings, places, work beside the window

A new view is a module in the room of its subject and a row in ``window.docks.VIEWS``.
"""
