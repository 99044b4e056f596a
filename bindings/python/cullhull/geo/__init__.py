"""Points from files and from objects of other packages, and results as files for maps."""
