"""Files of designs: new, opened, saved, watched on the disk, recovered after a crash."""
