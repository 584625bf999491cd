"""Many designs at once: what can be asked of them, their stages side by side, totals of a turn, and blocks of them."""
