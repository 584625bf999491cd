"""Several drives on one shaft: the strip that names them, their list, and what they are drawn and plotted together in."""
