"""Stand-ins for SciPy's classes: exact ones, those within a distance, and Qhull's options."""
