"""The report to hand on, with its pictures: HTML with SVG, and PDF."""
