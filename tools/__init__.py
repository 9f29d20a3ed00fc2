"""Tools that create files of the project. They are run by hand and are not part of the package."""
