"""Tools that make files shipped with the project. They are run by hand and are not part of the package."""
