"""Results as pictures, pages, meshes and objects of other packages."""
