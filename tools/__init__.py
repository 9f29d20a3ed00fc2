"""Tools that create files of the project. The tools are run by hand and are not part of the package."""
