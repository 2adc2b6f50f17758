"""The command line: scene files as typed tables, and one file for each command."""

DONE, BAD_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 2, 3, 130  # exit status
