"""Units of arguments and of files."""
