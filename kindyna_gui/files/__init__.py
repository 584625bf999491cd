"""Files of designs: opened, saved, watched on the disk, brought back after a crash."""
